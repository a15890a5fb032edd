"""Taylor–Hood spaces Qp/Qp-1 on a mesh of order p."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.numbering import corner_nodes, number_nodes
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_gradient, tensor_quadrature
from hofsi.fem.element import ElementTable, boundary_first, side_table

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

    Attributes
    ----------
    velocity_cells : ndarray, shape (e, n)
    pressure_cells : ndarray, shape (e, m)
    velocity_count, pressure_count : int
    velocity_boundary, pressure_boundary : int
        Local nodes on the element's boundary.
    velocity, pressure : ElementTable
        Basis at the element's quadrature points.
    velocity_sides : tuple of ElementTable
        Velocity basis on the four sides.
    dofs : ndarray, shape (e, 2n + m)
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

    @staticmethod
    def on(mesh: QuadMesh) -> TaylorHood:
        """Make the spaces on a mesh of order p ≥ 2, with p + 2 quadrature points in each direction."""
        return TaylorHood._numbered(mesh.order, mesh.corners, mesh.cells, len(mesh.points))

    @staticmethod
    def on_quads(corners: Index, order: int) -> TaylorHood:
        """Make the spaces on quads of which only the corners are known, shape (e, 4), counter-clockwise."""
        return TaylorHood._numbered(order, corners, *number_nodes(corners, order))

    @staticmethod
    def _numbered(p: int, corners: Index, velocity_cells: Index, n_count: int) -> TaylorHood:
        if p < 2:
            raise ValueError(f"Taylor–Hood elements need mesh.order >= 2; got {p}.")
        v_order, nb = boundary_first(p)
        p_order, mb = boundary_first(p - 1)
        cells, count = number_nodes(corners, p - 1)
        vc, pc = velocity_cells[:, v_order], cells[:, p_order]
        x, y, q = 2 * vc, 2 * vc + 1, 2 * n_count + pc
        dofs = np.concatenate([x[:, :nb], y[:, :nb], q[:, :mb], x[:, nb:], y[:, nb:], q[:, mb:]], axis=1)
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
        A = np.zeros((velocity.shape[2], width, width))
        for a in range(2):
            for b in range(2):
                self.put(A, a, b, velocity[a, b])
            self.put(A, 2, a, divergence[a])
            self.put(A, a, 2, divergence[a].transpose(0, 2, 1))
        return A

    def put(self, A: Array, row: int, column: int, block: Array) -> None:
        """Write the block of a pair of fields into element matrices in local order."""
        for rows, first in self._halves(row):
            for columns, second in self._halves(column):
                A[:, rows, columns] = block[:, first, second]

    def _halves(self, field: int) -> Iterator[tuple[slice, slice]]:
        """Rows of a field on the boundary and inside, in an element's matrix and in a block."""
        b = self.on_boundary(field)
        yield from zip(self.rows(field), (slice(None, b), slice(b, None)), strict=True)

    def local_vector(self, velocity: Array) -> Array:
        """Element vectors (e, 2n + m) from nodal vectors (e, n, 2); zero for the pressure."""
        result = np.zeros((len(velocity), self.dofs.shape[1]))
        b = self.velocity_boundary
        for a in range(2):
            on, inside = self.rows(a)
            result[:, on], result[:, inside] = velocity[:, :b, a], velocity[:, b:, a]
        return result
