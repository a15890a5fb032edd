"""The force of solids on what holds or loads them at their boundary, by the residual of the momentum equation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.numbering import side_nodes
from hofsi import case
from hofsi.errors import CaseError
from hofsi.fem.element import side_table
from hofsi.fem.geometry import side_geometry
from hofsi.solvers.solid import SolidSolver, SolidState
from hofsi.solvers.solid_loads import EdgeLoads, solid_sides

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["SolidForce"]


@dataclass(frozen=True, eq=False)
class _End:
    """Where a held side has a node.

    Attributes
    ----------
    element, side, local, node : int
        ``local`` is the node's number in the element, in lexicographic order.
    chosen : bool
        Whether the side belongs to the set.
    held : ndarray, shape (2, 2)
        Projector onto the directions in which the side holds the node.
    """

    element: int
    side: int
    local: int
    node: int
    chosen: bool
    held: Array


class SolidForce:
    """Force of solids on their surroundings along some named outer edges: minus the integral of their traction.

    Where the solid is held, this is minus the sum of the supports' nodal forces, which balances loads and inertia
    exactly. Where a traction or pressure is given, it is minus the integral of that.

    Where two held sides meet in a node and only one of them belongs to the set, the nodal force is divided: by
    directions if each side holds one of its own, otherwise by the sides' own integrals ∫ φ σ·n, with what these miss
    divided equally. The forces on two sets then add up to that on their union.

    Parameters
    ----------
    solver : SolidSolver
    names : sequence of str
        Of the mesh's edges; each side counts once.

    Raises
    ------
    CaseError
        If a name is unknown.
    """

    def __init__(self, solver: SolidSolver, names: Sequence[str]) -> None:
        mesh = solver.mesh
        for name in names:
            if name not in mesh.edge_groups:
                known = ", ".join(sorted(mesh.edge_groups))
                raise CaseError(f"no edges named {name!r} at the solid; known: {known}. Correct the name.", "force.on")
        self._solver = solver
        self._tables = side_table(mesh.order, mesh.order + 2)
        conditions = [
            (condition, solid_sides(mesh, condition.on, own))
            for solid, own in zip(solver.solids, solver.equations.cells_of, strict=True)
            for condition in solid.boundaries
        ]
        chosen = np.unique(np.concatenate([mesh.edge_groups[name] for name in names]), axis=0) @ [4, 1]
        loads = [
            (condition, sides[np.isin(sides @ [4, 1], chosen)])
            for condition, sides in conditions
            if isinstance(condition, case.Traction | case.Pressure)
        ]
        self._loads = EdgeLoads(mesh, loads, solver.equations.m, mesh.order + 2)
        self._inside: Index
        self._divided: list[list[_End]] = []
        self._divide([end for condition, sides in conditions for end in self._ends(condition, sides, chosen)])

    def _ends(self, condition: case.SolidCondition, sides: Index, chosen: Index) -> Iterator[_End]:
        """All nodes of held sides."""
        mesh = self._solver.mesh
        if not isinstance(condition, case.Displacement | case.Roller):
            return
        for group in side_geometry(mesh.coordinates, sides, self._tables):
            for element, normals in zip(group.elements.tolist(), group.normals, strict=True):
                in_set = bool(np.isin(4 * element + group.number, chosen))
                for local in side_nodes(mesh.order)[group.number].tolist():
                    held = _projector(condition, group.table.N[:, local] @ normals)
                    yield _End(element, group.number, local, int(mesh.cells[element, local]), in_set, held)

    def _divide(self, ends: Sequence[_End]) -> None:
        """Separate nodes whose force belongs to the set completely from those where it is divided."""
        at: dict[int, list[_End]] = {}
        for end in ends:
            at.setdefault(end.node, []).append(end)
        chosen = {node: group for node, group in at.items() if any(end.chosen for end in group)}
        self._divided = [group for group in chosen.values() if not all(end.chosen for end in group)]
        whole = [node for node, group in chosen.items() if all(end.chosen for end in group)]
        self._inside = np.array(sorted(whole), dtype=np.int64)

    def evaluate(self, state: SolidState) -> Array:
        """Return the force at a state that the solver has computed, shape (2,).

        Raises
        ------
        ValueError
            If the state is an initial one.
        """
        if state.reaction is None:
            raise ValueError("the reaction of an initial state is not known; take a state that a step has made.")
        force = -self._loads.tractions(state.time).sum(axis=0)
        pushed = np.zeros_like(state.displacement)
        for pressure in self._loads.pressures(state.time):
            pressure.add_force(pushed, state.displacement)
        force -= pushed.sum(axis=0) + state.reaction[self._inside].sum(axis=0)
        for ends in self._divided:
            force -= self._share(ends, state.displacement, state.reaction[ends[0].node])
        return np.asarray(force)

    def _share(self, ends: Sequence[_End], displacement: Array, reaction: Array) -> Array:
        """What the set has of the supports' force on one node."""
        inside, outside = (_span([end for end in ends if end.chosen is chosen]) for chosen in (True, False))
        n, m = _normal(inside), _normal(outside)
        if n is not None and m is not None:
            sine = n[0] * m[1] - n[1] * m[0]
            if abs(sine) > 1e-6:
                return np.asarray(n * (reaction[0] * m[1] - reaction[1] * m[0]) / sine)
        own, others = (
            sum((self._direct(end, displacement) for end in ends if end.chosen is chosen), np.zeros(2))
            for chosen in (True, False)
        )
        missed = inside @ (reaction - own - others)
        return np.asarray(own + missed - 0.5 * outside @ missed)

    def _direct(self, end: _End, displacement: Array) -> Array:
        """∫ φ P·n over one side, in the directions that it holds."""
        mesh = self._solver.mesh
        table = self._tables[end.side]
        (group,) = side_geometry(mesh.coordinates[[end.element]], np.array([[0, end.side]]), self._tables)
        P = self._solver.equations.first_stress(displacement, end.element, table)
        traction = (P @ group.normals[0][:, :, None])[:, :, 0]
        return np.asarray(end.held @ (table.N[:, end.local] @ traction))


def _projector(condition: case.Displacement | case.Roller, normal: Array) -> Array:
    if isinstance(condition, case.Roller):
        return np.asarray(np.outer(normal, normal) / (normal @ normal))
    return np.diag([float(condition.x is not None), float(condition.y is not None)])


def _span(ends: Sequence[_End]) -> Array:
    """Projector onto all directions in which some sides hold their common node, shape (2, 2)."""
    values, vectors = np.linalg.eigh(sum((end.held for end in ends), np.zeros((2, 2))))
    held = vectors[:, values > 1e-6]
    return np.asarray(held @ held.T)


def _normal(projector: Array) -> Array | None:
    """The direction of a projector of rank one, otherwise None."""
    values, vectors = np.linalg.eigh(projector)
    return np.asarray(vectors[:, 1]) if values[0] < 0.5 else None
