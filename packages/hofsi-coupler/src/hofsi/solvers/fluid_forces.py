"""The force of the fluid on parts of its boundary, by the residual of the momentum equation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.numbering import side_nodes
from hofsi import case
from hofsi.errors import CaseError
from hofsi.fem.element import boundary_first
from hofsi.fem.geometry import SideGeometry, physical_gradients, side_geometry
from hofsi.fem.sides import boundary_sides
from hofsi.solvers.fluid import FluidSolver, FluidState

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["BoundaryForce", "NeighbourSides", "given_traction", "interface_sides", "named_sides"]


@dataclass(frozen=True)
class _Corner:
    """A side with given velocity that meets the set in one node.

    Attributes
    ----------
    element, side, node : int
        ``node`` is local, in the order of the velocity space.
    given : tuple of bool
        Components whose velocity is given; the residual holds the traction of these only.
    slip : bool
        Of the traction only the part along the normal counts.
    periodic : bool
        The residual holds the traction of the fluid beyond.
    """

    element: int
    side: int
    node: int
    given: tuple[bool, bool]
    slip: bool
    periodic: bool


class NeighbourSides:
    """What the sides around a set of boundary sides add to the momentum residual at the nodes of the set.

    The residual at a node is ∫ φ σ·n over all sides at the node whose velocity is given. For every side outside the
    set that meets it in a node, its share is integrated directly.

    Parameters
    ----------
    solver : FluidSolver
    sides : sequence of (int, int)
        Elements and sides outside the set.
    nodes : ndarray
        Of the set.

    Attributes
    ----------
    nodes : ndarray, shape (c,)
        Where they meet; a node may occur twice. Its length is that of this object.
    cancels : ndarray of bool, shape (c,)
        Whether the side is periodic and the set has all nodes that are the same as this one: then the shares of the
        sides opposite add up to no force, and what is integrated would only add its error.
    """

    def __init__(self, solver: FluidSolver, sides: Sequence[tuple[int, int]], nodes: Index) -> None:
        mesh = solver.mesh
        found = _corners(mesh, sides, _conditions(mesh, solver.fluid.boundaries), nodes)
        self._solver, self._corners = solver, sorted(found, key=lambda corner: corner.side)
        cells = solver.space.velocity_cells
        self.nodes = np.array([cells[corner.element, corner.node] for corner in self._corners], dtype=np.int64)
        own = solver.space.standing_for(self.nodes)
        others = solver.space.with_copies(np.unique(self.nodes))
        open_ended = solver.space.standing_for(others[~np.isin(others, nodes)])
        self.cancels = np.array([corner.periodic for corner in self._corners], dtype=bool) & ~np.isin(own, open_ended)

    def __len__(self) -> int:
        return len(self._corners)

    def forces(self, state: FluidState) -> Array:
        """∫ φ σ·n for each of ``nodes``, shape (c, 2)."""
        solver, corners = self._solver, self._corners
        cells = solver.space.velocity_cells[[corner.element for corner in corners]]
        rows = np.array([[k, corner.side] for k, corner in enumerate(corners)])
        forces = np.zeros((len(corners), 2))
        for group in side_geometry(state.points[0][cells], rows, solver.space.velocity_sides):
            members = [corners[k] for k in group.elements]
            traction = _traction(solver, group, np.array([corner.element for corner in members]), state)
            for k, corner, t, n in zip(group.elements, members, traction, group.normals, strict=True):
                if corner.slip:
                    t = n * (np.sum(t * n, axis=-1) / np.sum(n * n, axis=-1))[:, None]
                forces[k] = np.where(corner.given, group.table.N[:, corner.node] @ t, 0.0)
        return forces


class BoundaryForce:
    """Force of the fluid on some named edges: minus the sum of the momentum residual over their nodes.

    The residual at a node is what holds the fluid there: ∫ φ σ·n over all sides at the node whose velocity is given.
    Where an edge of the set meets such a side outside the set, for example the wall and the inlet of a channel, that
    side's share ∫ φ σ·n is integrated directly and taken off. A set of closed contours has no such node and costs only
    a sum.

    Where the traction is given instead of the velocity, or is that of the do-nothing condition, the residual vanishes
    and the force is minus the integral of that traction.

    Parameters
    ----------
    solver : FluidSolver
    names : sequence of str
        Of the mesh's edges; each side counts once.

    Raises
    ------
    CaseError
        If a name is unknown or its edges are not at the fluid's boundary.

    References
    ----------
    Gresho, Sani: Incompressible Flow and the Finite Element Method, Wiley 1998, Section 3.8 (consistent fluxes).
    John, Matthies, Int. J. Numer. Meth. Fluids 37 (2001) 885–903, doi:10.1002/fld.195.
    """

    def __init__(self, solver: FluidSolver, names: Sequence[str]) -> None:
        mesh = solver.mesh
        outer = boundary_sides(mesh)
        chosen = named_sides(mesh, names)
        self._solver = solver
        self._nodes = np.unique(mesh.cells[chosen[:, 0, None], side_nodes(mesh.order)[chosen[:, 1]]])
        self._loaded = [
            (condition, sides)
            for condition in solver.fluid.boundaries
            if not all(_given(condition)) and (sides := _part_of(chosen, mesh, condition.on)).size
        ]
        inside = set(map(tuple, chosen.tolist()))
        others = [(element, side) for element, side in outer.tolist() if (element, side) not in inside]
        self._neighbours = NeighbourSides(solver, others, self._nodes)

    def evaluate(self, state: FluidState) -> Array:
        """Return the force at a state that the solver has computed, shape (2,)."""
        force = -state.reaction[self._nodes].sum(axis=0)
        for _, load in self._loads(state):
            force -= load.sum(axis=(0, 1))
        if self._neighbours:
            force += self._neighbours.forces(state)[~self._neighbours.cancels].sum(axis=0)
        return np.asarray(force)

    def moment(self, state: FluidState, about: Array) -> float:
        """Return the moment of the same force about a point (2,), counter-clockwise positive.

        The nodal forces balance a rigid rotation of the fluid as they balance a translation: its velocity is in the
        space of the test functions.
        """
        arms = state.points[0] - about
        moment = -float(_cross(arms[self._nodes], state.reaction[self._nodes]).sum())
        for x, load in self._loads(state):
            moment -= float(_cross(x - about, load).sum())
        if self._neighbours:
            moment += float(_cross(arms[self._neighbours.nodes], self._neighbours.forces(state)).sum())
        return moment

    def _loads(self, state: FluidState) -> Iterator[tuple[Array, Array]]:
        """Places on sides with a given traction, and that traction times length and weight, each (k, q, 2)."""
        solver = self._solver
        for condition, sides in self._loaded:
            X = state.points[0][solver.space.velocity_cells]
            for group in side_geometry(X, sides, solver.space.velocity_sides):
                yield group.x, given_traction(solver, condition, group, state)


def interface_sides(solver: FluidSolver) -> Index:
    """Element sides at the fluid's boundary that no condition names, shape (k, 2): those wet by solids."""
    mesh, outer = solver.mesh, boundary_sides(solver.mesh)
    dry = [mesh.edge_groups[name] for condition in solver.fluid.boundaries for name in condition.on]
    named = np.concatenate(dry) if dry else np.zeros((0, 2), dtype=np.int64)
    return np.asarray(outer[~np.isin(outer @ [4, 1], named @ [4, 1])])


