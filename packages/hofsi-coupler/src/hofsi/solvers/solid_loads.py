"""Forces on solids: body forces, tractions and follower pressures of a case, resolved on a mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.expressions import Expression
from hoblock.numbering import side_nodes
from hoblock.reference import gauss_legendre, gauss_lobatto, lagrange, lagrange_derivative
from hofsi import case
from hofsi.fem.element import element_table
from hofsi.fem.geometry import Geometry
from hofsi.kernels import elasticity as kernel

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["EdgeLoads", "FollowerPressure", "SolidLoads", "solid_sides"]


@dataclass(frozen=True, eq=False)
class _Sides:
    """Element sides walked counter-clockwise, all of one local number.

    Attributes
    ----------
    elements : ndarray, shape (k,)
    local : ndarray, shape (p + 1,)
        Local nodes in lexicographic order.
    nodes : ndarray, shape (k, p + 1)
    N, dN : ndarray, shape (q, p + 1)
        One-dimensional basis and its derivative in counter-clockwise direction.
    weights : ndarray, shape (q,)
    x : ndarray, shape (k, q, 2)
    lengths : ndarray, shape (k, q)
        Arc length times quadrature weight.
    """

    elements: Index
    local: Index
    nodes: Index
    N: Array
    dN: Array
    weights: Array
    x: Array
    lengths: Array


def _sides(mesh: QuadMesh, sides: Index, count: int) -> list[_Sides]:
    points, weights = gauss_legendre(count)
    nodes = gauss_lobatto(mesh.order)
    N, derivative = lagrange(nodes, points), lagrange_derivative(nodes, points)
    groups = []
    for number in np.unique(sides[:, 1]):
        elements = sides[sides[:, 1] == number, 0]
        local = side_nodes(mesh.order)[number]
        dN = derivative if number in (0, 1) else -derivative  # sides 2 and 3 run clockwise
        on_side = mesh.cells[elements][:, local]
        X = mesh.points[on_side]
        tangent = dN @ X
        lengths = np.hypot(tangent[..., 0], tangent[..., 1]) * weights
        groups.append(_Sides(elements, local, on_side, N, dN, weights, N @ X, lengths))
    return groups


@dataclass(frozen=True, eq=False)
class FollowerPressure:
    """A pressure on element sides at one time.

    Attributes
    ----------
    elements : ndarray, shape (k,)
    local : ndarray, shape (p + 1,)
        Local nodes of the side, in lexicographic order.
    nodes : ndarray, shape (k, p + 1)
    X : ndarray, shape (k, p + 1, 2)
        Undeformed positions.
    N, dN : ndarray, shape (q, p + 1)
    pressure : ndarray, shape (k, q)
        Times quadrature weight.
    m : ndarray, shape (k, 1, 1)
        1 where the load follows the deformation, 0 for linear solids, whose loads act on the undeformed body.
    """

    elements: Index
    local: Index
    nodes: Index
    X: Array
    N: Array
    dN: Array
    pressure: Array
    m: Array

    def scaled(self, factor: float) -> FollowerPressure:
        """Return the same load times a factor."""
        return replace(self, pressure=factor * self.pressure)

    def add_force(self, f: Array, displacement: Array) -> None:
        """Add the nodal forces at a displacement (n, 2) to ``f`` (n, 2)."""
        x = self.X + self.m * displacement[self.nodes]
        np.add.at(f, self.nodes, kernel.pressure_force(self.N, self.dN, x, self.pressure))

    def subtract_stiffness(self, K: Array, position: Index) -> None:
        """Subtract the derivative of the force from element matrices (e, 2 i, 2 j).

        Parameters
        ----------
        K : ndarray
            Local unknowns 2 i + a.
        position : ndarray
            Where a local node in lexicographic order stands among the local nodes of ``K``.
        """
        following = self.m * kernel.pressure_stiffness(self.N, self.dN, self.pressure)
        local = (2 * position[self.local][:, None] + np.arange(2)).ravel()
        K[self.elements[:, None, None], local[:, None], local] -= following


def _pair(force: case.VectorExpression, x: Array, time: float) -> Array:
    return np.stack([f.evaluate(x=x[..., 0], y=x[..., 1], t=time) for f in force], axis=-1)


def _steady(expressions: Sequence[Expression]) -> bool:
    return not any("t" in expression.variables_used for expression in expressions)


class EdgeLoads:
    """Tractions and pressures on element sides.

    Parameters
    ----------
    mesh : QuadMesh
    conditions : sequence of (Traction or Pressure, ndarray of shape (k, 2))
        With the element sides they act on.
    m : ndarray, shape (e, 1)
        0 for linear solids, 1 for the others.
    count : int
        Quadrature points on a side.

    Attributes
    ----------
    steady : bool
        Whether the tractions do not depend on time.
    """

    def __init__(
        self,
        mesh: QuadMesh,
        conditions: Sequence[tuple[case.Traction | case.Pressure, Index]],
        m: Array,
        count: int,
    ) -> None:
        self._mesh, self._m = mesh, m
        self._tractions: list[tuple[case.VectorExpression, list[_Sides]]] = []
        self._pressures: list[tuple[Expression, list[_Sides]]] = []
        for condition, sides in conditions:
            groups = _sides(mesh, sides, count)
            if isinstance(condition, case.Traction):
                self._tractions.append(((condition.x, condition.y), groups))
            else:
                self._pressures.append((condition.value, groups))
        self.steady = _steady([f for force, _ in self._tractions for f in force])

    def tractions(self, time: float) -> Array:
        """Nodal forces of the tractions, shape (n, 2)."""
        f = np.zeros(self._mesh.points.shape)
        for traction, groups in self._tractions:
            for side in groups:
                values = kernel.traction_force(side.N, side.lengths, _pair(traction, side.x, time))
                np.add.at(f, side.nodes, values)
        return f

    def pressures(self, time: float) -> list[FollowerPressure]:
        """Follower loads at a time; those that are zero everywhere are left out."""
        loads = []
        for value, groups in self._pressures:
            for side in groups:
                p = value.evaluate(x=side.x[..., 0], y=side.x[..., 1], t=time) * side.weights
                if p.any():
                    m = self._m[side.elements][:, :, None]
                    X = self._mesh.points[side.nodes]
                    loads.append(FollowerPressure(side.elements, side.local, side.nodes, X, side.N, side.dN, p, m))
        return loads


class SolidLoads:
    """Body forces, tractions and pressures on the solids of a mesh.

    Parameters
    ----------
    mesh : QuadMesh
    solids : sequence of Solid
    cells : sequence of ndarray
        Elements of each solid.
    geometry : Geometry
        Of all elements at ``count`` × ``count`` points.
    m : ndarray, shape (e, 1)
        0 for linear solids, 1 for the others.
    count : int
        Quadrature points on a side.
    """

    def __init__(
        self,
        mesh: QuadMesh,
        solids: Sequence[case.Solid],
        cells: Sequence[Index],
        geometry: Geometry,
        m: Array,
        count: int,
    ) -> None:
        self._mesh, self._geometry = mesh, geometry
        self._N = element_table(mesh.order, count).N
        self._body = [(s.body_force, own) for s, own in zip(solids, cells, strict=True) if s.body_force is not None]
        conditions = [
            (condition, solid_sides(mesh, condition.on, own))
            for solid, own in zip(solids, cells, strict=True)
            for condition in solid.boundaries
            if isinstance(condition, case.Traction | case.Pressure)
        ]
        self._edges = EdgeLoads(mesh, conditions, m, count)
        self._dead: Array | None = None
        self._dead_is_steady = self._edges.steady and _steady([f for force, _ in self._body for f in force])

    def dead(self, time: float) -> Array:
        """Nodal forces of body forces and tractions, shape (n, 2); read-only, kept if they do not depend on time."""
        if self._dead is None or not self._dead_is_steady:
            f = self._edges.tractions(time)
            for force, own in self._body:
                at_points = _pair(force, self._geometry.x[own], time)
                values = kernel.body_force(self._N, self._geometry.weights[own], at_points)
                np.add.at(f, self._mesh.cells[own], values)
            f.setflags(write=False)
            self._dead = f
        return self._dead

    def pressures(self, time: float) -> list[FollowerPressure]:
        """Follower loads at a time; those that are zero everywhere are left out."""
        return self._edges.pressures(time)


def solid_sides(mesh: QuadMesh, names: Sequence[str], own: Index) -> Index:
    """Element sides of named edges that belong to the elements of a solid, shape (k, 2); each counts once."""
    sides = np.concatenate([mesh.edge_groups[name] for name in names])
    return np.unique(sides[np.isin(sides[:, 0], own)], axis=0)
