"""Numbers read off finished steps: fields at points, forces, flow rates, integrals."""

from __future__ import annotations

from hofsi import case
from hofsi.build import Problem
from hofsi.errors import CaseError
from hofsi.quantities.evaluator import Evaluator, VectorEvaluator, component_of, scaled
from hofsi.quantities.force import force
from hofsi.quantities.probe import pressure_difference, probe

__all__ = ["Evaluator", "evaluators"]

_COLUMNS = ("step", "t")


def evaluators(problem: Problem) -> dict[str, Evaluator]:
    """Functions that read the quantities of a case off a step.

    A point of a solid, and a vertex given by name, move with their body or mesh. A point (x, y) of the fluid is fixed
    in space; while the mesh does not cover it, for example because a solid is there, its value is nan. The
    displacement of the fluid is that of its mesh at the point which was at (x, y).

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    dict of str to callable
        In the order of the scene.

    Raises
    ------
    CaseError
        If a point is outside the mesh, a force is asked for where no boundary is, or a name is that of another column.
    """
    for quantity in problem.case.quantities:
        if quantity.name in _COLUMNS:
            raise CaseError(f"{quantity.name!r} is a column of every table. Choose another name", quantity.place)
    forces: dict[tuple[str, ...], VectorEvaluator] = {}
    found: dict[str, Evaluator] = {}
    for quantity in problem.case.quantities:
        match quantity:
            case case.Force():
                if quantity.on not in forces:
                    forces[quantity.on] = force(problem, quantity)
                found[quantity.name] = scaled(component_of(forces[quantity.on], quantity.component), quantity.factor)
            case _:
                found[quantity.name] = _scalar(problem, quantity)
    return found


def _scalar(problem: Problem, quantity: case.ScalarQuantity) -> Evaluator:
    """Return a quantity that shares nothing with others."""
    match quantity:
        case case.Probe():
            return probe(problem, quantity)
        case case.PressureDifference():
            return pressure_difference(problem, quantity)
        case case.SolidIntegral():
            from hofsi.quantities.integral import solid_integral

            return solid_integral(problem, quantity)
        case case.TimeFunction():
            value = quantity.value
            return lambda record: float(value.evaluate(t=record.time))
        case _:
            return _of_fluid(problem, quantity)


def _of_fluid(
    problem: Problem,
    quantity: case.Moment | case.FlowRate | case.FlowBalance | case.MeanPressure | case.FluidIntegral,
) -> Evaluator:
    """Return a quantity that only a fluid has; what it needs is imported for it alone."""
    from hofsi.quantities.flow import flow_balance, flow_rate, mean_pressure
    from hofsi.quantities.integral import integral
    from hofsi.quantities.moment import moment

    match quantity:
        case case.Moment():
            return moment(problem, quantity)
        case case.FlowRate():
            return flow_rate(problem, quantity)
        case case.FlowBalance():
            return flow_balance(problem, quantity)
        case case.MeanPressure():
            return mean_pressure(problem, quantity)
        case case.FluidIntegral():
            return integral(problem, quantity)
