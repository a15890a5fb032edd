"""Elastic solids on one mesh: time steps and static equilibrium, state in and state out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hofsi import case
from hofsi.counts import Counts
from hofsi.errors import ConvergenceError, NewtonError
from hofsi.solvers.solid_equations import SolidEquations
from hofsi.solvers.solid_newton import SolidNewton, Tangent
from hofsi.solvers.solid_rest import check_held
from hofsi.solvers.solid_supports import SolidSupports
from hofsi.solvers.solid_system import solid_system
from hofsi.timestepping.schemes import bdf_weights

Array = NDArray[np.float64]

__all__ = ["SolidSolver", "SolidState", "SolidStep"]


def _frozen(array: Array) -> Array:
    view = array.view()
    view.setflags(write=False)
    return view


@dataclass(frozen=True, eq=False)
class SolidState:
    """Solids at the end of a step.

    Attributes
    ----------
    displacements, velocities : tuple of ndarray, shape (n, 2)
        Newest first, at most two; read-only.
    time : float
    reaction : ndarray, shape (n, 2), or None
        Nodal forces of the supports on the solid, zero where nothing holds it; read-only. None in an initial state.
    """

    displacements: tuple[Array, ...]
    velocities: tuple[Array, ...]
    time: float
    reaction: Array | None = None

    def __post_init__(self) -> None:
        if self.reaction is not None:
            object.__setattr__(self, "reaction", _frozen(self.reaction))
        for name in ("displacements", "velocities"):
            object.__setattr__(self, name, tuple(_frozen(array) for array in getattr(self, name)))

    @property
    def displacement(self) -> Array:
        """Newest displacement."""
        return self.displacements[0]

    @property
    def velocity(self) -> Array:
        """Newest velocity."""
        return self.velocities[0]


class SolidSolver:
    """Discretisation of one or several elastic solids.

    Parameters
    ----------
    mesh : QuadMesh
        The solids' blocks only, undeformed.
    solids : sequence of Solid
    nonlinear : NonlinearSettings
    linear : LinearSettings, optional
        By default sparse LU.

    Attributes
    ----------
    equations : SolidEquations
    supports : SolidSupports
    system : CondensedSystem
        The linear systems: LU or multigrid.
    counts : Counts
        What was done so far.
    """

    def __init__(
        self,
        mesh: QuadMesh,
        solids: Sequence[case.Solid],
        nonlinear: case.NonlinearSettings,
        linear: case.LinearSettings | None = None,
    ) -> None:
        self.mesh, self.solids, self.nonlinear = mesh, tuple(solids), nonlinear
        self.equations = SolidEquations(mesh, solids)
        self.supports = SolidSupports(mesh, solids, self.equations.cells_of)
        self.counts = Counts()
        self.system = solid_system(self.equations, self.supports, linear or case.LinearSettings())
        self._tangent: Tangent | None = None

    def initial_state(self, time: float = 0.0) -> SolidState:
        """State from the initial displacement and velocity of the case, at rest where none is given.

        Where solids touch, the later one in the case decides.
        """
        d, v = np.zeros(self.mesh.points.shape), np.zeros(self.mesh.points.shape)
        for solid, own in zip(self.solids, self.equations.cells_of, strict=True):
            nodes = np.unique(self.mesh.cells[own])
            x, y = self.mesh.points[nodes].T
            for field, given in ((d, solid.initial_displacement), (v, solid.initial_velocity)):
                for a, expression in enumerate(given or ()):
                    field[nodes, a] = expression.evaluate(x=x, y=y)
        return SolidState((d,), (v,), time)

    def begin_step(self, state: SolidState, steps: Sequence[float], time: float) -> SolidStep:
        """Start a time step that ends at ``time``.

        Backward differences of second order for displacement and velocity, of first order as long as the state knows
        one time only.

        Parameters
        ----------
        state : SolidState
        steps : sequence of float
            This step's size and the one before it, newest first.
        time : float
            At the end of the step.
        """
        order = min(2, len(state.displacements), len(steps))
        return SolidStep(self, state, bdf_weights(steps[:order]), time)

    def begin_static(self, state: SolidState | None = None) -> SolidStep:
        """Start a search for static equilibrium, from a state or from the initial one.

        Raises
        ------
        CaseError
            If the supports leave a part of the solids free to move without deforming.
        """
        check_held(self.mesh, self.solids, self.equations.cells_of, self.supports.constraints.entries)
        start = self.initial_state() if state is None else state
        return SolidStep(self, start, None, start.time)

    def keep(self, tangent: Tangent | None) -> None:
        """Keep a tangent for later steps if it holds for them: if all solids are linear."""
        if self.equations.linear:
            self._tangent = tangent

    def tangent(self, mass_factor: float) -> Tangent | None:
        """Return the tangent that was kept, if it holds for a step with this mass factor."""
        kept = self._tangent
        return kept if kept is not None and kept.mass_factor == mass_factor else None


class SolidStep:
    """One time step, or static equilibrium; made by `SolidSolver`.

    Parameters
    ----------
    solver : SolidSolver
    state : SolidState
        At the start.
    weights : ndarray, or None
        Of the backward difference formula; None for statics.
    time : float
        At the end.
    """

    def __init__(self, solver: SolidSolver, state: SolidState, weights: Array | None, time: float) -> None:
        self.solver, self.state, self.time = solver, state, time
        self._weights = weights
        equations = solver.equations
        self._dead = equations.loads.dead(time)
        self._load: Array | None = None
        factor, acceleration = 0.0, None
        self._velocity_history = np.zeros(state.displacement.shape)
        if weights is not None:
            factor = float(weights[0]) ** 2
            self._velocity_history = _history(weights, state.displacements)
            acceleration = weights[0] * self._velocity_history + _history(weights, state.velocities)
        self._newton = SolidNewton(
            equations,
            solver.supports,
            solver.system,
            solver.nonlinear,
            solver.counts,
            time,
            factor,
            acceleration,
            equations.loads.pressures(time),
            equations.stress(equations.gradient(state.displacement)),
            solver.tangent(factor),
        )

    def solve(self, load: Array | None = None, guess: Array | None = None, *, tolerance: float | None = None) -> Array:
        """Find the displacement under a load.

        Later calls, with other loads, reuse the tangent's factors as long as they serve.

        Parameters
        ----------
        load : ndarray, shape (n, 2), optional
            Nodal forces of the fluid, besides the loads of the case.
        guess : ndarray, shape (n, 2), optional
            Where to start; by default the state at the start of the step.
        tolerance : float, optional
            Instead of the case's.

        Returns
        -------
        ndarray, shape (n, 2)

        Raises
        ------
        NewtonError, LinearSolverError
            If neither Newton's method from the guess nor applying the load little by little succeeds.
        """
        self._load = load
        force = self._force(load)
        start = self.state.displacement if guess is None else guess
        tolerance = self.solver.nonlinear.tolerance if tolerance is None else tolerance
        try:
            result = self._newton.solve(start, force, tolerance)
        except ConvergenceError:
            if self.solver.equations.linear:
                raise
            result = self._newton.solve_by_parts(self.state.displacement, force, tolerance)
        self.solver.keep(self._newton.tangent)
        return result

    def reaction(self, displacement: Array, load: Array | None = None) -> Array:
        """Forces of the supports on the solid, shape (n, 2): internal force + inertia - loads where it is held."""
        return self.solver.supports.held_part(self._newton.residual(displacement, self._force(load)))

    def accept(self, displacement: Array) -> SolidState:
        """Return the state at the end of the step, its reaction under the load that was solved for last.

        Raises
        ------
        NewtonError
            If the solid is turned inside out somewhere: det F is not positive.
        """
        equations = self.solver.equations
        lowest = equations.lowest_volume_ratio(displacement)
        if not lowest > 0.0:
            raise NewtonError(
                f"the solid is turned inside out: det F is {lowest:.3g} somewhere; must be positive. "
                "Take smaller time steps, refine the mesh, or check the loads.",
                "inverted",
                f"solid, t = {self.time:g}",
            )
        reaction = self.reaction(displacement, self._load)
        if self._weights is None:
            return SolidState((displacement,), (np.zeros(displacement.shape),), self.time, reaction)
        velocity = self._weights[0] * displacement + self._velocity_history
        displacements, velocities = (displacement, self.state.displacement), (velocity, self.state.velocity)
        return SolidState(displacements, velocities, self.time, reaction)

    def _force(self, load: Array | None) -> Array:
        return self._dead if load is None else self._dead + load


def _history(weights: Array, values: tuple[Array, ...]) -> Array:
    """Part of a backward difference that is known at the start of the step."""
    return np.asarray(sum(w * value for w, value in zip(weights[1:], values, strict=False)))
