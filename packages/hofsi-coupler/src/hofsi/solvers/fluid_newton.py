"""Newton's method for one step of a fluid, or its steady state, and continuation where it fails."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from hofsi.errors import LinearSolverError, NewtonError
from hofsi.solvers.continuation import approach
from hofsi.solvers.fluid_equations import FluidEquations
from hofsi.solvers.fluid_factors import Problem
from hofsi.solvers.fluid_operator import FluidOperator

Array = NDArray[np.float64]

__all__ = ["FluidNewton"]

_ON_THE_WAY = 1e-6  # tolerance of the problems that continuation solves on the way
_ROUNDING = 1e-14  # of |A| |u|: a residual below that is rounding; nothing else is left of a flow without stress
_FEW = 12  # Newton iterations that each of them may take: from a good start that is enough
_ROUGHEST = 1e-3  # relative residual of an iteration's linear system
_PART = 1e-3  # of the nonlinear tolerance: what the last linear system may leave


class FluidNewton:
    """Solves A(u) u = f with factors that are kept while they serve; a steady problem also little by little.

    Parameters
    ----------
    equations : FluidEquations
    operator : FluidOperator
        Its ``share`` of the convection is changed on the way.
    points : ndarray, shape (n, 2)
    rate : float
        Weight of the new velocity in the time derivative; 0 if steady.
    time : float
        For messages.
    picard : bool
        Whether Newton's term is left out.

    Attributes
    ----------
    converged : bool
        Whether the last solution satisfies its tolerance.
    residual : ndarray, shape (e, k), or None
        Element residuals of the last iterate.
    """

    def __init__(
        self,
        equations: FluidEquations,
        operator: FluidOperator,
        points: Array,
        rate: float,
        time: float,
        *,
        picard: bool,
    ) -> None:
        self._equations, self._operator, self._points = equations, operator, points
        self._rate, self._time, self._picard = rate, time, picard
        self.converged = False
        self.residual: Array | None = None

    def solve(self, unknowns: Array, max_iterations: int | None = None) -> Array:
        """Find the solution from a starting value, with continuation if a steady problem does not let it be found.

        Parameters
        ----------
        unknowns : ndarray
            Velocity with all conditions satisfied, and pressure.
        max_iterations : int, optional
            To make at most, without continuation; stopping there is not an error.

        Raises
        ------
        NewtonError, LinearSolverError
            If neither converges.
        """
        settings = self._equations.nonlinear
        if max_iterations is not None:
            return self._iterate(unknowns, max_iterations, settings.tolerance, stop=True)
        try:
            return self.solve_at_once(unknowns)
        except (NewtonError, LinearSolverError) as error:
            if self._rate:
                raise
            failure = error
        try:
            return approach(self._with_share, unknowns, failure, "of the convection")
        finally:
            self._operator.share = 1.0

    def solve_at_once(self, unknowns: Array) -> Array:
        """The same without continuation."""
        settings = self._equations.nonlinear
        return self._iterate(unknowns, settings.max_iterations, settings.tolerance)

    def _with_share(self, unknowns: Array, share: float) -> Array:
        """Solve with a share of the convection, roughly if it is not all."""
        equations, settings = self._equations, self._equations.nonlinear
        self._operator.share = share
        equations.counts.continuation_steps += 1
        if share == 1.0:
            return self.solve_at_once(unknowns)
        limit = settings.max_iterations if self._picard else min(_FEW, settings.max_iterations)
        rough = self._iterate(unknowns, limit, max(_ON_THE_WAY, settings.tolerance))
        self.converged = False
        return rough

    def _iterate(self, unknowns: Array, limit: int, tolerance: float, *, stop: bool = False) -> Array:
        """At most some iterations; with ``stop``, ending there is not an error."""
        equations = self._equations
        self.converged = False
        norm, scale = self._balance(unknowns)
        for iteration in range(limit + 1):
            if norm <= tolerance * scale or self._operator.is_rounding(norm, unknowns, _ROUNDING):
                self.converged = True
                return unknowns
            if not np.isfinite(norm):
                raise NewtonError(
                    f"the residual is not finite after {iteration} iterations. Lower the time step or the Reynolds "
                    "number, or check the given velocities.",
                    "diverged",
                    f"fluid, t = {self._time:g}",
                )
            if iteration == limit:
                break
            velocity = unknowns[: 2 * equations.space.velocity_count].reshape(-1, 2)
            matrices = partial(self._operator.matrices, velocity, newton=not self._picard)
            problem = Problem(self._points, self._rate, self._operator.share)
            assert self.residual is not None
            r, goal = self.residual, norm * _enough(norm / scale, tolerance)
            system = equations.system(self._points)
            delta = equations.factors.solve(system, problem, matrices, r, velocity, norm, goal)
            equations.counts.iterations += 1
            unknowns, norm, scale = self._damped(unknowns, delta, norm)
        if not stop:
            raise NewtonError(
                f"Newton's method stopped at a relative residual of {norm / scale:.2g} after {limit} iterations; "
                f"expected below {tolerance:g}. Refine the mesh, lower the Reynolds number, "
                f'{"take smaller steps" if self._rate else "march in time"}, or use convection = "picard".',
                "max_iterations",
                f"fluid, t = {self._time:g}",
            )
        return unknowns

    def _damped(self, unknowns: Array, delta: Array, norm: float) -> tuple[Array, float, float]:
        """Full step, halved up to four times while the residual grows by more than a factor of ten."""
        factor = 1.0
        for _ in range(5):
            trial = unknowns + factor * delta
            new, scale = self._balance(trial)
            if np.isfinite(new) and new <= 10.0 * norm:
                break
            factor *= 0.5
        return trial, new, scale

    def _balance(self, unknowns: Array) -> tuple[float, float]:
        """Norm of the residual at a state, which is kept, and a scale to compare it with."""
        self.residual = self._operator.residual(unknowns)
        return self._operator.size(self.residual)


def _enough(residual: float, tolerance: float) -> float:
    """How well an iteration's linear system is worth solving: as far as Newton's method gets, which squares residuals.

    The last iteration is solved well enough for what it leaves not to count beside the tolerance.
    """
    if residual**2 <= tolerance:
        return min(_ROUGHEST, _PART * tolerance / residual)
    return min(_ROUGHEST, residual)
