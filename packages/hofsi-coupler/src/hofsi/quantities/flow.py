"""Flow rates through edges, their balance, and mean pressures."""

from __future__ import annotations

from hofsi import case
from hofsi.build import Problem
from hofsi.errors import CaseError
from hofsi.quantities.body import fluid_of, fluid_state
from hofsi.quantities.evaluator import Evaluator
from hofsi.records import StepRecord
from hofsi.solvers.fluid_flow import BoundaryFlow

__all__ = ["flow_balance", "flow_rate", "mean_pressure"]


def flow_rate(problem: Problem, asked: case.FlowRate) -> Evaluator:
    """Return the flow out of the fluid through edges.

    Raises
    ------
    CaseError
        If there is no fluid or the edges are not at its boundary.
    """
    flow = _boundary_flow(problem, asked)
    return lambda record: flow.rate(fluid_state(record), relative=asked.relative)


def mean_pressure(problem: Problem, asked: case.MeanPressure) -> Evaluator:
    """Return the mean pressure on edges; errors as `flow_rate`."""
    flow = _boundary_flow(problem, asked)
    return lambda record: flow.mean_pressure(fluid_state(record))


def flow_balance(problem: Problem, asked: case.FlowBalance) -> Evaluator:
    """Return the net flow out of the fluid over what flows in, moving boundaries included; 0 where nothing flows.

    Raises
    ------
    CaseError
        If there is no fluid.
    """
    flow = BoundaryFlow(fluid_of(problem, asked.place).solver)

    def evaluate(record: StepRecord) -> float:
        state = fluid_state(record)
        inflow = flow.inflow(state)
        return flow.rate(state) / inflow if inflow else 0.0

    return evaluate


def _boundary_flow(problem: Problem, asked: case.FlowRate | case.MeanPressure) -> BoundaryFlow:
    try:
        return BoundaryFlow(fluid_of(problem, asked.place).solver, asked.on)
    except CaseError as error:
        raise CaseError(error.problem, error.place if error.place == asked.place else f"{asked.place}.on") from error
