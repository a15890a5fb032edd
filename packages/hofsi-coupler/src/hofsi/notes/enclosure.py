"""Enclosed fluids: the level of their pressure, and whether what is given around them balances."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hofsi.build import FluidPart, Problem
from hofsi.case import Steady

__all__ = ["enclosure"]

_ROUNDING = 1e-9  # net flow, as a part of ∮ |u|, that is not worth a word


def enclosure(problem: Problem, fluid: FluidPart, time: float) -> Iterator[str]:
    """Say which pressure an enclosed fluid has, and what a net flow into it becomes.

    Raises
    ------
    CaseError
        If nothing moves and the velocities do not balance, or nothing holds a steady flow between periodic sides.
    """
    solver, points = fluid.solver, fluid.mesh.points
    regions = solver.enclosed(points)
    if not regions:
        return
    if isinstance(problem.case.time, Steady):
        regions.expect_held()
    number = "The fluid is" if len(regions) == 1 else f"{len(regions)} parts of the fluid are"
    around = "given velocities or periodic sides" if solver.periodic else "given velocities"
    yield (
        f"{number} enclosed by {around}: the pressure is determined but for a constant; the one with the mean "
        "0 is taken"
    )
    if problem.case.motions or problem.solid is not None:
        return
    still, nobody = np.zeros(points.shape), np.zeros((len(solver.boundary.interface), 2))
    velocity = solver.boundary.impose(still, points, still, nobody, time)
    flux = solver.pressure_work(points)
    regions.balance(np.zeros(solver.space.dofs.shape), velocity, solver.geometry(points), flux)
    for net, gross in regions.net_flows(velocity, flux):
        if abs(net) > _ROUNDING * gross:
            yield (
                f"The velocities around the enclosed fluid let out {net:.4g} per unit time more than they bring in at "
                f"t = {time:g} ({100.0 * abs(net) / gross:.2g} % of ∮ |u|): an evenly spread source makes up for it. "
                "Correct the given velocities if that is not due to the mesh"
            )
