"""The fixed-point iteration of one coupled step, or of a steady state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi import case
from hofsi.clock import Clock
from hofsi.coupling.convergence import ConvergenceTest, Residuals
from hofsi.coupling.failure import coupling_failure, in_iteration, rounding_failure, solid_failure
from hofsi.coupling.interface import Interface
from hofsi.coupling.load import InterfaceLoad
from hofsi.coupling.relaxation import Accelerator
from hofsi.coupling.stall import StallWatch, Verdict
from hofsi.errors import ConvergenceError, CouplingError
from hofsi.motion import MeshState
from hofsi.records import CouplingRecord
from hofsi.solvers.fluid import FluidState
from hofsi.solvers.load_response import LoadResponse
from hofsi.solvers.solid import SolidSolver, SolidStep

Array = NDArray[np.float64]

__all__ = ["FixedPoint", "Flow", "Solution"]

_PASSES = 2  # times the most iterations of one linearisation: a step whose flow is linearised again has taken them
_DROWNED = 0.1  # of the load: with more noise than this it is none, whatever the iterations say
_STILL = 1e-12  # of the positions: where nothing goes further than that in a step, its load is rounding by right
_INNER = 1e-2  # of the coupling's tolerance: the solid's, at most, so that coupling does not stall in its noise


@dataclass
class Flow:
    """The flow around one displacement of the interface: its load, and the rest when it is asked for.

    Attributes
    ----------
    force : ndarray, shape (k, 2)
        On the solid, at the nodes of the interface.
    converged : bool
        Whether the flow itself has.
    finish : callable
        Makes the flow's state, whose load confirms ``force``, and its mesh.
    stiffness : callable
        Makes the derivative F of the force by the displacement of the interface, shape (2k, 2k), or None if the flow
        does not tell it.
    affine : bool
        Whether F holds for all displacements.
    """

    force: Array
    converged: bool
    finish: Callable[[], tuple[FluidState, MeshState]]
    stiffness: Callable[[], Array | None] = lambda: None
    affine: bool = False


@dataclass(frozen=True, eq=False)
class Solution:
    """What the last iteration left behind.

    Attributes
    ----------
    fluid : FluidState
    mesh : MeshState
    displacement : ndarray, shape (n, 2)
        Of the solid.
    record : CouplingRecord
    """

    fluid: FluidState
    mesh: MeshState
    displacement: Array
    record: CouplingRecord


class FixedPoint:
    """Iterates d ↦ d̃: displacement of the interface, flow, load, displacement of the solid; accelerated.

    Parameters
    ----------
    load : InterfaceLoad
    solid : SolidSolver
    interface : Interface
    settings : CouplingSettings
    accelerator : Accelerator
    clock : Clock

    Attributes
    ----------
    accelerator : Accelerator
    test : ConvergenceTest
    believing : bool
        Whether responses of the fluid serve; False in a step in which its fields have told another force.
    condensing : bool
        Whether the solid takes the load's answer into its solution, where the fluid tells it.
    """

    def __init__(
        self,
        load: InterfaceLoad,
        solid: SolidSolver,
        interface: Interface,
        settings: case.CouplingSettings,
        accelerator: Accelerator,
        clock: Clock,
    ) -> None:
        self._load, self._solid, self._interface = load, solid, interface
        self._settings, self._clock = settings, clock
        self.accelerator = accelerator
        self.test = ConvergenceTest(settings.tolerance, settings.force_tolerance)
        self.believing = True
        self.condensing = settings.condensed and solid.takes_response(interface.solid)

    def solve(
        self,
        d: Array,
        flow: Callable[[Array], Flow],
        solid_step: SolidStep,
        where: str,
        *,
        share: float = 1.0,
        steady: bool = False,
    ) -> Solution:
        """Iterate until displacement and force have converged.

        Parameters
        ----------
        d : ndarray, shape (k, 2)
            First displacement of the interface.
        flow : callable
            Makes the flow around a displacement of the interface.
        solid_step : SolidStep
        where : str
            For messages.
        share : float
            Of the fluid's load that acts on the solid.
        steady : bool

        Raises
        ------
        ConvergenceError
            If that does not succeed; the accelerator has forgotten everything then.
        """
        try:
            return self._solve(d, flow, solid_step, where, share, steady)
        except ConvergenceError as error:
            self.accelerator.forget()
            told = in_iteration(error, self._settings, steady=steady)
            if told is error:
                raise
            raise told from error

    def _solve(
        self,
        d: Array,
        flow: Callable[[Array], Flow],
        solid_step: SolidStep,
        where: str,
        share: float,
        steady: bool,
    ) -> Solution:
        settings = self._settings
        self.accelerator.begin_step()
        self.believing = True
        inner = min(self._solid.nonlinear.tolerance, _INNER * settings.tolerance)
        displacement: Array | None = None
        response: LoadResponse | None = None
        residuals, watch = Residuals(np.inf, np.inf), StallWatch()
        verdict: Verdict = ""
        iteration = before = 0  # with this linearisation of the flow, with those before it
        while iteration < settings.max_iterations and before < _PASSES * settings.max_iterations:
            iteration += 1
            now = flow(d)
            try:
                with self._clock.phase("solid"):
                    load = share * self._nodal(now.force)
                    response = self._response(now, d, response)
                    displacement = solid_step.solve(load, displacement, tolerance=inner, response=response)
            except ConvergenceError as error:
                together = response is not None
                raise solid_failure(error, watch, settings, where, steady=steady, together=together) from error
            image = displacement[self._interface.solid]
            residual = image - d
            if not (np.isfinite(residual).all() and np.isfinite(now.force).all()):
                raise CouplingError(f"displacement or force is not finite in iteration {iteration}.", "diverged", where)
            residuals = self.test.residuals(image, residual, now.force)
            excess = self.test.excess(residuals)
            if now.converged and excess <= 1.0:
                fluid, mesh = now.finish()
                noise = self._noise(now, response, d)
                if noise > _DROWNED and _flows(fluid, fluid.time - solid_step.state.time):
                    raise rounding_failure(noise, where)
                if self.test.confirms(now.force, self._load.evaluate(fluid)):
                    self.accelerator.end_step()
                    record = CouplingRecord(before + iteration, residuals.displacement, residuals.force)
                    return Solution(fluid, mesh, displacement, record)
                # The flow was too far from what it was linearised about, and is linearised about itself now: begin
                # again with that. If it happens twice responses are not worth it.
                self.believing = not before
                before, iteration = before + iteration, 0
                self.accelerator.end_step()  # what it has learned serves the new flow as it would a later step
                self.accelerator.begin_step()
                watch = StallWatch()
                continue
            verdict = watch.observe(image, residual, excess)
            if verdict:
                break
            if response is not None and (now.affine or iteration == 1):
                d = image
                continue
            with self._clock.phase("coupling"):
                d = self.accelerator.next(d.ravel(), residual.ravel()).reshape(-1, 2)
        noise = self._noise(now, response, d)
        if noise > settings.force_tolerance:
            raise rounding_failure(noise, where)
        together = response is not None
        raise coupling_failure(verdict, residuals, self.test, watch, settings, where, steady=steady, together=together)

    def _noise(self, flow: Flow, response: LoadResponse | None, d: Array) -> float:
        """Rounding error of the load relative to it, as far as the fluid tells how it answers to displacements.

        The fluid's load has accelerations in it, and those are differences of positions over dt².
        """
        if response is None:
            return 0.0
        places = np.abs(self._solid.mesh.points) if not flow.affine else np.zeros(self._solid.mesh.points.shape)
        places[self._interface.solid] += np.abs(d)
        size = float(np.linalg.norm(flow.force))
        return response.rounding(places) / size if size else 0.0

    def _response(self, flow: Flow, d: Array, last: LoadResponse | None) -> LoadResponse | None:
        """How the load answers while the solid finds its displacement, if the fluid tells and the solid takes it."""
        if not self.condensing:
            return None
        matrix = last.matrix if last is not None and flow.affine else flow.stiffness()
        if matrix is None and last is not None:
            matrix = last.matrix  # a flow that does not tell it answers about as the one before it
        return None if matrix is None else LoadResponse(self._interface.solid, matrix, d)

    def _nodal(self, force: Array) -> Array:
        nodal = np.zeros(self._solid.mesh.points.shape)
        nodal[self._interface.solid] = force
        return nodal


def _flows(fluid: FluidState, dt: float) -> bool:
    """Whether something goes further in a step than rounding of positions would take it."""
    return float(np.abs(fluid.velocity).max()) * dt > _STILL * float(np.abs(fluid.points[0]).max())
