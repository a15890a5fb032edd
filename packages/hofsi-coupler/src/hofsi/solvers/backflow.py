"""Outlets through which fluid comes back: the energy that it would bring in is held off."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hofsi import case
from hofsi.fem.geometry import SideGeometry, side_geometry
from hofsi.fem.spaces import TaylorHood
from hofsi.solvers.fluid_matrices import SideTerm

Array = NDArray[np.float64]

__all__ = ["Backflow"]


class Backflow:
    """The additional traction β (ρ/2) min(a·n, 0) u on open edges, a the velocity relative to the mesh.

    Where fluid leaves it vanishes. Where it comes in, convection brings in the energy ρ/2 |a·n| |u|² per unit length
    and time, which without β nothing limits; with β = 1 that is balanced.

    Parameters
    ----------
    mesh : QuadMesh
    space : TaylorHood
    conditions : sequence of FluidCondition
        Those with ``backflow`` are stabilised.
    density : float

    References
    ----------
    Braack, Mucha, J. Comput. Math. 32 (2014) 507–521, doi:10.4208/jcm.1405-m4347.
    Bertoglio et al., Int. J. Numer. Meth. Biomed. Engng. 34 (2018) e2918, doi:10.1002/cnm.2918.
    """

    def __init__(
        self, mesh: QuadMesh, space: TaylorHood, conditions: Sequence[case.FluidCondition], density: float
    ) -> None:
        self._space = space
        self._open = [
            (0.5 * density * factor, np.concatenate([mesh.edge_groups[name] for name in condition.on]))
            for condition in conditions
            if (factor := backflow_factor(condition))
        ]

    def terms(self, points: Array, advective: Array) -> list[SideTerm]:
        """Its share of element matrices, for a nodal advective velocity (n, 2); none where no fluid comes in."""
        return [
            SideTerm(a, a, side.elements, side.table.N.T @ (w[:, :, None] * side.table.N))
            for side, w in self._incoming(points, advective)
            if w.any()
            for a in range(2)
        ]

    def subtract(self, f: Array, points: Array, advective: Array, velocity: Array) -> None:
        """Take its product with a velocity (n, 2) off element vectors."""
        for side, w in self._incoming(points, advective):
            u = side.table.N @ velocity[self._space.velocity_cells[side.elements]]
            np.subtract.at(f, side.elements, self._space.local_vector(side.table.N.T @ (w[:, :, None] * u)))

    def _incoming(self, points: Array, advective: Array) -> Iterator[tuple[SideGeometry, Array]]:
        """Sides, and -β (ρ/2) min(a·n, 0) times length and weight at their points, shape (k, q)."""
        cells = self._space.velocity_cells
        for factor, sides in self._open:
            for side in side_geometry(points[cells], sides, self._space.velocity_sides):
                a = side.table.N @ advective[cells[side.elements]]
                yield side, -factor * np.minimum((a * side.normals).sum(axis=-1), 0.0)


def backflow_factor(condition: case.FluidCondition | None) -> float:
    """β of a condition, 0 for those that have none."""
    return condition.backflow if isinstance(condition, case.DoNothing | case.Traction | case.Pressure) else 0.0
