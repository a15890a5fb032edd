"""Newton's method for one step of a solid, with factors of the tangent that are kept while they serve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.case import NonlinearSettings
from hofsi.counts import Counts
from hofsi.errors import ConvergenceError, NewtonError
from hofsi.fem.condensation import CondensedSystem
from hofsi.fem.condensed_factor import CondensedFactor
from hofsi.solvers.load_response import LoadResponse, RespondingSystem, unknowns_of
from hofsi.solvers.solid_equations import SolidEquations
from hofsi.solvers.solid_loads import FollowerPressure
from hofsi.solvers.solid_supports import SolidSupports

Array = NDArray[np.float64]

__all__ = ["SolidNewton", "Tangent"]

_PATIENCE = 8.0  # more iterations than this with an old tangent cost more than a new one
_HALVINGS = 5  # of an increment that leads where the stress is not finite: neo-Hookean solids turned inside out
_SMALLEST_PART = 2.0**-10  # of the load, in continuation
_ROUNDING = 0.25  # of the estimated rounding error, which measured residuals reach between a fiftieth and a seventh


@dataclass(frozen=True, eq=False)
class Tangent:
    """Element matrices and their factors.

    Attributes
    ----------
    mass_factor : float
        Of the mass in ``K``.
    K : ndarray, shape (e, k, k)
    factor : CondensedFactor
    """

    mass_factor: float
    K: Array
    factor: CondensedFactor


@dataclass(frozen=True, eq=False)
class _Point:
    """An iterate, its displacement gradient and stress, and the residual left there."""

    displacement: Array
    gradient: Array
    stress: Array
    residual: Array
    norm: float
    scale: float

    @property
    def finite(self) -> bool:
        return bool(np.isfinite(self.norm))


class SolidNewton:
    """Solves internal force(d) + mass · (c d + history) = force + pressures(d) under the supports of one time.

    A tangent is factorised when the one at hand makes too little progress, so that repeated solutions with slightly
    different forces, as in coupling iterations, share one. Its geometric stiffness, and the pressure in that of
    neo-Hookean solids, take the stress linearised about the last iterate, at first that of the last solution, instead
    of the iterate's own. The two agree in the limit, hence convergence stays quadratic. Far away the iterate's own
    stress is dominated in thin bodies by the membrane stress, and in nearly incompressible ones by the pressure, that
    any finite increment of rotation leaves behind, and Newton's method would follow that.

    Parameters
    ----------
    equations : SolidEquations
    supports : SolidSupports
    system : CondensedSystem
    settings : NonlinearSettings
    counts : Counts
        Updated.
    time : float
        For messages.
    impose : callable
        Takes a displacement, and returns it with all supports satisfied.
    mass_factor : float
        c, 0 for statics.
    history : ndarray, shape (n, 2), or None
        Part of the acceleration that does not depend on d.
    pressures : list of FollowerPressure
    stress : ndarray, shape (e, q, 3)
        Of the last solution.
    tangent : Tangent, optional
        To begin with.
    mean_with : ndarray, shape (e, q, 2, 2), optional
        Displacement gradient of the start of a step whose d is that of its middle: the stress is then the one that
        keeps the energy. With the difference Δ between d and the start, it belongs to the mean of the strains at start
        and end, E(d) + Δᵀ Δ/2. The tangent leaves out what depends on Δ; convergence is linear, and fast for small
        steps.

    Attributes
    ----------
    tangent : Tangent or None
        The one at hand.
    response : LoadResponse or None
        What the force gains with the displacement, besides.

    References
    ----------
    Magisano, Leonetti, Garcea: How to improve efficiency and robustness of the Newton method in geometrically
    non-linear structural problem discretized via displacement-based finite elements, Comput. Methods Appl. Mech. Eng.
    313 (2017) 986–1005, doi:10.1016/j.cma.2016.10.023.
    """

    def __init__(
        self,
        equations: SolidEquations,
        supports: SolidSupports,
        system: CondensedSystem,
        settings: NonlinearSettings,
        counts: Counts,
        time: float,
        impose: Callable[[Array], Array],
        mass_factor: float,
        history: Array | None,
        pressures: list[FollowerPressure],
        stress: Array,
        tangent: Tangent | None = None,
        mean_with: Array | None = None,
    ) -> None:
        self._impose, self._mean_with = impose, mean_with
        self._equations, self._supports, self._system = equations, supports, system
        self._settings, self._counts, self._time = settings, counts, time
        self._mass_factor, self._pressures = mass_factor, pressures
        self._inertia = None if history is None else equations.mass @ history
        self._stress = stress
        self.tangent = tangent
        self.response: LoadResponse | None = None
        self._responding: tuple[LoadResponse, Tangent, RespondingSystem] | None = None

    def residual(self, displacement: Array, force: Array) -> Array:
        """What the supports must add for equilibrium, shape (n, 2)."""
        return self._at(displacement, force, 0.0).residual

    def nearer(self, first: Array, second: Array, force: Array) -> Array:
        """The one of two displacements that leaves the smaller residual; the first if it is not told."""
        norms = [self._at(displacement, force, 0.0).norm for displacement in (first, second)]
        return second if norms[1] < norms[0] else first

    def solve(self, start: Array, force: Array, tolerance: float) -> Array:
        """Find the displacement from a starting value.

        Parameters
        ----------
        start : ndarray, shape (n, 2)
        force : ndarray, shape (n, 2)
            Nodal forces that do not depend on the displacement.
        tolerance : float
            Of the residual, relative to the largest of the forces in balance.

        Raises
        ------
        NewtonError
            If the method does not converge.
        LinearSolverError
            If a tangent is singular.
        """
        target = self._impose(start)
        return self._iterate(start, target - start, force, 0.0, tolerance)

    def solve_by_parts(self, start: Array, force: Array, tolerance: float) -> Array:
        """Find the displacement by applying what is out of balance at the start little by little.

        Pressures grow with the part, following the deformation: their counterpart in the imbalance would not.

        Raises
        ------
        NewtonError, LinearSolverError
            If the method does not converge with 1/1024 of the imbalance either.
        """
        pressures, self._pressures = self._pressures, []
        try:
            imbalance = self.residual(start, force)
            return self._by_parts(start, force, imbalance, pressures, tolerance)
        finally:
            self._pressures = pressures

    def _by_parts(
        self, start: Array, force: Array, imbalance: Array, pressures: list[FollowerPressure], tolerance: float
    ) -> Array:
        movement = self._impose(start) - start
        done, part, d = 0.0, 0.25, start
        self.tangent = None
        self._stress = self._equations.stress(self._equations.gradient(start))
        while done < 1.0:
            reached = min(1.0, done + part)
            last = reached == 1.0
            self._pressures = pressures if last else [pressure.scaled(reached) for pressure in pressures]
            try:
                d = self._iterate(
                    d,
                    (reached - done) * movement,
                    force,
                    (1.0 - reached) * imbalance,
                    tolerance if last else max(tolerance, 1e-6),
                )
            except ConvergenceError as error:
                part *= 0.25
                if part < _SMALLEST_PART:
                    raise type(error)(
                        f"{error.problem} Applied little by little, {done:.3g} of the load was reached.",
                        error.reason,
                        error.where,
                    ) from error
                self.tangent = None
                continue
            done, part = reached, 2.0 * part
        return d

    def _at(self, displacement: Array, force: Array, offset: Array | float) -> _Point:
        """Evaluate the residual."""
        eq = self._equations
        gradient = eq.gradient(displacement)
        with np.errstate(over="ignore", invalid="ignore"):
            start = self._mean_with
            stress = eq.stress(gradient) if start is None else eq.mean_stress(gradient, start)
            internal = eq.internal_force(gradient, stress)
            external = force
            if self._pressures or self.response is not None:
                external = force.copy()
                for pressure in self._pressures:
                    pressure.add_force(external, displacement)
                if self.response is not None:
                    self.response.add_force(external, displacement)
            residual = internal - external
            scale = max(float(np.linalg.norm(internal)), float(np.linalg.norm(external)))
            if self._inertia is not None:
                inertia = self._mass_factor * (eq.mass @ displacement) + self._inertia
                residual += inertia
                scale = max(scale, float(np.linalg.norm(inertia)))
            norm = float(np.linalg.norm(self._supports.free_part(residual - offset)))
        return _Point(displacement, gradient, stress, residual, norm, scale)

    def _iterate(self, start: Array, movement: Array, force: Array, offset: Array | float, tolerance: float) -> Array:
        point = self._at(start, force, offset)
        moving = bool(movement.any())
        fresh, poor = False, False
        geometric = self._stress
        for iteration in range(self._settings.max_iterations + 1):
            if not point.finite:
                raise self._error("the residual is not finite.", "diverged")
            if not moving and self._converged(point, tolerance, iteration):
                self._stress = point.stress
                return point.displacement
            if iteration == self._settings.max_iterations:
                break
            if self.tangent is None or poor:
                self.tangent = self._linearise(point, geometric)
                fresh = True
            increment = self._increment(self.tangent, point, offset, movement if moving else None)
            trial = self._at(point.displacement + increment, force, offset)
            for _ in range(0 if moving else _HALVINGS):
                if trial.finite:
                    break
                increment = 0.5 * increment
                trial = self._at(point.displacement + increment, force, offset)
            self._counts.iterations += 1
            rate = np.inf if moving or point.norm == 0.0 else trial.norm / point.norm
            if not (fresh or moving or self._equations.linear or rate < 1.0):
                poor = True  # the iterate is given up, not only the tangent
                continue
            poor = self._too_slow(rate, trial, tolerance)
            change = self._equations.gradient(increment)
            geometric = self._equations.linearised_stress(point.gradient, point.stress, change, trial.stress, geometric)
            point, moving, fresh = trial, False, False
        raise self._error(
            f"Newton's method stopped at a relative residual of {point.norm / point.scale:.2g} after "
            f"{self._settings.max_iterations} iterations; expected below {tolerance:g}. Take smaller time steps, apply "
            "the load more slowly, or refine the mesh.",
            "max_iterations",
        )

    def _converged(self, point: _Point, tolerance: float, iteration: int) -> bool:
        if point.norm <= tolerance * point.scale:
            return True
        if iteration < 2:
            return False
        size = np.abs(point.displacement)
        inertia = self._mass_factor * (self._equations.mass @ size)
        floor = self._equations.rounding(point.displacement, point.gradient)
        floor += float(np.finfo(float).eps * np.linalg.norm(inertia))
        if self.response is not None:
            floor += self.response.rounding(size)
        return point.norm <= _ROUNDING * floor

    def _too_slow(self, rate: float, point: _Point, tolerance: float) -> bool:
        """Whether the tangent at hand would need more iterations than a new one is worth."""
        if self._equations.linear or rate == 0.0 or point.norm <= tolerance * point.scale:
            return False
        if not rate < 1.0:
            return True
        return bool(np.log(tolerance * point.scale / point.norm) / np.log(rate) > _PATIENCE)

    def _linearise(self, point: _Point, geometric: Array) -> Tangent:
        K = self._equations.tangent(point.gradient, geometric, self._mass_factor, self._pressures)
        self._counts.assemblies += 1
        factor = self._system.factorise(K)
        self._counts.factorised("tangent")
        return Tangent(self._mass_factor, K, factor)

    def _increment(self, tangent: Tangent, point: _Point, offset: Array | float, movement: Array | None) -> Array:
        r = offset - point.residual
        if movement is not None:
            r -= self._equations.applied(tangent.K, movement)
            if self.response is not None:
                nodes = self.response.nodes
                r[nodes] += self.response.of(movement[nodes])
        increment = self._solved(tangent, r)
        self._counts.solves += 1
        return increment if movement is None else increment + movement

    def _solved(self, tangent: Tangent, force: Array) -> Array:
        """The increment of a tangent, and of the response of the load if it has one, for nodal forces (n, 2)."""

        def alone(r: Array) -> Array:
            return tangent.factor.solve(self._equations.shared(r)).reshape(-1, 2)

        response = self.response
        if response is None:
            return alone(force)
        made = self._responding
        if made is None or made[0].matrix is not response.matrix or made[1] is not tangent:
            C = tangent.factor.flexibility(unknowns_of(response.nodes))
            made = self._responding = response, tangent, RespondingSystem(alone, C, response)
        return made[2].solve(force)

    def _error(self, message: str, reason: str) -> NewtonError:
        return NewtonError(message, reason, f"solid, t = {self._time:g}")
