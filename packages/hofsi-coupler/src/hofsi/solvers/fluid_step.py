"""One step of a fluid, or its steady state, on one mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.errors import LinearSolverError, NewtonError
from hofsi.fem.assembly import assemble_vector
from hofsi.kernels import navier_stokes as kernel
from hofsi.linear.solver import Solver
from hofsi.solvers.continuation import approach
from hofsi.solvers.fluid_equations import FluidEquations
from hofsi.solvers.fluid_system import FluidSystem

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["FluidState", "FluidStep"]

_ON_THE_WAY = 1e-6  # tolerance of the problems that continuation solves on the way
_ROUNDING = 1e-14  # of |A| |u|: a residual below that is rounding; nothing else is left of a flow without stress
_CORRECTION = 1e-4  # residual that an iterative solution of Newton's equations may leave: the next step takes it away
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


class FluidStep:
    """One step, or the steady problem, on one mesh; made by `FluidSolver`.

    A linear step is Newton's linearisation about the velocity that the last steps let expect, which is of second order
    in the step size: with δ the error of that velocity it leaves out ρ δ·∇δ, of fourth order. (Merely to convect with
    the expected velocity leaves out ρ δ·∇u, of second order, which feeds energy into fast oscillations.) It is
    assembled and factorised once, however often it is solved. A steady problem that Newton's method does not solve
    from where it starts is approached from Stokes flow, with more and more of the convection.

    Attributes
    ----------
    linear : bool
    converged : bool
        Whether the last solution satisfies the case's tolerance.
    """

    def __init__(
        self,
        equations: FluidEquations,
        state: FluidState,
        points: Array,
        mesh_velocity: Array,
        rate: float,
        history: Array,
        time: float,
        expected: Array,
        order: int,
        *,
        linear: bool,
        newton: bool,
    ) -> None:
        self._equations, self.state, self.points, self.time = equations, state, points, time
        self.mesh_velocity = mesh_velocity
        self._rate, self._expected, self._order = rate, expected, order
        self.linear, self._newton = linear or not equations.convecting, newton
        self.converged = False
        self._share = 1.0  # of the convection
        self._load = self._external(history)
        self._matrix: Array | None = None
        self._factor: Solver | None = None
        self._unknowns = np.concatenate([expected.ravel(), state.pressure])
        self._residual: Array | None = None

    def continue_from(self, other: FluidStep) -> None:
        """Start the solution from that of another step, for example on the mesh of the last coupling iteration."""
        self._unknowns = other._unknowns

    def _external(self, history: Array) -> Array:
        """Element load vectors of inertia, body force and given tractions."""
        equations, space = self._equations, self._equations.space
        geometry, _, _ = equations.geometry(self.points)
        force = equations.fluid.body_force
        f = np.zeros(space.dofs.shape)
        if self._rate or force is not None:
            density = np.zeros((*geometry.weights.shape, 2))
            if self._rate:
                density -= equations.fluid.density * (space.velocity.N @ history[space.velocity_cells])
            if force is not None:
                x, y = geometry.x[..., 0], geometry.x[..., 1]
                for a in range(2):
                    density[..., a] += force[a].evaluate(x=x, y=y, t=self.time)
            f = space.local_vector(kernel.load(space.velocity.N, geometry.weights, density))
        equations.boundary.add_loads(f, self.points, self.time)
        return f

    def _convection(self, A: Array, advective: Array) -> None:
        """Add ∫ ρ (a·∇u)·v for a nodal advective velocity (n, 2)."""
        space = self._equations.space
        geometry, dNx, dNy = self._equations.geometry(self.points)
        a = space.velocity.N @ advective[space.velocity_cells]
        density = self._share * self._equations.fluid.density
        block = kernel.transport(space.velocity.N, dNx, dNy, geometry.weights, 0.0, density, a)
        space.add(A, 0, 0, block)
        space.add(A, 1, 1, block)

    def _reaction(self, A: Array, velocity: Array) -> None:
        """Add Newton's term ∫ ρ (δu·∇u)·v."""
        space = self._equations.space
        geometry, dNx, dNy = self._equations.geometry(self.points)
        gradient = kernel.velocity_gradient(dNx, dNy, velocity[space.velocity_cells])
        density = self._share * self._equations.fluid.density
        blocks = kernel.reaction(space.velocity.N, geometry.weights, density, gradient)
        for (a, b), block in zip(((0, 0), (0, 1), (1, 0), (1, 1)), blocks, strict=True):
            space.add(A, a, b, block)

    def _self_convection(self, velocity: Array) -> Array:
        """Element load vectors of ∫ ρ (u·∇u)·v for a nodal velocity."""
        equations, space = self._equations, self._equations.space
        geometry, dNx, dNy = equations.geometry(self.points)
        local = velocity[space.velocity_cells]
        u, gradient = space.velocity.N @ local, kernel.velocity_gradient(dNx, dNy, local)
        density = equations.fluid.density * (gradient @ u[..., None])[..., 0]
        return space.local_vector(kernel.load(space.velocity.N, geometry.weights, density))

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
        n = 2 * self._equations.space.velocity_count
        start = self._unknowns[:n].reshape(-1, 2)
        velocity = self._equations.boundary.impose(start, self.points, self.mesh_velocity, interface, self.time)
        unknowns = np.concatenate([velocity.ravel(), self._unknowns[n:]])
        enclosed = self._equations.enclosed(self.points)
        if enclosed:
            geometry, flux = self._equations.geometry(self.points)[0], self._equations.pressure_work(self.points)
            enclosed.balance(self._load, velocity, geometry, flux, moving=bool(self.mesh_velocity.any()))
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is found below
            unknowns = self._solve_linear(unknowns) if self.linear else self._solve_nonlinear(unknowns, max_iterations)
        if enclosed and self._residual is not None:
            enclosed.remove_mean(unknowns[n:], self._residual, geometry, flux)
        self._unknowns = unknowns
        return unknowns[:n].reshape(-1, 2), unknowns[n:]

    def _solve_linear(self, unknowns: Array) -> Array:
        equations = self._equations
        if self._factor is None or self._matrix is None:
            self._matrix = equations.constant_matrices(self.points, self._rate)
            if not equations.convecting:
                self._factor = equations.stokes_factor(self.points, self._rate)
            else:
                self._matrix = self._matrix.copy()
                self._convection(self._matrix, self._expected - self.mesh_velocity)
                if self._newton:
                    self._reaction(self._matrix, self._expected)
                    self._load = self._load + self._self_convection(self._expected)
                equations.counts.assemblies += 1
                self._factor = equations.system(self.points).factorise(self._matrix)
                equations.counts.factorisations += 1
        unknowns = unknowns + self._factor.solve(self._imbalance(self._matrix, unknowns))
        equations.counts.solves += 1
        self._residual = self._imbalance(self._matrix, unknowns)
        self.converged = True
        return unknowns

    def _solve_nonlinear(self, unknowns: Array, max_iterations: int | None) -> Array:
        """Newton's method, and continuation if it fails on a steady problem."""
        settings = self._equations.nonlinear
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
        equations, settings = self._equations, self._equations.nonlinear
        self._share = share
        equations.counts.continuation_steps += 1
        if share == 1.0:
            return self._solve_newton(unknowns, settings.max_iterations, settings.tolerance)
        newton = equations.fluid.convection != "picard"
        limit = min(_FEW, settings.max_iterations) if newton else settings.max_iterations
        rough = self._solve_newton(unknowns, limit, max(_ON_THE_WAY, settings.tolerance))
        self.converged = False
        return rough

    def _solve_newton(self, unknowns: Array, limit: int, tolerance: float, *, stop: bool = False) -> Array:
        """At most some iterations; with ``stop``, ending there is not an error."""
        equations = self._equations
        picard = equations.fluid.convection == "picard"
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
                self._reaction(J, unknowns[: 2 * equations.space.velocity_count].reshape(-1, 2))
            factor = equations.system(self.points).factorise(J, tolerance=_CORRECTION)
            delta = factor.solve(self._imbalance(A, unknowns))
            equations.counts.factorisations += 1
            equations.counts.solves += 1
            equations.counts.iterations += 1
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
        equations = self._equations
        velocity = unknowns[: 2 * equations.space.velocity_count].reshape(-1, 2)
        A = equations.constant_matrices(self.points, self._rate).copy()
        self._convection(A, velocity - self.mesh_velocity)
        equations.counts.assemblies += 1
        self._residual = self._imbalance(A, unknowns)
        system = equations.system(self.points)
        dofs, size = equations.space.dofs, equations.space.size
        free = self._free_rows(system)
        inner = np.abs(self._residual - self._load)
        scale = assemble_vector(dofs, inner + np.abs(self._load), size)
        residual = self._in_frames(assemble_vector(dofs, self._residual, size))
        return A, float(np.linalg.norm(residual[free])), float(np.linalg.norm(scale)) or 1.0

    def _magnitude(self, A: Array, unknowns: Array) -> float:
        """Norm of |A| |u|: unlike the scale it does not vanish if the terms of every row cancel."""
        space = self._equations.space
        local = np.abs(unknowns)[space.dofs]
        rows = (np.abs(A) @ local[:, :, None])[:, :, 0]
        return float(np.linalg.norm(assemble_vector(space.dofs, rows, space.size)))

    def _free_rows(self, system: FluidSystem) -> Index:
        inner = system.dofs[:, system.boundary :].ravel()
        return np.concatenate([system.unknowns, inner])

    def _in_frames(self, vector: Array) -> Array:
        """A global vector with the velocity part in the nodes' own frames."""
        constraints = self._equations.boundary.constraints(self.points)
        if constraints.rotated.size:
            n = 2 * self._equations.space.velocity_count
            pairs = vector[:n].reshape(-1, 2)
            frames = constraints.frames[constraints.rotated]
            pairs[constraints.rotated] = (frames.transpose(0, 2, 1) @ pairs[constraints.rotated][:, :, None])[:, :, 0]
        return vector

    def _imbalance(self, A: Array, unknowns: Array) -> Array:
        """Element residuals f - A u, shape (e, k)."""
        local = unknowns[self._equations.space.dofs]
        return np.asarray(self._load - (A @ local[:, :, None])[:, :, 0])

    def departure(self) -> float:
        """Largest difference of the velocity from what a linear step expected, relative to the largest velocity."""
        velocity = self._unknowns[: self._expected.size].reshape(-1, 2)
        largest = float(np.abs(velocity).max(initial=0.0))
        return float(np.abs(velocity - self._expected).max(initial=0.0)) / largest if largest else 0.0

    def reaction(self) -> Array:
        """Nodal momentum residual of the last solution, shape (n, 2): the force of the boundary on the fluid."""
        space = self._equations.space
        if self._residual is None:
            raise ValueError("reaction: the step has not been solved yet.")
        return -assemble_vector(space.dofs, self._residual, space.size)[: 2 * space.velocity_count].reshape(-1, 2)

    def accept(self) -> FluidState:
        """Return the state at the end of the step."""
        n = 2 * self._equations.space.velocity_count
        velocity, pressure = self._unknowns[:n].reshape(-1, 2), self._unknowns[n:]
        keep = 1 if self._order else 0
        return FluidState(
            (velocity, *self.state.velocities[:keep]),
            pressure,
            (self.points, *self.state.points[:keep]),
            self.reaction(),
            self.time,
        )
