"""What a run does step by step, and what it writes."""

from __future__ import annotations

from collections.abc import Iterator

from hofsi.case import Case, Steady, Unsteady
from hofsi.plan.facts import counted, has_series
from hofsi.plan.report import Item

__all__ = ["output_items", "time_items"]


def time_items(case: Case) -> Iterator[Item]:
    """The steps."""
    if isinstance(case.time, Unsteady):
        time = case.time
        last = time.step(time.steps)[1]
        shorter = "" if last == time.dt else f", the last of {last:g},"
        scheme = ""
        if case.fluid is not None or case.scheme.name == "bdf2":
            order = "first order" if time.steps == 1 else "second order (the first step: of first)"
            scheme = f", backward differences of {order}"
        steps = f"{counted(time.steps, 'step')} of {time.dt:g}{shorter} from {time.start:g} to {time.end:g}"
        yield Item("time", steps + scheme)
        if time.halvings:
            yield Item("smaller steps", _divisions(time))
    else:
        yield Item("time", "steady")


def _divisions(time: Unsteady) -> str:
    smallest = f"down to {time.dt / 2**time.halvings:.3g}"
    if time.tolerance is None:
        first = "" if time.first is None else f"the first of at most {time.first:g}; "
        return f"{first}halved where a step fails, {smallest}"
    return (
        f"the first of at most {time.first:g}; halved where the local error of a step is more than {time.tolerance:g} "
        f"of the largest velocity or displacement, or a step fails, {smallest}"
    )


def output_items(case: Case) -> Iterator[Item]:
    """Quantities, fields and plots."""
    output = case.output
    if case.quantities:
        yield Item("quantities", ", ".join(quantity.name for quantity in case.quantities))
    if output.period_of is not None and isinstance(case.time, Unsteady):
        yield Item("period", f"of {output.period_of}")
    if output.fields:
        files = " and ".join(name for name, body in (("fluid.pvd", case.fluid), ("solid.pvd", case.solids)) if body)
        if isinstance(case.time, Steady):
            yield Item("fields", f"{files} of the steady state")
        else:
            times = counted(-(-case.time.steps // output.every), "time")
            yield Item("fields", f"{files} every {counted(output.every, 'step')} and at the end: {times}")
    if output.energy and isinstance(case.time, Unsteady):
        yield Item("energy", "balanced in every step, in steps.csv")
    if output.checkpoint_every is not None and isinstance(case.time, Unsteady):
        yield Item("restart file", f"every {counted(output.checkpoint_every, 'step')} and at the end")
    if output.plots:
        yield Item("plots", "PNG of mesh" + (", fields and quantities" if has_series(case) else " and fields"))
