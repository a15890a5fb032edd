"""Boundary conditions of the fluid on a mesh: constraints, loads and the do-nothing term."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.numbering import side_nodes
from hofsi import case
from hofsi.fem.constraints import DirectedNodes, NodeConstraints
from hofsi.fem.geometry import SideGeometry, physical_gradients, side_geometry
from hofsi.fem.normals import consistent_normals
from hofsi.fem.spaces import TaylorHood
from hofsi.solvers.fluid_matrices import SideTerm

if TYPE_CHECKING:
    from hoblock.expressions import Expression

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["FluidBoundary"]

_SAME = 1e-12  # change of a unit normal that is round-off


def _sides(mesh: QuadMesh, names: Sequence[str]) -> Index:
    return np.concatenate([mesh.edge_groups[name] for name in names])


def _nodes(mesh: QuadMesh, names: Sequence[str]) -> Index:
    return np.unique(np.concatenate([mesh.edge_nodes(name) for name in names]))


def _nodes_along(mesh: QuadMesh, sides: Index) -> Index:
    """Nodes of element sides (k, 2) from end to end, shape (k, order + 1)."""
    return np.asarray(mesh.cells[sides[:, 0, None], side_nodes(mesh.order)[sides[:, 1]]])


def _are_driven(mesh: QuadMesh, sides: Index, driven: Index) -> NDArray[np.bool_]:
    """Whether the nodes between the ends of element sides (k, 2) are driven; the ends may belong to other edges."""
    return np.asarray(np.isin(_nodes_along(mesh, sides)[:, 1:-1], driven).all(axis=1))


def _same_directions(first: Sequence[DirectedNodes], second: Sequence[DirectedNodes]) -> bool:
    """Whether two lists constrain the same nodes along the same directions, but for round-off."""
    return len(first) == len(second) and all(
        np.array_equal(a.nodes, b.nodes) and np.abs(a.directions - b.directions).max(initial=0.0) < _SAME
        for a, b in zip(first, second, strict=True)
    )


class _Sliding:
    """No-slip walls that stand, along which the mesh may slide.

    Parameters
    ----------
    mesh : QuadMesh
    space : TaylorHood
    conditions : sequence of FluidCondition
    driven : ndarray or None
        As of `FluidBoundary`.
    """

    def __init__(
        self, mesh: QuadMesh, space: TaylorHood, conditions: Sequence[case.FluidCondition], driven: Index | None
    ) -> None:
        self._space = space
        self._standing, self._carried = np.zeros((0, 2), dtype=np.int64), np.zeros(0, dtype=np.int64)
        self._last: tuple[Array, Index, Array] | None = None
        walls = [name for c in conditions if isinstance(c, case.NoSlip) for name in c.on]
        if driven is not None and walls:
            sides = _sides(mesh, walls)
            self._standing = sides[~_are_driven(mesh, sides, driven)]
            sides = _sides(mesh, [name for c in conditions if isinstance(c, case.NoSlip | case.Slip) for name in c.on])
            carried = np.unique(_nodes_along(mesh, sides[_are_driven(mesh, sides, driven)]))
            self._carried = space.standing_for(carried)

    def wall_velocity(self, points: Array, mesh_velocity: Array) -> Array:
        """Mesh velocity (n, 2) without its part along these walls; where they meet or end at driven walls it stays."""
        if not self._standing.size or not mesh_velocity.any():
            return mesh_velocity
        nodes, normals = self._normals(points)
        result = mesh_velocity.copy()
        result[nodes] = np.sum(normals * mesh_velocity[nodes], axis=1)[:, None] * normals
        return self._space.copied(result)

    def _normals(self, points: Array) -> tuple[Index, Array]:
        """Nodes that may slide, and their normals; kept while the mesh stands still."""
        if self._last is None or self._last[0] is not points:
            space = self._space
            X, nodes = points[space.velocity_cells], space.velocity_unknowns
            smooth = consistent_normals(X, nodes, self._standing, space.velocity_sides)[0]
            free = ~np.isin(smooth.nodes, self._carried)
            self._last = (points, smooth.nodes[free], smooth.directions[free])
        return self._last[1:]


class FluidBoundary:
    """The conditions of a fluid, resolved on its mesh.

    Where conditions meet at a node, the interface comes first, then no-slip walls, given velocities, slip. What holds
    at a node of a periodic side holds at the other side.

    A no-slip wall that is driven has the velocity of the mesh. Along any other wall the nodes may slide, because a
    moving boundary pushes them; such a wall has the normal part of the mesh velocity only.

    Parameters
    ----------
    mesh : QuadMesh
        In its reference position.
    space : TaylorHood
    conditions : sequence of FluidCondition
    interface : ndarray
        Nodes whose velocity the solid prescribes; may be empty.
    viscosity : float
    driven : ndarray or None
        Nodes that move as something outside the mesh wants them to; None if all do.

    Attributes
    ----------
    constrained_at : ndarray, shape (n, 2), or None
        Node positions at which the constraints at hand were made.
    """

    def __init__(
        self,
        mesh: QuadMesh,
        space: TaylorHood,
        conditions: Sequence[case.FluidCondition],
        interface: Index,
        viscosity: float,
        driven: Index | None = None,
    ) -> None:
        self._mesh, self._space, self._viscosity = mesh, space, viscosity
        self.interface = interface
        walls = [c for c in conditions if isinstance(c, case.NoSlip)]
        wall_nodes = _nodes(mesh, [name for c in walls for name in c.on]) if walls else np.zeros(0, dtype=np.int64)
        self.walls, self._wet = space.with_copies(wall_nodes), space.with_copies(interface)
        self._sliding = _Sliding(mesh, space, conditions, driven)
        self._given = [(c, _nodes(mesh, c.on)) for c in conditions if isinstance(c, case.Velocity)]
        slips = [c for c in conditions if isinstance(c, case.Slip)]
        self._slip = _sides(mesh, [name for c in slips for name in c.on]) if slips else np.zeros((0, 2), dtype=np.int64)
        self._loads = [(c, _sides(mesh, c.on)) for c in conditions if isinstance(c, case.Traction | case.Pressure)]
        self._partial = [
            (c, _sides(mesh, c.on))
            for c in conditions
            if isinstance(c, case.Velocity) and (c.traction_x or c.traction_y)
        ]
        free = [c for c in conditions if isinstance(c, case.DoNothing)]
        self._open = _sides(mesh, [name for c in free for name in c.on]) if free else np.zeros((0, 2), dtype=np.int64)
        self._constraints: NodeConstraints | None = None
        self._slipping: list[DirectedNodes] = []
        self._constraints_at: Array | None = None
        self.constrained_at: Array | None = None

    def stick(self, advective: Array, points: Array, mesh_velocity: Array) -> None:
        """Write what is known of the velocity relative to the mesh, at walls and interface, into a field (n, 2)."""
        walls = self.walls
        advective[walls] = self._sliding.wall_velocity(points, mesh_velocity)[walls] - mesh_velocity[walls]
        advective[self._wet] = 0.0

    def constraints(self, points: Array) -> NodeConstraints:
        """Constraints at given node positions; the same object as long as the normals of the slip edges stay."""
        if self._constraints is None or (self._slip.size and points is not self._constraints_at):
            slipping = self._slip_entries(points)
            if self._constraints is None or not _same_directions(slipping, self._slipping):
                self._constraints = NodeConstraints(len(points), [*self._fixed_entries(), *slipping])
                self._slipping = slipping
                self.constrained_at = points
        self._constraints_at = points
        return self._constraints

    def constrain_anew(self, points: Array) -> NodeConstraints:
        """Make the constraints at given node positions, however near they are to those at hand."""
        self._constraints = None
        return self.constraints(points)

    def _fixed_entries(self) -> list[DirectedNodes]:
        own = self._space.standing_for
        entries = [
            DirectedNodes.component(own(nodes), axis) for nodes in (self.interface, self.walls) for axis in range(2)
        ]
        for condition, nodes in self._given:
            for axis, component in enumerate((condition.x, condition.y)):
                if component is not None:
                    entries.append(DirectedNodes.component(own(nodes), axis))
        return entries

    def _slip_entries(self, points: Array) -> list[DirectedNodes]:
        if not self._slip.size:
            return []
        space = self._space
        return consistent_normals(
            points[space.velocity_cells], space.velocity_unknowns, self._slip, space.velocity_sides
        )

    def impose(self, velocity: Array, points: Array, mesh_velocity: Array, interface: Array, time: float) -> Array:
        """Return the velocity with all constraints satisfied.

        Parameters
        ----------
        velocity, points, mesh_velocity : ndarray, shape (n, 2)
        interface : ndarray, shape (k, 2)
            Velocity of the interface nodes.
        time : float
        """
        walls = self._sliding.wall_velocity(points, mesh_velocity)[self.walls]
        values = [interface[:, 0], interface[:, 1], walls[:, 0], walls[:, 1]]
        for condition, nodes in self._given:
            x, y = points[nodes].T
            values += [c.evaluate(x=x, y=y, t=time) for c in (condition.x, condition.y) if c is not None]
        constraints = self.constraints(points)
        values += [
            np.sum(entry.directions * mesh_velocity[entry.nodes], axis=1)
            for entry in constraints.entries[len(values) :]
        ]
        return self._space.copied(constraints.impose(velocity, values))

    def add_loads(self, f: Array, points: Array, time: float) -> None:
        """Add given tractions and pressures to element vectors (e, 2n + m)."""
        if not self._loads and not self._partial:
            return
        X = points[self._space.velocity_cells]
        for condition, sides in [*self._loads, *self._partial]:
            for side in side_geometry(X, sides, self._space.velocity_sides):
                traction = self.traction(condition, side, time)
                local = side.table.N.T @ traction
                np.add.at(f, side.elements, self._space.local_vector(local))

    @staticmethod
    def traction(condition: case.FluidCondition | None, side: SideGeometry, time: float) -> Array:
        """Given traction times length and weight at the points of sides, shape (k, q, 2); 0 where none is given."""
        x, y = side.x[..., 0], side.x[..., 1]
        if isinstance(condition, case.Pressure):
            return np.asarray(-condition.value.evaluate(x=x, y=y, t=time)[..., None] * side.normals)
        pair: tuple[Expression | None, Expression | None] = (None, None)
        if isinstance(condition, case.Traction):
            pair = condition.x, condition.y
        elif isinstance(condition, case.Velocity):
            pair = condition.traction_x, condition.traction_y
        values = [np.zeros_like(x) if c is None else c.evaluate(x=x, y=y, t=time) for c in pair]
        return np.stack(values, axis=-1) * side.lengths[..., None]

    def subtract_do_nothing(self, r: Array, points: Array, velocity: Array) -> None:
        """Subtract what the terms of `do_nothing` make of a nodal velocity (n, 2) from element vectors."""
        if not self._open.size:
            return
        space = self._space
        for side in side_geometry(points[space.velocity_cells], self._open, space.velocity_sides):
            u = velocity[space.velocity_cells[side.elements]]
            along = np.stack([dN @ u for dN in physical_gradients(side, side.table)], axis=-2)  # ∂_a u_b
            traction = self._viscosity * (along @ side.normals[..., None])[..., 0]
            np.add.at(r, side.elements, space.local_vector(side.table.N.T @ traction))

    def do_nothing(self, points: Array) -> list[SideTerm]:
        """-∫ μ (∂_a u_b n_b) v_a, which turns the natural condition into μ ∂u/∂n - p n = 0."""
        if not self._open.size:
            return []
        space, terms = self._space, []
        for side in side_geometry(points[space.velocity_cells], self._open, space.velocity_sides):
            gradients = physical_gradients(side, side.table)
            for a in range(2):
                for b in range(2):
                    w = -self._viscosity * side.normals[..., b]
                    block = side.table.N.T @ (w[:, :, None] * gradients[a])
                    terms.append(SideTerm(a, b, side.elements, block))
        return terms
