"""What flows through the boundary in the skew-symmetric form of convection."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hofsi.fem.geometry import SideGeometry, side_geometry
from hofsi.fem.sides import boundary_sides
from hofsi.fem.spaces import TaylorHood
from hofsi.solvers.fluid_matrices import SideTerm

Array = NDArray[np.float64]

__all__ = ["ConvectiveFlux"]


class ConvectiveFlux:
    """½ ∮ (a·n) u·v, a the velocity relative to the mesh; sides that nothing flows through cost nothing.

    Parameters
    ----------
    mesh : QuadMesh
    space : TaylorHood
    """

    def __init__(self, mesh: QuadMesh, space: TaylorHood) -> None:
        self._space, self._sides = space, boundary_sides(mesh)

    def terms(self, points: Array, density: float, advective: Array) -> list[SideTerm]:
        """Element matrices of ½ ∮ ρ (a·n) u·v in u, for a nodal a (n, 2)."""
        return [
            SideTerm(a, a, side.elements, _product(side, 0.5 * density * flow))
            for side, flow in self._flows(points, advective)
            for a in range(2)
        ]

    def derivatives(self, points: Array, density: float, advected: Array) -> list[SideTerm]:
        """Element matrices of ½ ∮ ρ (a·n) u·v in a, for a nodal u (n, 2)."""
        return [
            SideTerm(a, b, side.elements, _product(side, 0.5 * density * u[..., a] * side.normals[..., b]))
            for side, u in self._through(points, advected)
            for a in range(2)
            for b in range(2)
        ]

    def add(self, f: Array, points: Array, factor: float, advective: Array, advected: Array) -> None:
        """Add a factor times ½ ∮ (a·n) u·v, for nodal a and u (n, 2), to element vectors."""
        for side, flow in self._flows(points, advective):
            u = side.table.N @ advected[self._space.velocity_cells[side.elements]]
            load = side.table.N.T @ ((0.5 * factor * flow)[:, :, None] * u)
            np.add.at(f, side.elements, self._space.local_vector(load))

    def _flows(self, points: Array, advective: Array) -> Iterator[tuple[SideGeometry, Array]]:
        """Sides, and a·n times length and weight at their points, shape (k, q)."""
        for side, a in self._through(points, advective):
            yield side, (a * side.normals).sum(axis=-1)

    def _through(self, points: Array, field: Array) -> Iterator[tuple[SideGeometry, Array]]:
        """Sides of elements in which a nodal field (n, 2) is not zero, and the field at their points, (k, q, 2)."""
        cells = self._space.velocity_cells
        there = self._sides[field[cells[self._sides[:, 0]]].any(axis=(1, 2))]
        for side in side_geometry(points[cells], there, self._space.velocity_sides):
            at_points = side.table.N @ field[cells[side.elements]]
            if at_points.any():
                yield side, at_points


def _product(side: SideGeometry, w: Array) -> Array:
    """∫ w N_i N_j over sides, shape (k, i, j), of weights (k, q)."""
    return np.asarray(side.table.N.T @ (w[:, :, None] * side.table.N))
