"""One step of a fluid, or its steady state, on one mesh: how it is solved."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi.case import Convection
from hofsi.fem.assembly import assemble_vector
from hofsi.fem.condensed_factor import CondensedFactor
from hofsi.linear.solver import Solver
from hofsi.solvers.fluid_equations import FluidEquations
from hofsi.solvers.fluid_newton import FluidNewton
from hofsi.solvers.fluid_operator import FluidOperator
from hofsi.solvers.fluid_state import FluidState
from hofsi.solvers.fluid_system import factorised
from hofsi.solvers.interface_response import InterfaceResponse

Array = NDArray[np.float64]

__all__ = ["FluidStep"]

_EXACT = 1e-12  # relative residual of a solution for another velocity of the interface; one with more is solved for
_UNEXPECTED = 0.25  # of the velocity: a flow further from what was expected needs more than one linearisation


class FluidStep:
    """One step, or the steady problem, on one mesh; made by `FluidSolver`.

    A "linearised" step is Newton's linearisation about the velocity that the last steps let expect, which is of second
    order in the step size: with δ the error of that velocity it leaves out ρ δ·∇δ, of fourth order. An "extrapolated"
    one merely convects with the expected velocity, which leaves out ρ δ·∇u, of second order, and feeds energy into fast
    oscillations. Both are assembled and factorised once, however often they are solved. If the first solution of a
    linearised step is far from what was expected, as after an impulsive start, Newton's method goes on from it, and
    further solutions are linearised about where it ends. Linear steps also tell, if asked to beforehand, how they
    answer to other velocities of the interface without being solved for them.

    A steady problem that Newton's method does not solve from where it starts is approached from Stokes flow, with more
    and more of the convection.

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
        convection: Convection,
        responding: bool = False,
    ) -> None:
        self._equations, self.state, self.points, self.time = equations, state, points, time
        self.mesh_velocity = mesh_velocity
        self._rate, self._expected, self._order = rate, expected, order
        self.linear = convection in ("linearised", "extrapolated") or not equations.convecting
        self._convection: Convection = convection
        self.converged = False
        self._operator = FluidOperator(equations, points, mesh_velocity, rate, history, time)
        self._newton = FluidNewton(equations, self._operator, points, rate, time, picard=convection == "picard")
        self._factor: Solver | None = None
        self._settled = convection != "linearised" or not equations.convecting
        self._unknowns = np.concatenate([expected.ravel(), state.pressure])
        self._residual: Array | None = None
        self._responding = responding
        self._response: InterfaceResponse | None = None
        self._stiffness: tuple[Array, float, Array] | None = None

    def continue_from(self, other: FluidStep, interface: Array | None = None) -> None:
        """Start the solution from that of another step, for example on the mesh of the last coupling iteration.

        If the other one tells how it answers to the velocity of the interface, shape (k, 2), from that answer.
        """
        self._unknowns = other._unknowns
        if interface is not None and other._response is not None:
            self._unknowns = other._unknowns + other._response.change(interface)

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
            geometry, flux = self._equations.geometry(self.points), self._equations.pressure_work(self.points)
            enclosed.balance(self._operator.load, velocity, geometry, flux, moving=bool(self.mesh_velocity.any()))
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is found below
            if self.linear:
                unknowns = self._solve_linear(unknowns, interface)
            else:
                unknowns = self._newton.solve(unknowns, max_iterations)
                self.converged, self._residual = self._newton.converged, self._newton.residual
        if enclosed and self._residual is not None:
            enclosed.remove_mean(unknowns[n:], self._residual, geometry, flux)
        self._unknowns = unknowns
        return unknowns[:n].reshape(-1, 2), unknowns[n:]

    def respond(self, interface: Array) -> Array | None:
        """What would act on the fluid at the interface if it had another velocity, as exactly as the factors tell.

        Parameters
        ----------
        interface : ndarray, shape (k, 2)

        Returns
        -------
        ndarray, shape (k, 2), or None
            None if that takes a solution: the step has not been solved yet, or it is not linear, or a part of the fluid
            is enclosed, or the factors are not exact.
        """
        if self._response is None:
            return None
        self._equations.counts.responses += 1
        return self._response.reaction(interface)

    @property
    def responding(self) -> bool:
        """Whether it is known how the step answers to other velocities of the interface."""
        return self._response is not None

    def interface_stiffness(self, rate: float) -> Array | None:
        """What displacements of the interface (2k,) add to the force on its other side; None as in `respond`.

        Parameters
        ----------
        rate : float
            Of the interface's velocity for a displacement.

        Returns
        -------
        ndarray, shape (2k, 2k), or None
            The same object as long as it is the same.
        """
        if self._response is None:
            return None
        matrix, kept = self._response.matrix, self._stiffness
        if kept is None or kept[0] is not matrix or kept[1] != rate:
            kept = self._stiffness = matrix, rate, -rate * matrix
        return kept[2]

    def _solve_linear(self, unknowns: Array, interface: Array) -> Array:
        self.converged = True
        responded = self._responded(interface)
        if responded is None:
            unknowns = self._corrected(unknowns)
        elif self._near(responded):
            self._respond_from(responded, interface)
            return responded
        else:
            unknowns, self._settled = responded, False
        if not self._settled:
            unknowns = self._settle(unknowns)
            if self._factor is None and self._responding and self._equations.responds(self.points):
                unknowns = self._corrected(unknowns)  # the factors of what is linearised about now tell the response
        self._respond_from(unknowns, interface)
        return unknowns

    def _responded(self, interface: Array) -> Array | None:
        """What the response tells of another velocity of the interface; None if it does not tell that exactly."""
        if self._response is None:
            return None
        changed = self._unknowns + self._response.change(interface)
        residual = self._linear_residual(changed)
        norm, scale = self._operator.size(residual)
        if norm > _EXACT * scale:
            return None
        self._residual = residual
        return changed

    def _near(self, unknowns: Array) -> bool:
        """Whether a velocity is near enough to what was expected for one linearisation."""
        if self._convection != "linearised" or not self._equations.convecting:
            return True
        velocity = unknowns[: self._expected.size].reshape(-1, 2)
        largest = float(np.abs(velocity).max(initial=0.0))
        return float(np.abs(velocity - self._expected).max(initial=0.0)) <= _UNEXPECTED * largest

    def _corrected(self, unknowns: Array) -> Array:
        """Solve the linear equations at hand, from some unknowns on; their residual is kept."""
        if self._factor is None:
            self._factor = self._factorised()
        self._equations.counts.solves += 1
        r = self._linear_residual(unknowns)
        if isinstance(self._factor, CondensedFactor):
            change, self._residual = self._factor.solve_and_balance(r)
            return unknowns + change
        unknowns = unknowns + self._factor.solve(r)
        self._residual = self._linear_residual(unknowns)
        return unknowns

    def _respond_from(self, unknowns: Array, interface: Array) -> None:
        """Answer to other velocities of the interface from this solution on, if the factors make it possible."""
        self._response = None
        if self._responding and isinstance(self._factor, CondensedFactor):
            matrix = self._factor.border_response
            if matrix is not None:
                reaction = self.reaction()[self._equations.boundary.interface]
                self._response = InterfaceResponse(self._factor, matrix, interface, reaction)

    def _linear_residual(self, unknowns: Array) -> Array:
        if not self._equations.convecting:
            return self._operator.residual_without_convection(unknowns)
        return self._operator.residual_about(unknowns, self._expected, newton=self._convection == "linearised")

    def _factorised(self) -> Solver:
        """Factors of the matrix of a linear step."""
        equations = self._equations
        if not equations.convecting:
            return equations.stokes_factor(self.points, self._rate, responding=self._responding)
        equations.counts.factorised("linear step")
        matrices = self._operator.matrices(self._expected, newton=self._convection == "linearised")
        return factorised(equations.system(self.points), matrices, responding=self._responding)

    def _settle(self, unknowns: Array) -> Array:
        """Accept what the first linearisation gives, or go on with Newton's method and linearise about its result."""
        self._settled = True
        if self._near(unknowns):
            return unknowns
        unknowns, self._residual = self._newton.solve_at_once(unknowns), self._newton.residual
        self._expected = unknowns[: self._expected.size].reshape(-1, 2)
        self._factor = None
        return unknowns

    def reaction(self) -> Array:
        """Nodal momentum residual of the last solution, shape (n, 2): the force of the boundary on the fluid.

        On periodic sides that includes what the fluid beyond the side exerts.
        """
        space = self._equations.space
        if self._residual is None:
            raise ValueError("reaction: the step has not been solved yet.")
        return -assemble_vector(space.node_dofs, self._residual, space.size)[: 2 * space.velocity_count].reshape(-1, 2)

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
            self.mesh_velocity,
        )
