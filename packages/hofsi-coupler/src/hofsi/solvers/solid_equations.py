"""Discrete equations of elastic solids: nodal internal forces, tangents and masses on a mesh."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hoblock import QuadMesh
from hofsi import case
from hofsi.errors import CaseError
from hofsi.fem.assembly import MatrixPattern, assemble_vector
from hofsi.fem.element import ElementTable, boundary_first, element_table
from hofsi.fem.geometry import element_geometry
from hofsi.kernels import elasticity as kernel
from hofsi.solvers.solid_laws import SolidLaws
from hofsi.solvers.solid_loads import FollowerPressure, SolidLoads

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["SolidEquations"]


class SolidEquations:
    """Total Lagrangian equations of one or several solids on one mesh.

    Parameters
    ----------
    mesh : QuadMesh
        Undeformed; solid blocks only.
    solids : sequence of Solid
        Every element belongs to exactly one of them.

    Attributes
    ----------
    cells_of : list of ndarray
        Elements of each solid.
    dofs : ndarray, shape (e, 2 i)
        Unknowns 2 n + a of each element, those on its boundary first.
    boundary : int
        How many local unknowns lie on the element's boundary.
    linear : bool
        Whether all solids are linear.
    mass : csr_matrix, shape (n, n)
        Consistent mass matrix, the same for both components.
    m : ndarray, shape (e, 1)
        0 for linear solids, 1 for the others.
    loads : SolidLoads
    """

    def __init__(self, mesh: QuadMesh, solids: Sequence[case.Solid]) -> None:
        self.mesh = mesh
        self.cells_of = _cells_of(mesh, solids)
        local, on_boundary = boundary_first(mesh.order)
        count = mesh.order + 2
        table = element_table(mesh.order, count)
        geometry = element_geometry(mesh.coordinates, table)
        self._position = np.argsort(local)
        self._cells = mesh.cells[:, local]
        self._dN = np.ascontiguousarray(table.dN[:, local])
        self._weights = geometry.weights
        self._J_inv = kernel.components_outermost(geometry.J_inv)
        self._products = kernel.gradient_products(self._dN)
        self._laws = SolidLaws(len(mesh.cells), solids, self.cells_of)
        self.m = self._laws.m
        density = np.empty((len(mesh.cells), 1))
        for solid, own in zip(solids, self.cells_of, strict=True):
            density[own] = solid.density
        self.linear = not self.m.any()
        self.dofs = (2 * self._cells[:, :, None] + np.arange(2)).reshape(len(mesh.cells), -1)
        self.boundary = 2 * on_boundary
        self._share = 1.0 / np.repeat(np.bincount(mesh.cells.ravel(), minlength=len(mesh.points)), 2)
        self._element_mass = kernel.mass(table.N[:, local], geometry.weights, density)
        self.mass: sp.csr_matrix = MatrixPattern(self._cells, len(mesh.points)).matrix(self._element_mass).tocsr()
        self.loads = SolidLoads(mesh, solids, self.cells_of, geometry, self.m, count)

    def gradient(self, displacement: Array) -> Array:
        """Displacement gradient at quadrature points, shape (e, q, a, d), of nodal displacements (n, 2)."""
        return kernel.displacement_gradient(displacement[self._cells], self._dN, self._J_inv)

    def stress(self, gradient: Array) -> Array:
        """Second Piola–Kirchhoff stress, shape (e, q, 3): xx, yy, xy."""
        return self._laws.stress(gradient)

    def first_stress(self, displacement: Array, element: int, table: ElementTable) -> Array:
        """First Piola–Kirchhoff stress F S in one element at some points, shape (q, a, d).

        Parameters
        ----------
        displacement : ndarray, shape (n, 2)
        element : int
        table : ElementTable
            Basis at the points, local nodes in lexicographic order.
        """
        own, nodes = slice(element, element + 1), self.mesh.cells[[element]]
        J_inv = element_geometry(self.mesh.points[nodes], table).J_inv
        H = kernel.displacement_gradient(displacement[nodes], table.dN, J_inv)
        S = self._laws.of_element(element).stress(H)[0]
        F = kernel.deformation_gradient(H, self.m[own])[0]
        return np.asarray(F @ np.stack([S[:, [0, 2]], S[:, [2, 1]]], axis=-2))

    def mean_stress(self, gradient: Array, start: Array) -> Array:
        """Stress of a midpoint step that keeps the energy, shape (e, q, 3).

        Of St. Venant–Kirchhoff solids it is that of the mean of the strains at both ends.

        Parameters
        ----------
        gradient, start : ndarray, shape (e, q, 2, 2)
            In the middle of the step, and at its start.
        """
        return self._laws.mean_stress(gradient, start)

    def linearised_stress(self, gradient: Array, stress: Array, increment: Array, new: Array, used: Array) -> Array:
        """Stress after an increment without what is of higher order in it, shape (e, q, 3).

        Parameters
        ----------
        gradient, stress : ndarray
            Before the increment.
        increment : ndarray, shape (e, q, 2, 2)
            Of the gradient.
        new : ndarray, shape (e, q, 3)
            The stress after it.
        used : ndarray, shape (e, q, 3)
            That of the tangent which gave the increment.
        """
        return self._laws.linearised_stress(gradient, stress, increment, new, used)

    def internal_force(self, gradient: Array, stress: Array) -> Array:
        """Nodal internal forces, shape (n, 2)."""
        F = kernel.deformation_gradient(gradient, self.m)
        return self._assembled(kernel.internal_force(F, stress, self._dN, self._J_inv, self._weights))

    def strain_energy(self, displacement: Array) -> float:
        """Energy of the strain of a nodal displacement (n, 2)."""
        return float((self._weights * self._laws.energy(self.gradient(displacement))).sum())

    def lowest_volume_ratio(self, displacement: Array) -> float:
        """Smallest det F at quadrature points; 1 for linear solids."""
        F = kernel.deformation_gradient(self.gradient(displacement), self.m)
        return float(np.min(F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]))

    def rounding(self, displacement: Array, gradient: Array) -> float:
        """Size of the rounding error of the internal forces at a displacement and its gradient.

        Displacements are known to machine precision only; in a thin body the membrane forces of that error can exceed
        any tolerance relative to the loads.
        """
        steep, near = np.abs(self._dN), np.abs(self._J_inv)
        error = kernel.displacement_gradient(np.abs(displacement)[self._cells], steep, near).max(axis=(2, 3))
        size = self._laws.plane_modulus * error * (1.0 + self.m * np.abs(gradient).max(axis=(2, 3))) ** 2
        S = np.stack([size, size, np.zeros_like(size)], axis=-1)
        F = kernel.deformation_gradient(gradient, np.zeros_like(self.m))
        f = kernel.internal_force(F, S, steep, near, self._weights)
        return float(np.finfo(float).eps * np.linalg.norm(self._assembled(f)))

    def tangent(
        self, gradient: Array, stress: Array, mass_factor: float, pressures: Sequence[FollowerPressure]
    ) -> Array:
        """Element matrices of internal force + mass_factor · mass - pressures, shape (e, 2 i, 2 j).

        Parameters
        ----------
        gradient : ndarray, shape (e, q, 2, 2)
        stress : ndarray, shape (e, q, 3)
            Of the geometric stiffness, and of what depends on the pressure otherwise.
        mass_factor : float
        pressures : sequence of FollowerPressure
        """
        K = self._laws.stiffness(gradient, stress, self._products, self._J_inv, self._weights)
        if mass_factor:
            inertia = mass_factor * self._element_mass
            K[:, 0::2, 0::2] += inertia
            K[:, 1::2, 1::2] += inertia
        for pressure in pressures:
            pressure.subtract_stiffness(K, self._position)
        return K

    def element_masses(self) -> Array:
        """Element matrices of the mass alone, shape (e, 2 i, 2 j)."""
        e, i, _ = self._element_mass.shape
        M = np.zeros((e, 2 * i, 2 * i))
        M[:, 0::2, 0::2] = M[:, 1::2, 1::2] = self._element_mass
        return M

    def shared(self, force: Array) -> Array:
        """Nodal forces (n, 2) as element vectors (e, 2 i) that sum up to them."""
        return np.asarray((force.ravel() * self._share)[self.dofs])

    def applied(self, K: Array, displacement: Array) -> Array:
        """Nodal forces (n, 2) of element matrices times a nodal displacement (n, 2)."""
        f = (K @ displacement.ravel()[self.dofs][:, :, None])[:, :, 0]
        return assemble_vector(self.dofs, f, 2 * len(self.mesh.points)).reshape(-1, 2)

    def _assembled(self, f: Array) -> Array:
        e = len(f)
        return assemble_vector(self.dofs, f.reshape(e, -1), 2 * len(self.mesh.points)).reshape(-1, 2)


def _cells_of(mesh: QuadMesh, solids: Sequence[case.Solid]) -> list[Index]:
    cells = []
    owner = np.full(len(mesh.cells), -1)
    for k, solid in enumerate(solids):
        own = np.unique(np.concatenate([mesh.cell_groups[name] for name in solid.blocks]))
        taken = owner[own]
        if (taken >= 0).any():
            names = f"'{solids[int(taken.max())].name}' and '{solid.name}'"
            raise CaseError(
                f"solids {names} share {int((taken >= 0).sum())} elements; expected separate blocks. "
                "Remove a block group from one of them.",
                f"{solid.place}.blocks",
            )
        owner[own] = k
        cells.append(own)
    if (owner < 0).any():
        raise CaseError(
            f"{int((owner < 0).sum())} elements of the mesh belong to no solid; expected all. Name their "
            "block groups in a solid's blocks.",
            solids[0].place if solids else "solid",
        )
    return cells
