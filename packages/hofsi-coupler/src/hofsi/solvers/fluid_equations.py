"""The discretised Navier–Stokes equations of one fluid: spaces, boundary, and matrices kept while they hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.reference import differentiation_matrix, gauss_legendre, gauss_lobatto, lagrange
from hofsi import case
from hofsi.counts import Counts
from hofsi.fem.assembly import assemble_vector
from hofsi.fem.element import boundary_first
from hofsi.fem.geometry import Geometry, element_geometry, physical_gradients
from hofsi.fem.periodic import pair_sides
from hofsi.fem.spaces import TaylorHood
from hofsi.kernels import navier_stokes as kernel
from hofsi.kernels import tensor_products
from hofsi.linear.solver import Solver
from hofsi.solvers.backflow import Backflow
from hofsi.solvers.enclosed import EnclosedRegions
from hofsi.solvers.fluid_boundary import FluidBoundary
from hofsi.solvers.fluid_factors import FluidFactors
from hofsi.solvers.fluid_system import FluidSystem, fluid_system

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["FluidEquations"]


class FluidEquations:
    """Taylor–Hood discretisation of one fluid.

    Parameters
    ----------
    mesh : QuadMesh
        The fluid's blocks only.
    fluid : case.Fluid
    nonlinear : NonlinearSettings
    linear : LinearSettings
    interface : ndarray
        Nodes whose velocity a solid prescribes.
    driven : ndarray, optional
        Nodes of all edges that move by themselves, the interface included: no-slip walls elsewhere do not follow nodes
        that slide along them. By default all walls move with their nodes.
    """

    def __init__(
        self,
        mesh: QuadMesh,
        fluid: case.Fluid,
        nonlinear: case.NonlinearSettings,
        linear: case.LinearSettings,
        interface: Index,
        driven: Index | None = None,
    ) -> None:
        self.mesh, self.fluid, self.nonlinear, self.linear = mesh, fluid, nonlinear, linear
        self.periodic = tuple(
            pair_sides(mesh, condition.first, condition.second, condition.place)
            for condition in fluid.boundaries
            if isinstance(condition, case.Periodic)
        )
        self.space = TaylorHood.on(mesh, self.periodic)
        self.products = _velocity_products(self.space)
        self.boundary = FluidBoundary(mesh, self.space, fluid.boundaries, interface, fluid.viscosity, driven)
        self.backflow = Backflow(mesh, self.space, fluid.boundaries, fluid.density)
        self.counts = Counts()
        self.factors = FluidFactors(self.counts, linear.lag)
        self._system: FluidSystem | None = None
        self._system_for: object = None
        self._geometry: tuple[Array, Geometry, Array, Array] | None = None
        self._constant: tuple[Array, float, Array] | None = None
        self._row_sums: tuple[Array, float, float] | None = None
        self._enclosed: EnclosedRegions | None = None
        self._stokes: tuple[Array, FluidSystem, Solver] | None = None
        self._alike: Array = mesh.points

    @property
    def convecting(self) -> bool:
        """Whether convection is part of the model."""
        return self.fluid.model == "navier-stokes"

    def geometry(self, points: Array) -> tuple[Geometry, Array, Array]:
        """Geometry factors and physical gradients, kept while the mesh stands still."""
        if self._geometry is None or self._geometry[0] is not points:
            geometry = element_geometry(points[self.space.velocity_cells], self.space.velocity)
            self._geometry = (points, geometry, *physical_gradients(geometry, self.space.velocity))
            self.counts.geometries += 1
        return self._geometry[1:]

    def constant_matrices(self, points: Array, rate: float) -> Array:
        """Element matrices without convection, kept while mesh and step size do not change."""
        if self._constant is None or self._constant[0] is not points or self._constant[1] != rate:
            space = self.space
            geometry, dNx, dNy = self.geometry(points)
            k = space.dofs.shape[1]
            A = np.zeros((len(space.dofs), k, k))
            xx, xy, yx, yy = kernel.viscous(dNx, dNy, geometry.weights, self.fluid.viscosity)
            if self.fluid.grad_div:
                more = kernel.grad_div(dNx, dNy, geometry.weights, self.fluid.grad_div)
                xx, xy, yx, yy = (a + b for a, b in zip((xx, xy, yx, yy), more, strict=True))
            if rate:
                mass = tensor_products.mass(self.products, rate * self.fluid.density * geometry.weights)
                xx, yy = xx + mass, yy + mass
            for a, b, block in ((0, 0, xx), (0, 1, xy), (1, 0, yx), (1, 1, yy)):
                space.put(A, a, b, block)
            for a, block in enumerate(kernel.divergence(space.pressure.N, dNx, dNy, geometry.weights)):
                space.put(A, 2, a, block)
                space.put(A, a, 2, block.transpose(0, 2, 1))
            self.boundary.add_do_nothing(A, points)
            self._constant = (points, rate, A)
            self.counts.constant_assemblies += 1
        return self._constant[2]

    def row_sums(self, points: Array, rate: float) -> tuple[float, float]:
        """Bounds of the norms of the assembled sums of |A| over the rows, without convection, and of ∫ |v| |∇N| for it.

        Kept as long as the matrices.
        """
        A = self.constant_matrices(points, rate)
        if self._row_sums is None or self._row_sums[0] is not A:
            space = self.space
            geometry, dNx, dNy = self.geometry(points)
            rows = np.sqrt(A.shape[2] * np.einsum("eij,eij->ei", A, A))
            fixed = assemble_vector(space.dofs, rows, space.size)
            gradients = geometry.weights * (np.abs(dNx) + np.abs(dNy)).sum(axis=2)
            convecting = assemble_vector(space.velocity_unknowns, gradients @ np.abs(space.velocity.N), len(points))
            self._row_sums = (A, float(np.linalg.norm(fixed)), float(np.linalg.norm(convecting)))
        return self._row_sums[1:]

    def system(self, points: Array) -> FluidSystem:
        """Pattern of the linear systems under the constraints at these node positions."""
        constraints = self.boundary.constraints(points)
        if self._system is None or self._system_for is not constraints:
            pinned = self.enclosed(points).pinned
            self._system = fluid_system(self.space, constraints, pinned, self.linear, points, self.counts)
            self._system_for = constraints
        return self._system

    def check_periodic(self, points: Array, time: float) -> None:
        """Check that periodic sides have moved alike, if the mesh has moved.

        Raises
        ------
        MeshMotionError
            Naming the condition.
        """
        if self.periodic and points is not self._alike:
            for sides in self.periodic:
                sides.check(points, time)
            self._alike = points

    def enclosed(self, points: Array) -> EnclosedRegions:
        """Regions whose pressure has no level; found once, for motion does not open a region."""
        if self._enclosed is None:
            self._enclosed = EnclosedRegions(self.space, self.boundary.constraints(points), self.pressure_work(points))
        return self._enclosed

    def pressure_work(self, points: Array) -> Array:
        """What a unit pressure does to the velocity, ∫ ∂N/∂x over each element, shape (e, n, 2)."""
        return EnclosedRegions.pressure_work(*self.geometry(points))

    def stokes_factor(self, points: Array, rate: float) -> Solver:
        """Factors of the matrix without convection, kept as long as the matrix."""
        A, system = self.constant_matrices(points, rate), self.system(points)
        if self._stokes is None or self._stokes[0] is not A or self._stokes[1] is not system:
            self._stokes = (A, system, system.factorise(A))
            self.counts.factorised("mesh or step size")
        return self._stokes[2]


def _velocity_products(space: TaylorHood) -> tensor_products.ProductTables:
    """Tables for integrals of products of the velocity's basis, at the element's quadrature points."""
    p = space.order
    nodes, (points, _) = gauss_lobatto(p), gauss_legendre(round(len(space.velocity.weights) ** 0.5))
    values = lagrange(nodes, points)
    return tensor_products.product_tables(values, values @ differentiation_matrix(nodes), boundary_first(p)[0])
