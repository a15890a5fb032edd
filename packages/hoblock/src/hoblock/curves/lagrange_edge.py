"""Edges that are one polynomial, given by its nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hoblock.curves.control_points import distinct_neighbours, plane_points
from hoblock.errors import CurveError
from hoblock.reference import equispaced, gauss_lobatto, lagrange

Array = NDArray[np.float64]

__all__ = ["LagrangeEdge"]


@dataclass(frozen=True, eq=False)
class LagrangeEdge:
    """Polynomial of degree n - 1 through n nodes: the side of a high-order element.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Both ends and the nodes between them, in the direction of the edge.
    nodes : {"equispaced", "gll"} or array_like, shape (n,)
        Where on [0, 1] the nodes lie: equally spaced (as Gmsh and VTK have them), at the Gauss–Lobatto–Legendre points,
        or given, ascending from 0 to 1.
    """

    points: Array
    nodes: ArrayLike = "equispaced"

    def __post_init__(self) -> None:
        points = plane_points(self.points, "lagrange edge", 2)
        distinct_neighbours(points, "lagrange edge")
        order = len(points) - 1
        if isinstance(self.nodes, str):
            if self.nodes not in ("equispaced", "gll"):
                raise CurveError(
                    f"lagrange edge: nodes is {self.nodes!r}; expected 'equispaced', 'gll' or {order + 1} numbers."
                )
            x = equispaced(order) if self.nodes == "equispaced" else gauss_lobatto(order)
        else:
            given = np.array(self.nodes, dtype=float)
            good = given.shape == (order + 1,) and given[0] == 0.0 and given[-1] == 1.0 and (np.diff(given) > 0.0).all()
            if not good:
                raise CurveError(
                    f"lagrange edge: nodes are {given.tolist()}; expected {order + 1} numbers ascending from 0 to 1, "
                    "one for each point."
                )
            x = 2.0 * given - 1.0
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "_nodes", x)

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        nodes: Array = self.__dict__["_nodes"]
        return np.asarray(lagrange(nodes, 2.0 * np.asarray(t, dtype=float) - 1.0) @ self.points)
