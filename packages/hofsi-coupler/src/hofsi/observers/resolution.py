"""Elements that are too coarse for the flow in them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from hofsi.build import FluidPart
from hofsi.records import StepRecord
from hofsi.solvers.fluid_resolution import flow_resolution

__all__ = ["FlowResolutionWatch"]

_CONVECTED = 2.0  # Péclet number from which convection decides in an element
_ROUGH = 0.08  # of the largest velocity in an element's highest polynomials; resolved flows have less than 0.005


class FlowResolutionWatch:
    """Keeps the worst resolved element of a run, and warns once if it is too coarse.

    Too coarse is an element where convection dominates diffusion between its nodes and whose highest polynomials hold
    much of the velocity; see `hofsi.solvers.fluid_resolution`. A large Péclet number alone does no harm where the flow
    is smooth.

    Parameters
    ----------
    fluid : FluidPart
    warn : callable
        Takes the warning.
    every : int
        Steps between evaluations; the last step is always evaluated. The first ones are not, they may be impulsive.
    """

    def __init__(self, fluid: FluidPart, warn: Callable[[str], None], every: int = 10) -> None:
        self._fluid, self._warn, self._every = fluid, warn, every
        self._waiting: StepRecord | None = None
        self._worst: dict[str, float | int] = {}
        self._largest = (0.0, 0.0)
        self._warned = False

    def observe(self, record: StepRecord) -> None:
        """Evaluate a step if it is time to."""
        if record.step % self._every:
            self._waiting = record
        else:
            self._evaluate(record)

    def close(self) -> None:
        """Evaluate the last step."""
        if self._waiting is not None:
            self._evaluate(self._waiting)

    def memory(self) -> dict[str, Any]:
        """What was found so far, and whether the last step is still to be evaluated."""
        return {
            "waiting": self._waiting is not None,
            "worst": self._worst,
            "largest": self._largest,
            "warned": self._warned,
        }

    def recall(self, memory: Mapping[str, Any], record: StepRecord) -> None:
        """Go on from what was found."""
        self._waiting = record if memory["waiting"] else None
        self._worst, self._largest, self._warned = dict(memory["worst"]), memory["largest"], memory["warned"]

    def summary(self) -> dict[str, float | int]:
        """The largest Péclet number, and the element with the roughest flow where convection dominates, if any."""
        if not self._largest[0]:
            return {}
        return {"peclet_max": self._largest[0], "t_peclet_max": self._largest[1], **self._worst}

    def _evaluate(self, record: StepRecord) -> None:
        self._waiting = None
        state = record.state.fluid
        if state is None:
            return
        found = flow_resolution(self._fluid.solver, state)
        self._largest = max(self._largest, (float(found.peclet.max()), record.time))
        convected = np.where(found.peclet > _CONVECTED, found.roughness, 0.0)
        element = int(np.argmax(convected))
        if convected[element] > self._worst.get("roughness", 0.0):
            x, y = state.points[0][self._fluid.mesh.cells[element]].mean(axis=0)
            self._worst = {
                "roughness": float(convected[element]),
                "t_roughness": record.time,
                "element": element,
                "x": float(x),
                "y": float(y),
                "peclet": float(found.peclet[element]),
            }
            if convected[element] > _ROUGH and not self._warned:
                self._warned = True
                self._warn(self._message(element, int((convected > _ROUGH).sum())))

    def _message(self, element: int, count: int) -> str:
        mesh, worst = self._fluid.mesh, self._worst
        groups = [name for name, members in mesh.cell_groups.items() if element in members]
        inside = f" in blocks.{groups[0]}" if groups else ""
        plain = not self._fluid.solver.fluid.skew_symmetric
        way_out = ', or convection_form = "skew-symmetric" if the flow gains energy or diverges' if plain else ""
        number = "1 element is" if count == 1 else f"{count} elements are"
        return (
            f"fluid, t = {worst['t_roughness']:g}: {number} too coarse for this Reynolds number. Worst: element "
            f"{element}{inside} at ({worst['x']:.4g}, {worst['y']:.4g}) with the Péclet number {worst['peclet']:.3g} "
            f"(ρ |u - w| h/(2 μ p)), where {100.0 * worst['roughness']:.2g} % of the largest velocity is in the "
            "highest polynomials; a resolved flow has less than 0.5 %. Take more elements there, a higher order or a "
            f"lower Reynolds number{way_out}; do not trust forces from this mesh"
        )
