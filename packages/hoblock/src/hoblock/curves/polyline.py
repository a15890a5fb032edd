"""Straight pieces through points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.control_points import distinct_neighbours, plane_points
from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["Polyline"]


@dataclass(frozen=True, eq=False)
class Polyline:
    """Straight pieces from point to point.

    Elements follow it exactly where their corners lie on its kinks: use the grading `hoblock.grading.Pieces`, or a
    vertex at every kink.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Both ends and the kinks between them, in the direction of the edge.
    parameter : {"length", "pieces"}
        Whether t runs in proportion to length, or equally over each piece.
    """

    points: Array
    parameter: Literal["length", "pieces"] = "length"

    def __post_init__(self) -> None:
        points = plane_points(self.points, "polyline", 2)
        lengths = distinct_neighbours(points, "polyline")
        if self.parameter not in ("length", "pieces"):
            raise CurveError(f"polyline: parameter is {self.parameter!r}; expected 'length' or 'pieces'.")
        sizes = lengths if self.parameter == "length" else np.ones(len(lengths))
        t = np.concatenate(([0.0], np.cumsum(sizes)))
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "_parameters", t / t[-1])

    @property
    def breaks(self) -> Array:
        """Parameters of the kinks."""
        parameters: Array = self.__dict__["_parameters"]
        return parameters[1:-1]

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        parameters: Array = self.__dict__["_parameters"]
        t = np.asarray(t, dtype=float)
        return np.stack([np.interp(t, parameters, self.points[:, d]) for d in range(2)], axis=-1)