def given_traction(
    solver: FluidSolver, condition: case.FluidCondition, group: SideGeometry, state: FluidState
) -> Array:
    """Traction that a condition prescribes, times length and weight, (k, q, 2); 0 where it gives the velocity."""
    if isinstance(condition, case.DoNothing):
        given = _transposed(solver, group, _gradient(solver, group, group.elements, state))
    else:
        given = solver.boundary.traction(condition, group, state.time)
    return np.where(_given(condition), 0.0, given)


def _cross(first: Array, second: Array) -> Array:
    """z component of the product of vectors (..., 2)."""
    return np.asarray(first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0])


def _corners(
    mesh: QuadMesh,
    sides: Sequence[tuple[int, int]],
    conditions: dict[tuple[int, int], case.FluidCondition],
    nodes: Index,
) -> Iterator[_Corner]:
    """Where some sides with given velocity meet some nodes."""
    position = np.argsort(boundary_first(mesh.order)[0])
    ends = side_nodes(mesh.order)[:, [0, -1]]
    for element, side in sides:
        condition = conditions.get((element, side))
        given = _given(condition)
        if any(given):
            slip, periodic = isinstance(condition, case.Slip), isinstance(condition, case.Periodic)
            for node in ends[side][np.isin(mesh.cells[element, ends[side]], nodes)]:
                yield _Corner(element, side, int(position[node]), given, slip, periodic)


