"""Supports of solids: given displacements and rollers of a case, resolved on a mesh."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.expressions import Expression
from hoblock.numbering import side_nodes
from hofsi import case
from hofsi.fem.constraints import DirectedNodes, NodeConstraints
from hofsi.fem.element import boundary_first, side_table
from hofsi.fem.normals import consistent_normals
from hofsi.fem.spaces import permuted
from hofsi.solvers.solid_loads import solid_sides

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["SolidSupports"]


class SolidSupports:
    """Where and how the solids of a mesh are held.

    Where conditions meet at a node, given displacements come before rollers, and earlier ones before later ones.

    Parameters
    ----------
    mesh : QuadMesh
    solids : sequence of Solid
    cells : sequence of ndarray
        Elements of each solid.

    Attributes
    ----------
    constraints : NodeConstraints
    """

    def __init__(self, mesh: QuadMesh, solids: Sequence[case.Solid], cells: Sequence[Index]) -> None:
        conditions = [
            (condition, solid_sides(mesh, condition.on, own))
            for solid, own in zip(solids, cells, strict=True)
            for condition in solid.boundaries
            if isinstance(condition, case.Displacement | case.Roller)
        ]
        entries: list[DirectedNodes] = []
        self._given: list[tuple[Expression, Array]] = []
        for condition, sides in conditions:
            if isinstance(condition, case.Displacement):
                nodes = np.unique(mesh.cells[sides[:, 0, None], side_nodes(mesh.order)[sides[:, 1]]])
                for axis, component in enumerate((condition.x, condition.y)):
                    if component is not None:
                        entries.append(DirectedNodes.component(nodes, axis))
                        self._given.append((component, mesh.points[nodes]))
        rollers = [sides for condition, sides in conditions if isinstance(condition, case.Roller)]
        if rollers:
            entries += _rollers(mesh, np.unique(np.concatenate(rollers), axis=0))
        self.constraints = NodeConstraints(len(mesh.points), entries)

    def impose(self, displacement: Array, time: float) -> Array:
        """Return the displacement (n, 2) with all supports satisfied at a time."""
        values = [expression.evaluate(x=X[:, 0], y=X[:, 1], t=time) for expression, X in self._given]
        values += [np.zeros(len(entry.nodes)) for entry in self.constraints.entries[len(values) :]]
        return self.constraints.impose(displacement, values)

    def free_part(self, force: Array) -> Array:
        """Nodal forces (n, 2) in the nodes' own frames, zero where the solid is held."""
        result = self._in_frames(force)
        result[self.constraints.fixed] = 0.0
        return result

    def held_part(self, force: Array) -> Array:
        """Nodal forces (n, 2) in x and y without their components in free directions."""
        own = self._in_frames(force)
        own[~self.constraints.fixed] = 0.0
        rotated = self.constraints.rotated
        own[rotated] = (self.constraints.frames[rotated] @ own[rotated][:, :, None])[:, :, 0]
        return own

    def _in_frames(self, force: Array) -> Array:
        own, rotated = force.copy(), self.constraints.rotated
        frames = self.constraints.frames[rotated]
        own[rotated] = (frames.transpose(0, 2, 1) @ force[rotated][:, :, None])[:, :, 0]
        return own


def _rollers(mesh: QuadMesh, sides: Index) -> list[DirectedNodes]:
    local, _ = boundary_first(mesh.order)
    tables = tuple(permuted(table, local) for table in side_table(mesh.order, mesh.order + 2))
    cells = mesh.cells[:, local]
    return consistent_normals(mesh.points[cells], cells, sides, tables)
