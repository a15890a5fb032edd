"""Interface quasi-Newton with an inverse Jacobian from least squares (IQN-ILS)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["InverseLeastSquares"]


class InverseLeastSquares:
    """IQN-ILS with reuse of earlier steps and the QR2 filter.

    Differences of successive residuals and of successive images d̃ within a step are columns of V and W. The next
    iterate is d̃ + W c with c = argmin ‖V c + r‖.

    Parameters
    ----------
    reuse : int
        Earlier steps whose columns are kept.
    filter : float
        A column whose part orthogonal to the newer ones is below this fraction of it is dropped for good.
    relaxation : float
        Factor of the residual while there are no columns.

    References
    ----------
    Degroote, Bathe, Vierendeels, Comput. Struct. 87 (2009) 793–801, doi:10.1016/j.compstruc.2008.11.013;
    Haelterman, Bogaers, Scheufele, Uekermann, Mehl, Comput. Struct. 171 (2016) 9–17 (QR2),
    doi:10.1016/j.compstruc.2016.04.001.
    """

    def __init__(self, reuse: int, filter: float, relaxation: float) -> None:
        self._reuse, self._filter, self._relaxation = reuse, filter, relaxation
        self._steps: list[list[tuple[Array, Array]]] = []  # newest step first, newest column first
        self._current: list[tuple[Array, Array]] = []
        self._last: tuple[Array, Array] | None = None
        self.dropped = 0

    @property
    def columns(self) -> int:
        """Number of columns in use."""
        return len(self._current) + sum(len(step) for step in self._steps)

    def begin_step(self) -> None:
        """Start a step without columns of its own."""
        self._current, self._last = [], None

    def next(self, d: Array, residual: Array) -> Array:
        """Return the next iterate after ``d`` with the residual d̃ - d."""
        image = d + residual
        if self._last is not None:
            v, w = residual - self._last[0], image - self._last[1]
            if np.linalg.norm(v) > 0.0:
                self._current.insert(0, (v, w))
        self._last = residual.copy(), image
        columns = [*self._current, *(column for step in self._steps for column in step)]
        if not columns:
            return d + self._relaxation * residual
        V = np.stack([v for v, _ in columns], axis=1)
        W = np.stack([w for _, w in columns], axis=1)
        keep = self._filtered(V)
        if not keep.all():
            self._drop(keep)
            V, W = V[:, keep], W[:, keep]
        Q, R = np.linalg.qr(V)
        return np.asarray(image + W @ np.linalg.solve(R, -(Q.T @ residual)))

    def _filtered(self, V: Array) -> NDArray[np.bool_]:
        """Columns that are independent enough of newer ones; at most as many as there are rows."""
        keep: NDArray[np.bool_] = np.arange(V.shape[1]) < V.shape[0]
        norms = np.linalg.norm(V, axis=0)
        while True:
            kept = np.flatnonzero(keep)
            diagonal = np.abs(np.diag(np.linalg.qr(V[:, kept], mode="r")))
            weak = kept[diagonal < self._filter * norms[kept]]
            if not weak.size:
                return keep
            keep[weak[0]] = False  # the newest of them; those behind it may stand without it

    def _drop(self, keep: NDArray[np.bool_]) -> None:
        flags = iter(keep.tolist())
        self._current = [column for column in self._current if next(flags)]
        self._steps = [[column for column in step if next(flags)] for step in self._steps]
        self.dropped += int((~keep).sum())

    def end_step(self) -> None:
        """Keep the step's columns and forget the oldest step."""
        self._steps = [self._current, *self._steps][: self._reuse]
        self._current = []
