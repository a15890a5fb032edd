"""Smooth curves through points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.control_points import distinct_neighbours, plane_points
from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["Spline"]

_POWERS = {"chord": 1.0, "centripetal": 0.5, "uniform": 0.0}


@dataclass(frozen=True, eq=False)
class Spline:
    """Interpolating cubic spline: twice continuously differentiable, a polynomial between neighbouring points.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Both ends and what lies between them, in the direction of the edge.
    ends : {"not-a-knot", "natural", "clamped", "periodic"}
        Condition at the ends: third derivatives continuous at the points next to them; no curvature; given directions;
        a closed curve, whose first and last points are the same, that is smooth there too.
    tangents : pair of (float, float), optional
        Directions at the first and at the second end, of any length, for ``"clamped"``.
    parameter : {"chord", "centripetal", "uniform"}
        Parameter lengths between neighbouring points: in proportion to the distance, to its root, or equal.

    References
    ----------
    de Boor: A Practical Guide to Splines, Springer 1978, Chapter IV. Lee, Computer-Aided Design 21 (1989) 363–370,
    doi:10.1016/0010-4485(89)90003-1 (parameters).
    """

    points: Array
    ends: Literal["not-a-knot", "natural", "clamped", "periodic"] = "not-a-knot"
    tangents: tuple[tuple[float, float], tuple[float, float]] | None = None
    parameter: Literal["chord", "centripetal", "uniform"] = "chord"

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", plane_points(self.points, "spline", 2))
        distinct_neighbours(self.points, "spline")
        if self.ends not in ("not-a-knot", "natural", "clamped", "periodic"):
            raise CurveError(
                f"spline: ends is {self.ends!r}; expected 'not-a-knot', 'natural', 'clamped' or 'periodic'."
            )
        if self.ends == "periodic" and (self.points[0] != self.points[-1]).any():
            raise CurveError(
                f"spline: ends = 'periodic', but it runs from {tuple(self.points[0].tolist())} to "
                f"{tuple(self.points[-1].tolist())}; expected the same point twice. Close it, or choose other ends."
            )
        if self.parameter not in _POWERS:
            raise CurveError(f"spline: parameter is {self.parameter!r}; expected 'chord', 'centripetal' or 'uniform'.")
        if (self.ends == "clamped") != (self.tangents is not None):
            raise CurveError("spline: tangents go with ends = 'clamped', and only with it. Give both or neither.")
        if (
            self.tangents is not None
            and not (np.hypot(*np.array(self.tangents, dtype=float).reshape(2, 2).T) > 0).all()
        ):
            raise CurveError(f"spline: tangents are {self.tangents}; expected two directions that are not zero.")

    @cached_property
    def _parameters(self) -> Array:
        steps = distinct_neighbours(self.points, "spline") ** _POWERS[self.parameter]
        t = np.concatenate(([0.0], np.cumsum(steps)))
        return np.asarray(t / t[-1])

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import CubicSpline

        condition: Any = self.ends
        if self.tangents is not None:
            length = float(np.hypot(*np.diff(self.points, axis=0).T).sum())  # |dx/dt| of a parameter near arc length
            directions = np.array(self.tangents, dtype=float)
            first, second = length * directions / np.hypot(*directions.T)[:, None]
            condition = ((1, first), (1, second))
        return CubicSpline(self._parameters, self.points, bc_type=condition)

    @property
    def breaks(self) -> Array:
        """Parameters of the points between the ends, where third derivatives jump."""
        return self._parameters[1:-1]

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        return np.asarray(self._spline(np.asarray(t, dtype=float)))
