"""Taylor–Hood spaces Qp/Qp-1 on a mesh of order p."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.numbering import corner_nodes, number_nodes
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_gradient, tensor_quadrature
from hofsi.fem.element import ElementTable, boundary_first, side_table
from hofsi.fem.periodic import PeriodicSides, representatives

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["TaylorHood", "permuted"]


def permuted(table: ElementTable, order: Index) -> ElementTable:
    """Return a table with its basis functions in another order."""
    return ElementTable(table.order, table.points, table.weights, table.N[:, order], table.dN[:, order])


@dataclass(frozen=True, eq=False)
class TaylorHood:
    """Numbering and basis of velocity (order p, the mesh's nodes) and pressure (order p - 1).

    Local nodes are reordered so that those on the element's boundary come first. The local unknowns of an element are
    [u_x, u_y, p on the boundary | u_x, u_y, p inside]; globally velocity node n has 2n, 2n + 1 and pressure k has
    2·(velocity nodes) + k.

    Nodes at periodic sides are one node for the equations, by its smallest number, and several for nodal arrays, which
    hold the same value at each: values are gathered with the cells, and summed with ``dofs``.

    Attributes
    ----------
    velocity_cells : ndarray, shape (e, n)
    pressure_cells : ndarray, shape (e, m)
        Nodes of the elements.
    velocity_count, pressure_count : int
    velocity_boundary, pressure_boundary : int
        Local nodes on the element's boundary.
    velocity, pressure : ElementTable
        Basis at the element's quadrature points.
    velocity_sides : tuple of ElementTable
        Velocity basis on the four sides.
    dofs : ndarray, shape (e, 2n + m)
        Unknowns of the elements.
    node_dofs : ndarray, shape (e, 2n + m)
        The same where every node counts by itself; the same array without periodic sides.
    same : tuple of ndarray, or None
        For each velocity node and each pressure node the one that stands for it; None without periodic sides.
    """

    velocity_cells: Index
    pressure_cells: Index
    velocity_count: int
    pressure_count: int
    velocity_boundary: int
    pressure_boundary: int
    velocity: ElementTable
    pressure: ElementTable
    velocity_sides: tuple[ElementTable, ...]
    pressure_sides: tuple[ElementTable, ...]
    dofs: Index
    node_dofs: Index
    same: tuple[Index, Index] | None = None

    @staticmethod
    def on(mesh: QuadMesh, periodic: Sequence[PeriodicSides] = ()) -> TaylorHood:
        """Make the spaces on a mesh of order p ≥ 2, with p + 2 quadrature points in each direction."""
        return TaylorHood._numbered(mesh.order, mesh.corners, mesh.cells, len(mesh.points), periodic)

    @staticmethod
    def on_quads(corners: Index, order: int) -> TaylorHood:
        """Make the spaces on quads of which only the corners are known, shape (e, 4), counter-clockwise."""
        return TaylorHood._numbered(order, corners, *number_nodes(corners, order))

    @staticmethod
    def _numbered(
        p: int, corners: Index, velocity_cells: Index, n_count: int, periodic: Sequence[PeriodicSides] = ()
    ) -> TaylorHood:
        if p < 2:
            raise ValueError(f"Taylor–Hood elements need mesh.order >= 2; got {p}.")
        v_order, nb = boundary_first(p)
        p_order, mb = boundary_first(p - 1)
        cells, count = number_nodes(corners, p - 1)
        vc, pc = velocity_cells[:, v_order], cells[:, p_order]
        node_dofs = dofs = _unknowns(vc, pc, nb, mb, n_count)
        same: tuple[Index, Index] | None = None
        if periodic:
            pairs = (
                np.concatenate([s.pairs(c, o) for s in periodic]) for c, o in ((velocity_cells, p), (cells, p - 1))
            )
            velocity, pressure = (representatives(k, n) for k, n in zip(pairs, (n_count, count), strict=True))
            same = velocity, pressure
            dofs = _unknowns(velocity[vc], pressure[pc], nb, mb, n_count)
        points, weights = tensor_quadrature(p + 2)
        tables = []
        for order, permutation in ((p, v_order), (p - 1, p_order)):
            nodes = gauss_lobatto(order)
            tables.append(
                ElementTable(
                    order,
                    points,
                    weights,
                    tensor_basis(nodes, points)[:, permutation],
                    tensor_gradient(nodes, points)[:, permutation],
                )
            )
        return TaylorHood(
            vc,
            pc,
            n_count,
            count,
            nb,
            mb,
            tables[0],
            tables[1],
            tuple(permuted(table, v_order) for table in side_table(p, p + 2)),
            tuple(permuted(table, p_order) for table in side_table(p - 1, p + 2)),
            dofs,
            node_dofs,
            same,
        )

    @property
    def order(self) -> int:
        """Order p of the velocity."""
        return self.velocity.order

    @property
    def corners(self) -> Index:
        """Velocity nodes at the corners of each element, counter-clockwise, shape (e, 4)."""
        local = np.argsort(boundary_first(self.order)[0])
        return np.asarray(self.velocity_cells[:, local[corner_nodes(self.order)]])

    @property
    def size(self) -> int:
        """Number of unknowns, constrained ones included."""
        return 2 * self.velocity_count + self.pressure_count

    @property
    def velocity_unknowns(self) -> Index:
        """The velocity nodes of the elements by the ones that stand for them, shape (e, n)."""
        return self.velocity_cells if self.same is None else self.same[0][self.velocity_cells]

    @property
    def pressure_unknowns(self) -> Index:
        """The pressure nodes of the elements by the ones that stand for them, shape (e, m)."""
        return self.pressure_cells if self.same is None else self.same[1][self.pressure_cells]

    @property
    def copies(self) -> Index:
        """Unknowns that are not solved for, and those that they are copies of, shape (k, 2)."""
        if self.same is None:
            return np.zeros((0, 2), dtype=np.int64)
        velocity, pressure = self.same
        original = np.concatenate([(2 * velocity[:, None] + np.arange(2)).ravel(), 2 * self.velocity_count + pressure])
        copied = np.flatnonzero(original != np.arange(self.size))
        return np.stack([copied, original[copied]], axis=-1)

    def standing_for(self, nodes: Index) -> Index:
        """The velocity nodes that stand for some, in the same order."""
        return nodes if self.same is None else self.same[0][nodes]

    def with_copies(self, nodes: Index) -> Index:
        """Some velocity nodes, ascending, and all that are the same for the equations."""
        return nodes if self.same is None else np.flatnonzero(np.isin(self.same[0], self.same[0][nodes]))

    def copied(self, velocity: Array) -> Array:
        """A nodal array (n, ...) with the values of the nodes that stand for others at all of them."""
        return velocity if self.same is None else velocity[self.same[0]]

    @property
    def boundary(self) -> int:
        """Number of local unknowns on the element's boundary."""
        return 2 * self.velocity_boundary + self.pressure_boundary

    def rows(self, field: int) -> tuple[slice, slice]:
        """Local unknowns of a field (0 and 1 velocity, 2 pressure), on the boundary and inside."""
        nb, mb = self.velocity_boundary, self.pressure_boundary
        ni, mi = self.velocity_cells.shape[1] - nb, self.pressure_cells.shape[1] - mb
        start, inner = (0, nb, 2 * nb)[field], self.boundary + (0, ni, 2 * ni)[field]
        return slice(start, start + (nb, nb, mb)[field]), slice(inner, inner + (ni, ni, mi)[field])

    def on_boundary(self, field: int) -> int:
        """Local nodes of a field (0 and 1 velocity, 2 pressure) on the element's boundary."""
        return self.pressure_boundary if field == 2 else self.velocity_boundary

    def matrices(self, velocity: Array, divergence: Array) -> Array:
        """Element matrices of a saddle point in local order, shape (m, k, k), with zeros for two pressures.

        Parameters
        ----------
        velocity : ndarray, shape (2, 2, m, n, n)
            Blocks of the velocity's components.
        divergence : ndarray, shape (2, m, k, n)
            Blocks of a pressure and each component; the transposed ones are theirs.
        """
        width = self.dofs.shape[1]
        A = np.empty((velocity.shape[2], width, width))
        for rows, _ in self._halves[2]:
            for columns, _ in self._halves[2]:
                A[:, rows, columns] = 0.0
        for a in range(2):
            for b in range(2):
                self.put(A, a, b, velocity[a, b])
            self.put(A, 2, a, divergence[a])
            self.put(A, a, 2, divergence[a].transpose(0, 2, 1))
        return A

    def put(self, A: Array, row: int, column: int, block: Array) -> None:
        """Write the block of a pair of fields into element matrices in local order."""
        for rows, first in self._halves[row]:
            for columns, second in self._halves[column]:
                A[:, rows, columns] = block[:, first, second]

    @cached_property
    def _halves(self) -> tuple[tuple[tuple[slice, slice], ...], ...]:
        """Rows of each field on the boundary and inside, in an element's matrix and in a block."""
        counts = [self.on_boundary(field) for field in range(3)]
        return tuple(
            tuple(zip(self.rows(field), (slice(None, b), slice(b, None)), strict=True))
            for field, b in enumerate(counts)
        )

    def local_vector(self, velocity: Array) -> Array:
        """Element vectors (e, 2n + m) from nodal vectors (e, n, 2); zero for the pressure."""
        result = np.zeros((len(velocity), self.dofs.shape[1]))
        b = self.velocity_boundary
        for a in range(2):
            on, inside = self.rows(a)
            result[:, on], result[:, inside] = velocity[:, :b, a], velocity[:, b:, a]
        return result


def _unknowns(velocity: Index, pressure: Index, nb: int, mb: int, nodes: int) -> Index:
    """Unknowns of elements in local order, from the numbers of their nodes, those on the boundary (nb, mb) first."""
    x, y, q = 2 * velocity, 2 * velocity + 1, 2 * nodes + pressure
    return np.concatenate([x[:, :nb], y[:, :nb], q[:, :mb], x[:, nb:], y[:, nb:], q[:, mb:]], axis=1)
