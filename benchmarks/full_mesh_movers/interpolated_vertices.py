"""A hybrid: radial basis functions or inverse distances move the block vertices, hoblock makes the mesh anew."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from full_mesh_movers.inverse_distance import inverse_distance_weights
from full_mesh_movers.radial_basis import RadialInterpolant
from hoblock import BlockStructure

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["InterpolatedVertices"]


@dataclass(frozen=True, eq=False)
class InterpolatedVertices:
    """The displacement of free block vertices is interpolated between driven and fixed ones, on the reference.

    A `hoblock.movers.Mover`: boundary vertices that are not driven stay, the rest is free.

    Parameters
    ----------
    reference : BlockStructure
    driven : ndarray of int
        Ascending.
    method : {"rbf", "idw"}
        Thin plate spline with a linear polynomial, or inverse distance weighting with exponent 3.

    Attributes
    ----------
    free : ndarray of int
    matrix : ndarray, shape (len(free), len(driven))
        Displacement of the free vertices by displacement of the driven ones, for each component; read-only.

    Raises
    ------
    ValueError
        If ``driven`` is not ascending, the method is unknown, or all centres are on a line ("rbf").
    """

    reference: BlockStructure
    driven: Index
    method: Literal["rbf", "idw"] = "rbf"
    free: Index = field(init=False)
    matrix: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        driven, vertices = np.array(self.driven, dtype=np.int64), self.reference.vertices
        if driven.ndim != 1 or (np.diff(driven) <= 0).any() or not np.isin(driven, np.arange(len(vertices))).all():
            raise ValueError(f"driven: {driven.tolist()}; expected ascending numbers of vertices. Use np.unique.")
        fixed = np.setdiff1d(self.reference.topology.boundary_vertices, driven)
        free = np.setdiff1d(np.arange(len(vertices)), np.union1d(driven, fixed))
        matrix = _response(vertices, driven, fixed, free, self.method)
        for name, value in (("driven", driven), ("free", free), ("matrix", matrix)):
            value.setflags(write=False)
            object.__setattr__(self, name, value)

    def move(self, current: Array, positions: Array) -> Array:
        """Return the vertices (n, 2) for positions of the driven ones; ``current`` is ignored.

        Raises
        ------
        ValueError
            If the positions have another shape or are not finite.
        """
        positions = np.asarray(positions, dtype=float)
        if positions.shape != (len(self.driven), 2) or not np.isfinite(positions).all():
            raise ValueError(f"move: expected finite positions of shape {(len(self.driven), 2)}.")
        vertices = self.reference.vertices.copy()
        vertices[self.free] += self.matrix @ (positions - vertices[self.driven])
        vertices[self.driven] = positions
        return vertices


def _response(vertices: Array, driven: Index, fixed: Index, free: Index, method: str) -> Array:
    centres = vertices[np.concatenate([driven, fixed])]
    if method == "idw":
        return inverse_distance_weights(vertices[free], centres, len(driven), 3.0)
    if method != "rbf":
        raise ValueError(f"method is {method!r}; expected 'rbf' or 'idw'.")
    interpolant = RadialInterpolant(centres, "thin_plate_spline", 1)
    return interpolant.evaluated(interpolant.coefficients(np.eye(len(centres), len(driven))), vertices[free])
