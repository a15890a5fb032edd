"""The incompressible Navier–Stokes equations on a moving mesh: one step, or the steady state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hofsi import case
from hofsi.counts import Counts
from hofsi.errors import LinearSolverError, NewtonError
from hofsi.fem.assembly import assemble_vector
from hofsi.fem.geometry import Geometry, element_geometry, physical_gradients
from hofsi.fem.spaces import TaylorHood
from hofsi.kernels import navier_stokes as kernel
from hofsi.linear.solver import Solver
from hofsi.solvers.continuation import approach
from hofsi.solvers.enclosed import EnclosedRegions
from hofsi.solvers.fluid_boundary import FluidBoundary
from hofsi.solvers.fluid_system import FluidSystem, fluid_system
from hofsi.timestepping.schemes import bdf_weights, extrapolation_weights

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["FluidSolver", "FluidState", "FluidStep"]

_ON_THE_WAY = 1e-6  # tolerance of the problems that continuation solves on the way
_ROUNDING = 1e-14  # of |A| |u|: a residual below that is rounding; nothing else is left of a flow without stress
_FEW = 12  # Newton iterations that each of them may take: from a good start that is enough


@dataclass(frozen=True)
class FluidState:
    """Fluid at the end of a step.

    Attributes
    ----------
    velocities : tuple of ndarray, shape (n, 2)
        Newest first; as many as the time scheme needs.
    pressure : ndarray, shape (m,)
    points : tuple of ndarray, shape (n, 2)
        Node positions at the same times.
    reaction : ndarray, shape (n, 2)
        Nodal momentum residual: what the boundary does to the fluid where it holds it; minus it is the load on a body.
    time : float
    """

    velocities: tuple[Array, ...]
    pressure: Array
    points: tuple[Array, ...]
    reaction: Array
    time: float

    @property
    def velocity(self) -> Array:
        """Newest velocity."""
        return self.velocities[0]


class FluidSolver:
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
        self.space = TaylorHood.on(mesh)
        self.boundary = FluidBoundary(mesh, self.space, fluid.boundaries, interface, fluid.viscosity, driven)
        self.counts = Counts()
        self._system: FluidSystem | None = None
        self._system_for: object = None
        self._geometry: tuple[Array, Geometry, Array, Array] | None = None
        self._constant: tuple[Array, float, Array] | None = None
        self._enclosed: EnclosedRegions | None = None
        self._stokes: tuple[Array, FluidSystem, Solver] | None = None

    @property
    def convecting(self) -> bool:
        """Whether convection is part of the model."""
        return self.fluid.model == "navier-stokes"

    def initial_state(self, time: float = 0.0, points: Array | None = None) -> FluidState:
        """State from the initial velocity of the case, or at rest, on the reference mesh or the given points."""
        points = self.mesh.points if points is None else points
        velocity = np.zeros(points.shape)
        if self.fluid.initial_velocity is not None:
            for a, expression in enumerate(self.fluid.initial_velocity):
                velocity[:, a] = expression.evaluate(x=points[:, 0], y=points[:, 1])
        return FluidState((velocity,), np.zeros(self.space.pressure_count), (points,), np.zeros(points.shape), time)

    def begin_step(
        self, state: FluidState, points: Array, steps: Sequence[float], time: float, *, linear: bool
    ) -> FluidStep:
        """Start a time step that ends at ``time`` on a mesh with node positions ``points``.

        Parameters
        ----------
        state : FluidState
        points : ndarray, shape (n, 2)
            The same array as before if the mesh stands still.
        steps : sequence of float
            This step's size and those before it, newest first.
        time : float
            At the end of the step.
        linear : bool
            Extrapolate the convecting velocity (second order) so that the step is linear.
        """
        order = min(2, len(state.velocities), len(steps))
        c = bdf_weights(steps[:order])
        history = np.tensordot(c[1:], np.stack(state.velocities[:order]), axes=1)
        mesh_velocity = np.zeros(points.shape)
        if any(points is not old for old in state.points):
            moving = [points, *state.points][: order + 1]
            mesh_velocity = np.tensordot(c, np.stack(moving), axes=1)
        advective = None
        if linear and self.convecting:
            e = extrapolation_weights(steps, order - 1)
            advective = np.tensordot(e, np.stack(state.velocities[:order]), axes=1) - mesh_velocity
            self.boundary.stick(advective, points, mesh_velocity)
        return FluidStep(self, state, points, mesh_velocity, float(c[0]), history, time, advective, order)

    def begin_steady(self, state: FluidState, points: Array) -> FluidStep:
        """Start a search for the steady state on a mesh at rest."""
        zero = np.zeros(points.shape)
        return FluidStep(self, state, points, zero, 0.0, zero, state.time, None, 0)

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
            if rate:
                mass = kernel.transport(space.velocity.N, dNx, dNy, geometry.weights, rate, self.fluid.density, None)
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

    def system(self, points: Array) -> FluidSystem:
        """Pattern of the linear systems under the constraints at these node positions."""
        constraints = self.boundary.constraints(points)
        if self._system is None or self._system_for is not constraints:
            pinned = self.enclosed(points).pinned
            self._system = fluid_system(self.space, constraints, pinned, self.linear, self.geometry(points)[0].weights)
            self._system_for = constraints
        return self._system

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
            self.counts.factorisations += 1
        return self._stokes[2]


class FluidStep:
    """One step, or the steady problem, on one mesh; made by `FluidSolver`.

    A linear step is assembled and factorised once, however often it is solved. A steady problem that Newton's method
    does not solve from where it starts is approached from Stokes flow, with more and more of the convection.

    Attributes
    ----------
    linear : bool
    converged : bool
        Whether the last solution satisfies the case's tolerance.
    """

    def __init__(
        self,
        solver: FluidSolver,
        state: FluidState,
        points: Array,
        mesh_velocity: Array,
        rate: float,
        history: Array,
        time: float,
        advective: Array | None,
        order: int,
    ) -> None:
        self.solver, self.state, self.points, self.time = solver, state, points, time
        self.mesh_velocity = mesh_velocity
        self._rate, self._advective, self._order = rate, advective, order
        self.linear = advective is not None or not solver.convecting
        self.converged = False
        self._share = 1.0  # of the convection
        self._load = self._external(history)
        self._matrix: Array | None = None
        self._factor: Solver | None = None
        self._unknowns = np.concatenate([state.velocity.ravel(), state.pressure])
        self._residual: Array | None = None

    def continue_from(self, other: FluidStep) -> None:
        """Start the solution from that of another step, for example on the mesh of the last coupling iteration."""
        self._unknowns = other._unknowns

    def _external(self, history: Array) -> Array:
        """Element load vectors of inertia, body force and given tractions."""
        solver, space = self.solver, self.solver.space
        geometry, _, _ = solver.geometry(self.points)
        force = solver.fluid.body_force
        f = np.zeros(space.dofs.shape)
        if self._rate or force is not None:
            density = np.zeros((*geometry.weights.shape, 2))
            if self._rate:
                density -= solver.fluid.density * (space.velocity.N @ history[space.velocity_cells])
            if force is not None:
                x, y = geometry.x[..., 0], geometry.x[..., 1]
                for a in range(2):
                    density[..., a] += force[a].evaluate(x=x, y=y, t=self.time)
            f = space.local_vector(kernel.load(space.velocity.N, geometry.weights, density))
        solver.boundary.add_loads(f, self.points, self.time)
        return f

    def _convection(self, A: Array, advective: Array) -> None:
        """Add ∫ ρ (a·∇u)·v for a nodal advective velocity (n, 2)."""
        space = self.solver.space
        geometry, dNx, dNy = self.solver.geometry(self.points)
        a = space.velocity.N @ advective[space.velocity_cells]
        density = self._share * self.solver.fluid.density
        block = kernel.transport(space.velocity.N, dNx, dNy, geometry.weights, 0.0, density, a)
        space.add(A, 0, 0, block)
        space.add(A, 1, 1, block)

    def _reaction(self, A: Array, velocity: Array) -> None:
        """Add Newton's term ∫ ρ (δu·∇u)·v."""
        space = self.solver.space
        geometry, dNx, dNy = self.solver.geometry(self.points)
        gradient = kernel.velocity_gradient(dNx, dNy, velocity[space.velocity_cells])
        density = self._share * self.solver.fluid.density
        blocks = kernel.reaction(space.velocity.N, geometry.weights, density, gradient)
        for (a, b), block in zip(((0, 0), (0, 1), (1, 0), (1, 1)), blocks, strict=True):
            space.add(A, a, b, block)

    def solve(self, interface: Array, *, max_iterations: int | None = None) -> tuple[Array, Array]:
        """Solve the step for a velocity of the interface nodes.

        Parameters
        ----------
        interface : ndarray, shape (k, 2)
            In the order of the solver's ``interface``.
        max_iterations : int, optional
            Newton iterations to make at most; stopping there is not an error, see ``converged``.

        Returns
        -------
        velocity : ndarray, shape (n, 2)
        pressure : ndarray, shape (m,)

        Raises
        ------
        NewtonError
            If Newton's method does not converge within the case's limit; if the problem is steady, not in steps either.
        """
        self.converged = False
        n = 2 * self.solver.space.velocity_count
        start = self._unknowns[:n].reshape(-1, 2)
        velocity = self.solver.boundary.impose(start, self.points, self.mesh_velocity, interface, self.time)
        unknowns = np.concatenate([velocity.ravel(), self._unknowns[n:]])
        enclosed = self.solver.enclosed(self.points)
        if enclosed:
            geometry, flux = self.solver.geometry(self.points)[0], self.solver.pressure_work(self.points)
            enclosed.balance(self._load, velocity, geometry, flux, moving=bool(self.mesh_velocity.any()))
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is found below
            unknowns = self._solve_linear(unknowns) if self.linear else self._solve_nonlinear(unknowns, max_iterations)
        if enclosed and self._residual is not None:
            enclosed.remove_mean(unknowns[n:], self._residual, geometry, flux)
        self._unknowns = unknowns
        return unknowns[:n].reshape(-1, 2), unknowns[n:]

    def _solve_linear(self, unknowns: Array) -> Array:
        solver = self.solver
        if self._factor is None or self._matrix is None:
            self._matrix = solver.constant_matrices(self.points, self._rate)
            if self._advective is None:
                self._factor = solver.stokes_factor(self.points, self._rate)
            else:
                self._matrix = self._matrix.copy()
                self._convection(self._matrix, self._advective)
                solver.counts.assemblies += 1
                self._factor = solver.system(self.points).factorise(self._matrix)
                solver.counts.factorisations += 1
        unknowns = unknowns + self._factor.solve(self._imbalance(self._matrix, unknowns))
        solver.counts.solves += 1
        self._residual = self._imbalance(self._matrix, unknowns)
        self.converged = True
        return unknowns

    def _solve_nonlinear(self, unknowns: Array, max_iterations: int | None) -> Array:
        """Newton's method, and continuation if it fails on a steady problem."""
        settings = self.solver.nonlinear
        if max_iterations is not None:
            return self._solve_newton(unknowns, max_iterations, settings.tolerance, stop=True)
        try:
            return self._solve_newton(unknowns, settings.max_iterations, settings.tolerance)
        except (NewtonError, LinearSolverError) as error:
            if self._rate:
                raise
            failure = error
        try:
            return approach(self._with_share, unknowns, failure, "of the convection")
        finally:
            self._share = 1.0

    def _with_share(self, unknowns: Array, share: float) -> Array:
        """Solve with a share of the convection, roughly if it is not all."""
        solver, settings = self.solver, self.solver.nonlinear
        self._share = share
        solver.counts.continuation_steps += 1
        if share == 1.0:
            return self._solve_newton(unknowns, settings.max_iterations, settings.tolerance)
        newton = solver.fluid.convection != "picard"
        limit = min(_FEW, settings.max_iterations) if newton else settings.max_iterations
        rough = self._solve_newton(unknowns, limit, max(_ON_THE_WAY, settings.tolerance))
        self.converged = False
        return rough

    def _solve_newton(self, unknowns: Array, limit: int, tolerance: float, *, stop: bool = False) -> Array:
        """At most some iterations; with ``stop``, ending there is not an error."""
        solver = self.solver
        picard = solver.fluid.convection == "picard"
        A, norm, scale = self._linearise(unknowns)
        for iteration in range(limit + 1):
            if norm <= tolerance * scale or norm <= _ROUNDING * self._magnitude(A, unknowns):
                self.converged = True
                return unknowns
            if not np.isfinite(norm):
                raise NewtonError(
                    f"the residual is not finite after {iteration} iterations. Lower the time step or the Reynolds "
                    "number, or check the given velocities.",
                    "diverged",
                    f"fluid, t = {self.time:g}",
                )
            if iteration == limit:
                break
            J = A.copy()
            if not picard:
                self._reaction(J, unknowns[: 2 * solver.space.velocity_count].reshape(-1, 2))
            factor = solver.system(self.points).factorise(J)
            delta = factor.solve(self._imbalance(A, unknowns))
            solver.counts.factorisations += 1
            solver.counts.solves += 1
            solver.counts.iterations += 1
            unknowns, A, norm, scale = self._damped(unknowns, delta, norm)
        if not stop:
            raise NewtonError(
                f"Newton's method stopped at a relative residual of {norm / scale:.2g} after {limit} iterations; "
                f"expected below {tolerance:g}. Refine the mesh, lower the Reynolds number, march in time, or "
                'use convection = "picard".',
                "max_iterations",
                f"fluid, t = {self.time:g}",
            )
        return unknowns

    def _damped(self, unknowns: Array, delta: Array, norm: float) -> tuple[Array, Array, float, float]:
        """Full step, halved up to four times while the residual grows by more than a factor of ten."""
        factor = 1.0
        for _ in range(5):
            trial = unknowns + factor * delta
            A, new, scale = self._linearise(trial)
            if np.isfinite(new) and new <= 10.0 * norm:
                break
            factor *= 0.5
        return trial, A, new, scale

    def _linearise(self, unknowns: Array) -> tuple[Array, float, float]:
        """Oseen matrices at a state, the norm of its residual and a scale to compare it with."""
        solver = self.solver
        velocity = unknowns[: 2 * solver.space.velocity_count].reshape(-1, 2)
        A = solver.constant_matrices(self.points, self._rate).copy()
        self._convection(A, velocity - self.mesh_velocity)
        solver.counts.assemblies += 1
        self._residual = self._imbalance(A, unknowns)
        system = solver.system(self.points)
        dofs, size = solver.space.dofs, solver.space.size
        free = self._free_rows(system)
        inner = np.abs(self._residual - self._load)
        scale = assemble_vector(dofs, inner + np.abs(self._load), size)
        residual = self._in_frames(assemble_vector(dofs, self._residual, size))
        return A, float(np.linalg.norm(residual[free])), float(np.linalg.norm(scale)) or 1.0

    def _magnitude(self, A: Array, unknowns: Array) -> float:
        """Norm of |A| |u|: unlike the scale it does not vanish if the terms of every row cancel."""
        space = self.solver.space
        local = np.abs(unknowns)[space.dofs]
        rows = (np.abs(A) @ local[:, :, None])[:, :, 0]
        return float(np.linalg.norm(assemble_vector(space.dofs, rows, space.size)))

    def _free_rows(self, system: FluidSystem) -> Index:
        inner = system.dofs[:, system.boundary :].ravel()
        return np.concatenate([system.unknowns, inner])

    def _in_frames(self, vector: Array) -> Array:
        """A global vector with the velocity part in the nodes' own frames."""
        constraints = self.solver.boundary.constraints(self.points)
        if constraints.rotated.size:
            n = 2 * self.solver.space.velocity_count
            pairs = vector[:n].reshape(-1, 2)
            frames = constraints.frames[constraints.rotated]
            pairs[constraints.rotated] = (frames.transpose(0, 2, 1) @ pairs[constraints.rotated][:, :, None])[:, :, 0]
        return vector

    def _imbalance(self, A: Array, unknowns: Array) -> Array:
        """Element residuals f - A u, shape (e, k)."""
        local = unknowns[self.solver.space.dofs]
        return np.asarray(self._load - (A @ local[:, :, None])[:, :, 0])

    def reaction(self) -> Array:
        """Nodal momentum residual of the last solution, shape (n, 2): the force of the boundary on the fluid."""
        space = self.solver.space
        if self._residual is None:
            raise ValueError("reaction: the step has not been solved yet.")
        return -assemble_vector(space.dofs, self._residual, space.size)[: 2 * space.velocity_count].reshape(-1, 2)

    def accept(self) -> FluidState:
        """Return the state at the end of the step."""
        n = 2 * self.solver.space.velocity_count
        velocity, pressure = self._unknowns[:n].reshape(-1, 2), self._unknowns[n:]
        keep = 1 if self._order else 0
        return FluidState(
            (velocity, *self.state.velocities[:keep]),
            pressure,
            (self.points, *self.state.points[:keep]),
            self.reaction(),
            self.time,
        )
