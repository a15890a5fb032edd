"""What one step of BDF2 adds to the error: estimated from how far it is from what the steps before let expect."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.timestepping.schemes import extrapolation_weights

Array = NDArray[np.float64]

__all__ = ["ErrorMemory", "LocalErrors", "error_share"]

_VALUES = 3  # of earlier steps, for a prediction of second order


def error_share(steps: Sequence[float]) -> float:
    """Local error of BDF2 as a part of the difference between its result and the quadratic extrapolation to it.

    Both errors are multiples of the third derivative: with the steps h, h₁, h₂ (newest first) those of BDF2
    h²(h + h₁)²/(2h + h₁)/6, of the extrapolation -h(h + h₁)(h + h₁ + h₂)/6 (Milne's device).

    Parameters
    ----------
    steps : sequence of float
        At least three, newest first.

    References
    ----------
    Gresho, Griffiths, Silvester: Adaptive time-stepping for incompressible flow I, SIAM J. Sci. Comput. 30 (2008)
    2018–2054, doi:10.1137/070688018, for the trapezoidal rule.
    """
    h, h1, h2 = steps[:3]
    own = h * (h + h1) / (2.0 * h + h1)
    return own / (own + h + h1 + h2)


@dataclass(frozen=True, eq=False)
class ErrorMemory:
    """What errors are estimated from.

    Attributes
    ----------
    values : mapping of str to tuple of ndarray, shape (n, 2)
        The last values of each field, newest first.
    largest : mapping of str to float
        The largest norm of each so far.
    """

    values: Mapping[str, tuple[Array, ...]]
    largest: Mapping[str, float]


class LocalErrors:
    """Estimates the local error of each step from those before it.

    It is the norm of the estimate relative to the largest norm of the field so far, of all fields the largest. It takes
    the results of three steps before; an initial value is better not kept, it need not satisfy the equations, as before
    an impulsive start.

    Parameters
    ----------
    weights : mapping of str to ndarray, shape (n,)
        Of the nodes of each field in its norm, positive.
    """

    def __init__(self, weights: Mapping[str, Array]) -> None:
        self._weights = dict(weights)
        self._values: dict[str, list[Array]] = {name: [] for name in weights}
        self._largest = dict.fromkeys(weights, 0.0)

    def estimate(self, values: Mapping[str, Array], steps: Sequence[float]) -> float | None:
        """Return the estimate for a step.

        Parameters
        ----------
        values : mapping of str to ndarray, shape (n, 2)
            The fields at the end of the step.
        steps : sequence of float
            Sizes of the step and those before it, newest first.

        Returns
        -------
        float or None
            None if too few steps were made.
        """
        found = [self._estimate(name, value, steps) for name, value in values.items()]
        known = [error for error in found if error is not None]
        return max(known) if known else None

    def _estimate(self, name: str, value: Array, steps: Sequence[float]) -> float | None:
        before = self._values[name]
        if len(before) < _VALUES:
            return None
        expected = np.tensordot(extrapolation_weights(steps, _VALUES - 1), np.stack(before), axes=1)
        scale = max(self._largest[name], self._norm(name, value))
        return error_share(steps) * self._norm(name, value - expected) / scale if scale > 0.0 else 0.0

    def keep(self, values: Mapping[str, Array]) -> None:
        """Remember the fields at the end of a step that is accepted."""
        for name, value in values.items():
            self._values[name] = [value, *self._values[name]][:_VALUES]
            self._largest[name] = max(self._largest[name], self._norm(name, value))

    def memory(self) -> ErrorMemory:
        """What is remembered."""
        return ErrorMemory({name: tuple(kept) for name, kept in self._values.items()}, dict(self._largest))

    def recall(self, memory: ErrorMemory) -> None:
        """Take back what was remembered."""
        self._values = {name: list(kept) for name, kept in memory.values.items()}
        self._largest = dict(memory.largest)

    def _norm(self, name: str, value: Array) -> float:
        return float(np.sqrt(self._weights[name] @ (value * value).sum(axis=1)))
