"""Whether a coupling iteration is still getting anywhere."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Verdict: TypeAlias = Literal["", "stalled", "diverging"]

__all__ = ["StallWatch", "Verdict"]

_WINDOW = 20  # iterations: quasi-Newton methods may stand still for ten and then converge
_FALL = 0.9  # of the best residual before: what the best one of a window must come below
_TINY = 1e-8  # of the largest |Δd|² of the step: smaller changes say more about rounding than about the loop
_GROWTH = 1e4  # of the first residual, in absolute terms


class StallWatch:
    """Follows the residuals of one step.

    *Stalled*: no residual of the last 20 iterations was below 0.9 times the best one before them. *Diverging*: the
    residual |d̃ - d| is 10⁴ times the first one of the step, whatever it is relative to.

    The *gain* is how much the loop of fluid and solid answers a change of the displacement by the opposite one,

        g = max over iterations of -Δd · Δd̃ / |Δd|²,

    seen along the iterates' differences. Above 1 plain iteration diverges. For an incompressible fluid it tends, as
    time steps shrink, to the ratio of the fluid's added mass to that of the solid: of a wall of the density ρ_s and
    the thickness h under waves of the length 2π/k about ρ_f/(ρ_s h k).

    References
    ----------
    Causin, Gerbeau, Nobile, Comput. Methods Appl. Mech. Eng. 194 (2005) 4506–4527, doi:10.1016/j.cma.2004.12.005;
    Förster, Wall, Ramm, Comput. Methods Appl. Mech. Eng. 196 (2007) 1278–1293, doi:10.1016/j.cma.2006.09.002.
    """

    def __init__(self) -> None:
        self._excesses: list[float] = []
        self._first = self._off = self._largest = 0.0
        self._last: tuple[Array, Array] | None = None
        self.gain = 0.0

    @property
    def iterations(self) -> int:
        """Iterations so far."""
        return len(self._excesses)

    @property
    def best(self) -> float:
        """Smallest excess so far."""
        return min(self._excesses, default=np.inf)

    @property
    def growth(self) -> float:
        """Last absolute residual as a multiple of the first one."""
        return self._off / self._first if self._first > 0.0 else 1.0

    def observe(self, image: Array, residual: Array, excess: float) -> Verdict:
        """Follow an iteration with the image d̃ and the residual d̃ - d.

        Parameters
        ----------
        image, residual : ndarray, shape (k, 2)
        excess : float
            Residual as a multiple of its tolerance.
        """
        self._excesses.append(excess)
        self._off = float(np.linalg.norm(residual))
        self._first = self._first or self._off
        d = image - residual
        if self._last is not None:
            change = (d - self._last[0]).ravel()
            squared = float(change @ change)
            self._largest = max(self._largest, squared)
            if squared > _TINY * self._largest > 0.0:
                self.gain = max(self.gain, -float(change @ (image - self._last[1]).ravel()) / squared)
        self._last = d.copy(), image.copy()
        if self.growth > _GROWTH:
            return "diverging"
        return "stalled" if self._stalled() else ""

    def _stalled(self) -> bool:
        before, window = self._excesses[:-_WINDOW], self._excesses[-_WINDOW:]
        return bool(before) and min(window) > max(1.0, _FALL * min(before))
