"""What a run leaves out, and why."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from hofsi.case import Case, Steady, Unsteady
from hofsi.linear.choice import Choice
from hofsi.plan.facts import convection_of_steps, counted, has_series, is_coupled, iterates, moves
from hofsi.plan.meshes import Meshes, still_blocks
from hofsi.plan.report import Item
from hofsi.plan.sizes import linear_solvers

__all__ = ["skipped_items"]


def skipped_items(case: Case, meshes: Meshes) -> Iterator[Item]:
    """Everything that the case does not need."""
    yield from _without_material(case)
    yield from _without_bodies(case)
    yield from _without_motion(case, meshes)
    yield from _without_iteration(case, linear_solvers(case, meshes))
    yield from _without_output(case)
    yield from _unused_tables(case)


def _without_material(case: Case) -> list[Item]:
    """Block groups that belong to nothing."""
    used = {group for solid in case.solids for group in solid.blocks} | set(case.fluid.blocks if case.fluid else ())
    return [Item(f"blocks {group!r}", "no material uses them") for group in case.mesh.blocks if group not in used]


def _without_bodies(case: Case) -> Iterator[Item]:
    if case.fluid is None:
        yield Item("fluid", "no [fluid]")
    if not case.solids:
        yield Item("solid", "no [[solid]]")
    if not is_coupled(case):
        yield Item("coupling", "no solid" if case.fluid else "no fluid")


def _without_motion(case: Case, meshes: Meshes) -> Iterator[Item]:
    if case.fluid is None or meshes.fluid is None:
        return
    if moves(case):
        still, blocks = still_blocks(case, meshes), len(meshes.fluid[0].topology.quads)
        if still:
            factors = "geometry factors and matrices without convection are kept"
            yield Item("motion of blocks", f"{counted(still, 'block')} of {blocks} cannot move: {factors}")
        return
    yield Item(
        "mesh motion",
        "no boundary of the fluid moves: geometry factors are computed once, matrices without "
        f"convection {_once(case)}",
    )


def _once(case: Case) -> str:
    """How often something is done that depends on nothing but the coefficients of the time scheme."""
    several = isinstance(case.time, Unsteady) and case.time.steps > 1
    if isinstance(case.time, Unsteady) and (case.time.tolerance is not None or case.time.first is not None):
        return "for each change of the step size"
    return "twice, for the first step and the others" if several else "once"


def _without_iteration(case: Case, solvers: Mapping[str, Choice]) -> Iterator[Item]:
    fluid = case.fluid
    if fluid is not None:
        factor = "factorisation" if solvers["fluid"].solver == "direct" else "preconditioner"
        if fluid.model == "stokes":
            kept = "" if moves(case) else f", and its {factor} is kept"
            yield Item("convection", f"Stokes: the matrix does not depend on the velocity{kept}")
        elif iterates(case, fluid):
            if case.linear.lag and solvers["fluid"].solver == "direct":
                yield Item("fluid's factors", "earlier ones serve later iterations and steps while that is cheap")
        else:
            meshes = ", however many coupling iterations it takes" if _one_mesh_a_step(case) else ""
            again = convection_of_steps(case, fluid) == "linearised"
            unless = ", unless the flow changes at once, as after an impulsive start" if again else ""
            yield Item("fluid's Newton iteration", f"linear steps: one {factor} a step{meshes}{unless}")
    if all(choice.solver == "direct" for choice in solvers.values()):
        yield Item("multigrid", "LU serves" if case.linear.solver == "auto" else 'linear.solver = "direct"')
    elif is_coupled(case) and case.coupling.condensed and isinstance(case.time, Unsteady):
        yield Item("condensation", "multigrid does not tell how fluid or solid answer the other: they take iterations")
    if case.solids and all(solid.model == "linear" for solid in case.solids):
        one_step = isinstance(case.time, Unsteady) and case.time.tolerance is None and case.time.first is None
        often = "once" if case.scheme.name != "bdf2" and one_step else _once(case)  # without a first step of its own
        yield Item("solid's Newton iteration", f"linear: factorised {often}")
    if isinstance(case.time, Steady):
        yield Item("time loop", "steady: no inertia, no time steps")


def _one_mesh_a_step(case: Case) -> bool:
    return is_coupled(case) and case.coupling.geometry == "extrapolated"


def _without_output(case: Case) -> Iterator[Item]:
    if not case.quantities:
        yield Item("quantities", "no [quantities]")
    if case.output.period_of is None:
        if has_series(case):
            yield Item("period", "no output.period_of")
    elif isinstance(case.time, Steady):
        yield Item("period", "steady: output.period_of is not used")
    if not case.output.fields:
        yield Item("fields", "output.fields = false: no writer, vtk is not needed")
    if not case.output.plots:
        yield Item("plots", "output.plots = false: matplotlib is not needed")


def _unused_tables(case: Case) -> Iterator[Item]:
    """Tables that the scene has and the run does not read."""
    needless: dict[str, str] = {}
    if not is_coupled(case):
        needless["coupling"] = "there is no " + ("solid" if case.fluid else "fluid")
    if not moves(case):
        needless["mover"] = "no boundary of the fluid moves"
    if case.fluid and not case.solids and not iterates(case, case.fluid):
        needless["nonlinear"] = "the equations are linear"
    for name, reason in needless.items():
        if name in case.tables:
            yield Item(f"[{name}]", f"not used: {reason}")
