"""Factors of the fluid's matrices that outlive the iteration, and the step, they were made for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.counts import Counts
from hofsi.fem.condensation import CondensedSystem
from hofsi.fem.condensed_factor import CondensedFactor
from hofsi.fem.element_matrices import MatrixMaker, origin_of
from hofsi.linear.checked import CheckedSolver
from hofsi.linear.lagged import LaggedSolver
from hofsi.solvers.fluid_system import FluidSystem

Array = NDArray[np.float64]

__all__ = ["FactorsMemory", "FluidFactors", "Problem"]

_LIMIT = 10  # iterations: more cost as much as new factors
_FLOW = 0.5  # change of the velocity, as a part of the largest one
_RATE = 2.0  # ratio of step sizes
_NEAR = 1e-2  # change of the velocity, likewise, up to which factors serve without a new matrix, ...
_CONTRACTION = 0.2  # ... as long as the residual falls at least by that
_CORRECTION = 1e-4  # residual that an iterative solver may leave, relative: the next iteration takes it away


@dataclass(frozen=True, eq=False)
class Problem:
    """What matrices depend on besides the velocity.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        The same array if the mesh is the same.
    rate : float
        Weight of the new velocity in the time derivative; 0 if steady.
    share : float
        Of the convection.
    """

    points: Array
    rate: float
    share: float


@dataclass(frozen=True, eq=False)
class FactorsMemory:
    """What factors were made from, and how they have served.

    Attributes
    ----------
    origin : object
        Of their matrix, see `hofsi.fem.element_matrices.origin_of`.
    system : object
        Of the linear system they belong to.
    chord : bool
        Whether they serve without a new matrix.
    before : float
        Norm of the residual that they were last applied to.
    fell_back : bool
        Whether those of the fallback have taken their place.
    """

    origin: object
    system: object
    chord: bool
    before: float
    fell_back: bool


class FluidFactors:
    """Solves the linear systems of Newton's and Picard's iterations, with old factors where they serve.

    A matrix is factorised if there are no factors yet ("first"), if the free unknowns are others ("unknowns"), if the
    step size has changed by more than a factor of two ("step size"), if the velocity has changed by more than half of
    the largest ("flow"), or if GMRES needs more than ten iterations with the factors at hand ("iterations").

    As long as neither mesh nor step size nor share of the convection changes and the velocity hardly does, the
    factors, inner unknowns of the elements included, serve as they are (a chord iteration): no matrix is made at all,
    until the residual falls by less than a factor of five.

    Parameters
    ----------
    counts : Counts
        Factorisations with their reasons, solutions and iterations of GMRES are counted there.
    lag : bool
        Whether to keep factors at all.
    """

    def __init__(self, counts: Counts, lag: bool) -> None:
        self._counts, self._lag = counts, lag
        self._factor: CheckedSolver | None = None
        self._system: CondensedSystem | None = None
        self._velocity, self._rate = np.zeros(0), 0.0
        self._origin: object = None
        self._chord: tuple[CondensedFactor, Problem, Array] | None = None
        self._before = np.inf

    def solve(
        self,
        system: FluidSystem,
        problem: Problem,
        matrices: Callable[[], MatrixMaker],
        r: Array,
        velocity: Array,
        norm: float,
        goal: float,
    ) -> Array:
        """Solve once with element matrices.

        Parameters
        ----------
        system : FluidSystem
        problem : Problem
            What the matrices depend on besides the velocity.
        matrices : callable
            Prepares what makes them.
        r : ndarray, shape (e, k)
            Right-hand side, element by element.
        velocity : ndarray, shape (n, 2)
            The one that the matrices belong to.
        norm : float
            Of the right-hand side.
        goal : float
            Norm of the residual that may be left; new factors solve more exactly.

        Returns
        -------
        ndarray, shape (size,)
        """
        self._counts.solves += 1
        if self._chord is not None and self._chord_serves(problem, velocity, norm):
            self._before = norm
            return self._chord[0].solve(r)
        self._chord, self._before = None, np.inf
        A, rate = matrices(), problem.rate
        if not self._lag or not isinstance(system, CondensedSystem) or not system.exact:
            self._counts.factorised("new matrix")
            return system.factorise(A, tolerance=_CORRECTION).solve(r)
        reason = self._reason(system, velocity, rate)
        if reason or self._factor is None:
            self._counts.factorised(reason)
            solver = system.factorise(A)
            if isinstance(solver.factor, CheckedSolver):
                self._keep(system, solver.factor, velocity, rate, origin_of(A))
                self._chord = solver, problem, self._velocity
            return solver.solve(r)
        lagged = system.lagged(A, self._factor, goal, _LIMIT)
        x = lagged.solve(r)
        assert isinstance(lagged.factor, LaggedSolver)
        self._counts.linear_iterations += lagged.factor.iterations
        if lagged.factor.renewed:
            self._counts.factorised("iterations")
            self._keep(system, lagged.factor.factor, velocity, rate, origin_of(A))
        return x

    def memory(self) -> FactorsMemory | None:
        """What the factors at hand can be made again from; None if there are none."""
        if self._factor is None or self._system is None or self._origin is None:
            return None
        chord = self._chord is not None
        return FactorsMemory(self._origin, self._system.origin, chord, self._before, self._factor.fell_back)

    def forget(self) -> None:
        """Start without factors."""
        self._factor = self._system = self._chord = None
        self._origin, self._before = None, np.inf

    def recall(
        self, memory: FactorsMemory, system: CondensedSystem, problem: Problem, A: MatrixMaker, velocity: Array
    ) -> None:
        """Make the factors of a memory again.

        Parameters
        ----------
        memory : FactorsMemory
        system : CondensedSystem
            Of its ``system``.
        problem : Problem
        A : callable
            The matrices of its ``origin``.
        velocity : ndarray, shape (n, 2)
            The one that the matrices belong to.
        """
        solver = system.factorise(A)
        assert isinstance(solver.factor, CheckedSolver)
        if memory.fell_back:
            solver.factor.fall_back()
        self._keep(system, solver.factor, velocity, problem.rate, memory.origin)
        self._chord = (solver, problem, self._velocity) if memory.chord else None
        self._before = memory.before

    def _chord_serves(self, problem: Problem, velocity: Array, norm: float) -> bool:
        """Whether the last factors belong to the same problem at nearly the same velocity, and have served so far."""
        assert self._chord is not None
        _, of, at = self._chord
        same = of.points is problem.points and of.rate == problem.rate and of.share == problem.share
        if not same or norm > _CONTRACTION * self._before:
            return False
        return bool(np.abs(velocity - at).max(initial=0.0) <= _NEAR * np.abs(velocity).max(initial=0.0))

    def _keep(
        self, system: CondensedSystem, factor: CheckedSolver, velocity: Array, rate: float, origin: object
    ) -> None:
        self._system, self._factor, self._velocity, self._rate = system, factor, velocity.copy(), rate
        self._origin = origin

    def _reason(self, system: CondensedSystem, velocity: Array, rate: float) -> str:
        """Why old factors would not do; empty if they may."""
        if self._factor is None or self._system is None:
            return "first"
        if system is not self._system and not np.array_equal(system.unknowns, self._system.unknowns):
            return "unknowns"
        if not rate <= _RATE * self._rate or not self._rate <= _RATE * rate:
            return "step size"
        if np.abs(velocity - self._velocity).max(initial=0.0) > _FLOW * np.abs(velocity).max(initial=0.0):
            return "flow"
        return ""