def _gradient(solver: FluidSolver, group: SideGeometry, elements: Index, state: FluidState) -> Array:
    """∂_b u_a at the points of sides, shape (k, q, a, b)."""
    u = state.velocity[solver.space.velocity_cells[elements]]
    return np.stack([dN @ u for dN in physical_gradients(group, group.table)], axis=-1)


def _transposed(solver: FluidSolver, group: SideGeometry, gradient: Array) -> Array:
    """μ (∇u)ᵀ·n times length and weight, shape (k, q, 2): the traction that the do-nothing condition leaves."""
    return np.asarray(solver.fluid.viscosity * np.einsum("kqba,kqb->kqa", gradient, group.normals))


def _traction(solver: FluidSolver, group: SideGeometry, elements: Index, state: FluidState) -> Array:
    """σ·n times length and weight at the points of sides of some elements, shape (k, q, 2)."""
    gradient = _gradient(solver, group, elements, state)
    p = state.pressure[solver.space.pressure_cells[elements]] @ solver.space.pressure_sides[group.number].N.T
    along = solver.fluid.viscosity * np.einsum("kqab,kqb->kqa", gradient, group.normals)
    return np.asarray(along + _transposed(solver, group, gradient) - p[..., None] * group.normals)


def named_sides(mesh: QuadMesh, names: Sequence[str]) -> Index:
    """Element sides of some named edges at the fluid's boundary, shape (k, 2), each once.

    Raises
    ------
    CaseError
        If a name is unknown or its edges are not at the fluid's boundary.
    """
    outer = boundary_sides(mesh)
    for name in names:
        if name not in mesh.edge_groups:
            known = ", ".join(sorted(mesh.edge_groups))
            raise CaseError(f"no edges named {name!r} at the fluid; known: {known}. Correct the name.", "force.on")
    sides = np.unique(np.concatenate([mesh.edge_groups[name] for name in names]), axis=0)
    wrong = ~np.isin(sides @ [4, 1], outer @ [4, 1])
    if wrong.any():
        raise CaseError(
            f"{int(wrong.sum())} element sides of {', '.join(names)} have the fluid on both sides; "
            "expected edges of the fluid's boundary. Use other names.",
            "force.on",
        )
    return sides


def _conditions(
    mesh: QuadMesh, conditions: Sequence[case.FluidCondition]
) -> dict[tuple[int, int], case.FluidCondition]:
    return {
        (int(element), int(side)): condition
        for condition in conditions
        for name in condition.on
        for element, side in mesh.edge_groups[name]
    }


def _given(condition: case.FluidCondition | None) -> tuple[bool, bool]:
    """Which components of the velocity are given; a side without a condition is wet by a solid.

    Slip counts as both: what is not given there, the tangential traction, is zero.
    """
    if isinstance(condition, case.Velocity):
        return condition.x is not None, condition.y is not None
    free = isinstance(condition, case.Traction | case.Pressure | case.DoNothing)
    return not free, not free


def _part_of(sides: Index, mesh: QuadMesh, names: Sequence[str]) -> Index:
    """Those of some sides that belong to some names."""
    named = np.concatenate([mesh.edge_groups[name] for name in names])
    return np.asarray(sides[np.isin(sides @ [4, 1], named @ [4, 1])])
