"""The discretised Navier–Stokes equations of one fluid: spaces, boundary, and matrices kept while they hold."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.reference import differentiation_matrix, gauss_legendre, gauss_lobatto, lagrange
from hofsi import case
from hofsi.counts import Counts
from hofsi.fem.assembly import assemble_vector
from hofsi.fem.condensation import CondensedSystem
from hofsi.fem.condensed_factor import CondensedFactor
from hofsi.fem.element import boundary_first
from hofsi.fem.element_matrices import TracedMatrices
from hofsi.fem.geometry import Geometry, element_geometry
from hofsi.fem.periodic import pair_sides
from hofsi.fem.saddle_point import SaddlePointSystem
from hofsi.fem.spaces import TaylorHood
from hofsi.kernels import navier_stokes as kernel
from hofsi.kernels import tensor_products
from hofsi.linear.checked import CheckedSolver
from hofsi.linear.solver import Solver
from hofsi.solvers.backflow import Backflow
from hofsi.solvers.convective_flux import ConvectiveFlux
from hofsi.solvers.enclosed import EnclosedRegions
from hofsi.solvers.fluid_boundary import FluidBoundary
from hofsi.solvers.fluid_factors import FactorsMemory, FluidFactors, Problem
from hofsi.solvers.fluid_matrices import ConstantTerms, MatrixOrigin
from hofsi.solvers.fluid_memory import FluidMemory
from hofsi.solvers.fluid_system import FluidSystem, SystemOrigin, factorised, fluid_system

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]

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
        self._geometry: tuple[Array, Geometry] | None = None
        self._constant: tuple[Array, float, ConstantTerms] | None = None
        self._row_sums: tuple[ConstantTerms, float, float] | None = None
        self._enclosed: tuple[Array, EnclosedRegions] | None = None
        self._stokes: tuple[ConstantTerms, FluidSystem, Solver] | None = None
        self._stokes_respond = False
        self._alike: Array = mesh.points

    @cached_property
    def flux(self) -> ConvectiveFlux:
        """What flows through the boundary, made for the form of convection that needs it."""
        return ConvectiveFlux(self.mesh, self.space)

    @property
    def convecting(self) -> bool:
        """Whether convection is part of the model."""
        return self.fluid.model == "navier-stokes"

    def geometry(self, points: Array) -> Geometry:
        """Geometry factors, kept while the mesh stands still."""
        if self._geometry is None or self._geometry[0] is not points:
            self._geometry = (points, self._new_geometry(points))
            self.counts.geometries += 1
        return self._geometry[1]

    def _new_geometry(self, points: Array) -> Geometry:
        cells, table = self.space.velocity_cells, self.space.velocity
        if self._geometry is None:
            return element_geometry(points[cells], table)
        moved = np.flatnonzero(~self._standing(self._geometry[0], points))
        if len(moved) == len(cells):
            return element_geometry(points[cells], table)
        return self._geometry[1].with_elements(moved, element_geometry(points[cells[moved]], table, moved))

    def _standing(self, before: Array, points: Array) -> Mask:
        """Elements (e,) all of whose nodes are where they were."""
        return np.asarray((before == points).all(axis=1)[self.space.velocity_cells].all(axis=1))

    def constant_terms(self, points: Array, rate: float) -> ConstantTerms:
        """Element matrices without convection, the same object while mesh and step size do not change."""
        if self._constant is None or self._constant[0] is not points or self._constant[1] != rate:
            fluid, sides = self.fluid, self.boundary.do_nothing(points)
            terms = ConstantTerms(
                self.space,
                self.products,
                self.geometry(points),
                fluid.viscosity,
                fluid.grad_div,
                rate * fluid.density,
                sides,
            )
            if self._constant is not None and self._constant[1] == rate:
                standing = self._standing(self._constant[0], points)
                terms.take_over(self._constant[2], standing)
                self.counts.elements_kept += int(standing.sum())
            self._constant = (points, rate, terms)
            self.counts.constant_assemblies += 1
        return self._constant[2]

    def row_sums(self, points: Array, rate: float) -> tuple[float, float]:
        """About the norms of the assembled sums of |A| over the rows, without convection, and of ∫ |v| |∇N| for it.

        Upper bounds but for the do-nothing condition; kept as long as the matrices.
        """
        terms = self.constant_terms(points, rate)
        if self._row_sums is None or self._row_sums[0] is not terms:
            space, fluid, geometry = self.space, self.fluid, self.geometry(points)
            N, P, dN = np.abs(space.velocity.N), np.abs(space.pressure.N), np.abs(space.velocity.dN)
            along = np.abs(geometry.J_inv).sum(axis=3)  # |∂_x N| + |∂_y N| is at most Σ_c |∂_c N| of these
            gradients = (along * dN.sum(axis=1)).sum(axis=2)
            stress = (2.0 * fluid.viscosity + fluid.grad_div) * gradients + P.sum(axis=1)
            rows = np.einsum("eqc,qnc->en", (geometry.weights * stress)[:, :, None] * along, dN)
            rows += rate * fluid.density * (geometry.weights * N.sum(axis=1)) @ N
            fixed = assemble_vector(space.velocity_unknowns, rows, len(points))
            sources = assemble_vector(space.pressure_unknowns, (geometry.weights * gradients) @ P, space.pressure_count)
            convected = (geometry.weights * gradients) @ N
            if fluid.skew_symmetric:
                tested = (geometry.weights * N.sum(axis=1))[:, :, None] * along
                convected = 0.5 * (convected + np.einsum("eqc,qnc->en", tested, dN))
            convecting = assemble_vector(space.velocity_unknowns, convected, len(points))
            size = float(np.hypot(np.sqrt(2.0) * np.linalg.norm(fixed), np.linalg.norm(sources)))
            self._row_sums = (terms, size, float(np.linalg.norm(convecting)))
        return self._row_sums[1:]

    def system(self, points: Array) -> FluidSystem:
        """Pattern of the linear systems under the constraints at these node positions."""
        constraints = self.boundary.constraints(points)
        if self._system is None or self._system_for is not constraints:
            pinned = self.enclosed(points).pinned
            self._system = fluid_system(
                self.space, constraints, pinned, self.linear, points, self.counts, self.boundary.interface
            )
            self._system_for = constraints
            assert self.boundary.constrained_at is not None
            self._system.origin = SystemOrigin(self.boundary.constrained_at, points)
        return self._system

    def responds(self, points: Array) -> bool:
        """Whether the factors of linear steps at these node positions tell how the interface answers."""
        system = self.system(points)
        return isinstance(system, CondensedSystem) and system.exact and bool(system.border.size)

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
            regions = EnclosedRegions(self.space, self.boundary.constraints(points), self.pressure_work(points))
            self._enclosed = points, regions
        return self._enclosed[1]

    def pressure_work(self, points: Array) -> Array:
        """What a unit pressure does to the velocity, ∫ ∂N/∂x over each element, shape (e, n, 2)."""
        geometry = self.geometry(points)
        unit = np.broadcast_to(np.eye(2)[:, :, None, None], (2, 2, *geometry.weights.shape))
        return kernel.stress_work(self.space.velocity.dN, geometry.J_inv, geometry.weights, unit)

    def stokes_factor(self, points: Array, rate: float, *, responding: bool = False) -> Solver:
        """Factors of the matrix without convection, kept as long as the matrix.

        With ``responding`` those that are made tell of the response to the interface, see `factorised`.
        """
        terms, system = self.constant_terms(points, rate), self.system(points)
        if self._stokes is None or self._stokes[0] is not terms or self._stokes[1] is not system:
            origin = MatrixOrigin(points, None, rate, 1.0, None, False)
            matrices = TracedMatrices(terms.ask().matrices, origin)
            self._stokes = (terms, system, factorised(system, matrices, responding=responding))
            self._stokes_respond = responding
            self.counts.factorised("mesh or step size")
        return self._stokes[2]

    def memory(self) -> FluidMemory:
        """What is kept between steps, so that `recall` can make it again."""
        system, constant = self._system, self._constant
        current = self._stokes is not None and constant is not None and self._stokes[0] is constant[2]
        return FluidMemory(
            counts=self.counts.copy(),
            enclosed=None if self._enclosed is None else self._enclosed[0],
            system=system.origin if system is not None and isinstance(system.origin, SystemOrigin) else None,
            geometry=None if self._geometry is None else self._geometry[0],
            constant=None if constant is None else constant[:2],
            stokes=self._fell_back() if current and self._stokes and self._stokes[1] is system else None,
            responding=self._stokes_respond,
            factors=self.factors.memory(),
            cycle=system.memory() if isinstance(system, SaddlePointSystem) else None,
        )

    def _fell_back(self) -> bool:
        """Whether the factors without convection are those of the fallback."""
        factor = _checked(self._stokes)
        return factor is not None and factor.fell_back

    def recall(self, memory: FluidMemory, matrices: Callable[[MatrixOrigin], TracedMatrices]) -> None:
        """Make again what was kept, of what it was made from.

        Parameters
        ----------
        memory : FluidMemory
        matrices : callable
            Makes element matrices as they were.
        """
        self._system = self._enclosed = self._geometry = self._constant = self._stokes = None
        self.factors.forget()
        if memory.enclosed is not None:
            self.boundary.constrain_anew(memory.enclosed)
            self.enclosed(memory.enclosed)
        factors, own = memory.factors, memory.system
        if factors is not None and not _same(factors.system, own):
            self._recall_factors(factors, factors.system, matrices)
        if own is not None:
            system = self._system_of(own)
            if factors is not None and _same(factors.system, own):
                self._recall_factors(factors, system, matrices)
            if isinstance(system, SaddlePointSystem) and memory.cycle is not None:
                assert isinstance(memory.cycle.origin, MatrixOrigin)
                system.recall(memory.cycle, matrices(memory.cycle.origin))
        if memory.geometry is not None:
            self.geometry(memory.geometry)
        if memory.constant is not None:
            self.constant_terms(*memory.constant)
            if memory.stokes is not None:
                self.stokes_factor(*memory.constant, responding=memory.responding)
                factor = _checked(self._stokes)
                if memory.stokes and factor is not None:
                    factor.fall_back()
        self.counts.recall(memory.counts)

    def _system_of(self, origin: SystemOrigin) -> FluidSystem:
        """Make a linear system again."""
        self.boundary.constrain_anew(origin.constraints)
        self._system = None
        return self.system(origin.places)

    def _recall_factors(
        self,
        memory: FactorsMemory,
        system: object,
        matrices: Callable[[MatrixOrigin], TracedMatrices],
    ) -> None:
        """Make factors again, for a system or the origin of one that is not at hand any more."""
        system = self._system_of(system) if isinstance(system, SystemOrigin) else system
        if not isinstance(system, CondensedSystem) or not system.exact:
            return  # on another machine "auto" may choose another solver
        origin = memory.origin
        assert isinstance(origin, MatrixOrigin)
        assert origin.velocity is not None
        problem = Problem(origin.points, origin.rate, origin.share)
        self.factors.recall(memory, system, problem, matrices(origin), origin.velocity)


def _same(one: object, other: SystemOrigin | None) -> bool:
    """Whether two linear systems were made from the same."""
    if not isinstance(one, SystemOrigin) or other is None:
        return False
    return one.constraints is other.constraints and one.places is other.places


def _checked(kept: tuple[ConstantTerms, FluidSystem, Solver] | None) -> CheckedSolver | None:
    """The factors of a direct solver."""
    if kept is None or not isinstance(kept[2], CondensedFactor):
        return None
    return kept[2].factor if isinstance(kept[2].factor, CheckedSolver) else None


def _velocity_products(space: TaylorHood) -> tensor_products.ProductTables:
    """Tables for integrals of products of the velocity's basis, at the element's quadrature points."""
    p = space.order
    nodes, (points, _) = gauss_lobatto(p), gauss_legendre(round(len(space.velocity.weights) ** 0.5))
    values = lagrange(nodes, points)
    return tensor_products.product_tables(values, values @ differentiation_matrix(nodes), boundary_first(p)[0])
