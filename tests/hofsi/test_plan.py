"""Plans: their numbers are those of the problem that is built, and their promises hold in the run."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

from hoblock.errors import TopologyError
from hoblock.movers._roles import VertexRoles
from hofsi.build import Problem, build
from hofsi.case import Case
from hofsi.errors import CaseError
from hofsi.io.scene import load_case
from hofsi.plan import Item, Plan, plan
from hofsi.simulate import simulate

Read = Callable[..., Case]
EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))
SHORT = ("dt = 0.1\nend = 2.0", "dt = 0.1\nsteps = 3")


@pytest.fixture
def solid_alone(solid_alone: str) -> str:
    """The flap alone, without the vertices of the channel."""
    return re.sub(r"^[ad]\d = .*\n|^[bc]2 = .*\n", "", solid_alone, flags=re.MULTILINE)


def _built(of: Plan, name: str) -> str:
    return next(item.detail for item in of.built if item.name == name)


def _skipped(of: Plan, name: str) -> str:
    return next(item.detail for item in of.skipped if item.name == name)


def _names(items: tuple[Item, ...]) -> list[str]:
    return [item.name for item in items]


def _number(text: str, before: str) -> int:
    found = re.search(rf"(\d+) {before}", text)
    assert found is not None, f"no number before {before!r} in {text!r}"
    return int(found[1])


def _run(case: Case) -> Problem:
    problem = build(case)
    for _ in simulate(problem):
        pass
    return problem


def _counts_of_last_step(case: Case) -> dict[str, int]:
    """What the fluid did in the last step: the first ones, from rest, may need more than the others."""
    problem = build(case)
    counts = [asdict(problem.counts["fluid"]) for _ in simulate(problem)]
    return {name: count - counts[-2][name] for name, count in counts[-1].items() if isinstance(count, int)}


@pytest.mark.parametrize("order", [2, 3, 5])
def test_sizes_are_those_of_the_problem(read_changed: Read, order: int) -> None:
    case = read_changed(("order = 2", f"order = {order}\nelements = 2"))
    planned, problem = plan(case), build(case)
    assert problem.fluid is not None
    assert problem.solid is not None
    assert problem.interface is not None
    space = problem.fluid.solver.space
    fluid, mesh = _built(planned, "fluid"), _built(planned, "fluid mesh")
    assert _number(mesh, "blocks") == 5
    assert _number(mesh, "elements") == len(problem.fluid.mesh.cells) == 20
    assert _number(mesh, "nodes") == len(problem.fluid.mesh.points)
    assert _number(fluid, "unknowns of velocity") == 2 * space.velocity_count
    assert _number(fluid, "of pressure") == space.pressure_count
    condensed = _number(_built(planned, "fluid's linear solver"), "unknowns after static")
    assert condensed == len(np.unique(space.dofs[:, : space.boundary]))
    equations = problem.solid.solver.equations
    assert _number(_built(planned, "solid"), "unknowns") == 2 * len(problem.solid.mesh.points)
    condensed = _number(_built(planned, "solid"), "after static")
    assert condensed == len(np.unique(equations.dofs[:, : equations.boundary]))
    assert _number(_built(planned, "interface"), "nodes") == len(problem.interface.fluid)
    assert _number(_built(planned, "interface"), "block edges") == len(problem.interface.fluid_edges)


def test_the_mover_has_as_many_vertices(read_changed: Read) -> None:
    motion = '[[motion]]\non = "bottom"\nx = 0\ny = 0\n\n[time]'
    case = read_changed(("[time]", motion))
    structure = build(case).fluid.structure  # type: ignore[union-attr]
    driven = np.unique([structure.topology.vertex(name) for name in ("a0", "b0", "b1", "c0", "c1", "d0")])
    mover = _built(plan(case), "mover")
    assert _number(mover, "driven") == len(driven)
    assert _number(mover, "free") == len(VertexRoles.of(structure, driven).free)


@pytest.mark.parametrize("scene", EXAMPLES, ids=lambda path: path.stem)
def test_free_vertices_of_the_examples(scene: Path) -> None:
    case = load_case(scene)
    planned = plan(case)
    if case.fluid is None or not (case.solids or case.motions):
        assert "mover" not in _names(planned.built)
        return
    problem = build(case)
    assert problem.fluid is not None
    march = problem.march
    driven = march._motion.driven.vertices  # type: ignore[attr-defined]
    assert _number(_built(planned, "mover"), "driven") == len(driven)
    assert _number(_built(planned, "mover"), "free") == len(VertexRoles.of(problem.fluid.structure, driven).free)


@pytest.mark.parametrize("geometry", ["extrapolated", "implicit"])
@pytest.mark.parametrize("convection", [None, "newton", "picard", "linearised", "extrapolated"])
def test_promised_iterations_of_a_coupled_run(read_changed: Read, convection: str | None, geometry: str) -> None:
    given = "" if convection is None else f'\nconvection = "{convection}"'
    case = read_changed(
        ("viscosity = 0.01", f"viscosity = 0.1{given}"),
        ("[coupling]", f'[coupling]\ngeometry = "{geometry}"'),
        ("dt = 0.1\nend = 2.0", "dt = 0.1\nsteps = 6"),
    )
    planned, counts = plan(case), _counts_of_last_step(case)
    linear = "fluid's Newton iteration" in _names(planned.skipped)
    assert linear == (counts["iterations"] == 0)
    one_mesh = _built(planned, "geometry").endswith("one fluid mesh a step")
    assert one_mesh == (counts["geometries"] == 1)
    assert ("one factorisation a step, however many" in " ".join(planned.lines())) == (linear and one_mesh)
    assert counts["factorisations"] == 1 or not (linear and one_mesh)


@pytest.mark.parametrize(("convection", "linear"), [("", True), ('convection = "newton"', False)])
def test_promises_for_a_fluid_at_rest(read_changed: Read, fluid_alone: str, convection: str, linear: bool) -> None:
    case = read_changed(("viscosity = 0.01", f"viscosity = 0.01\n{convection}"), SHORT, text=fluid_alone)
    planned, counts = plan(case), _run(case).counts["fluid"]
    assert ("fluid's Newton iteration" in _names(planned.skipped)) == linear
    # The start is impulsive: the first steps of a linear run go on with Newton's method.
    assert counts.solves - counts.iterations == (3 if linear else 0)
    assert counts.reasons.get("linear step", 0) == (3 if linear else 0)
    assert counts.iterations <= 2 if linear else counts.iterations > 3
    reason = _skipped(planned, "mesh motion")
    assert "geometry factors are computed once" in reason
    assert counts.geometries == 1
    assert "without convection twice" in reason
    assert counts.constant_assemblies == 2


def test_promises_for_stokes_flow(read_changed: Read, fluid_alone: str) -> None:
    case = read_changed(("viscosity = 0.01", 'viscosity = 0.01\nmodel = "stokes"'), SHORT, text=fluid_alone)
    planned, counts = plan(case), _run(case).counts["fluid"]
    assert "its factorisation is kept" in _skipped(planned, "convection")
    assert "convection" not in _names(planned.built)
    assert counts.factorisations == counts.constant_assemblies == 2


def test_promises_for_a_linear_solid(read_changed: Read, solid_alone: str) -> None:
    case = read_changed(
        ("poissons_ratio = 0.4", 'poissons_ratio = 0.4\nmodel = "linear"\ngravity = [0, -1]'), SHORT, text=solid_alone
    )
    planned, counts = plan(case), _run(case).counts["solid"]
    reason = _skipped(planned, "solid's Newton iteration")
    assert reason == "linear: factorised twice, for the first step and the others"
    assert counts.factorisations == 2


def test_a_fluid_alone(read_changed: Read, fluid_alone: str) -> None:
    planned = plan(read_changed(text=fluid_alone))
    assert {"solid", "coupling", "mesh motion", "quantities"} <= set(_names(planned.skipped))
    assert {"solid mesh", "interface", "mover"}.isdisjoint(_names(planned.built))
    assert _skipped(planned, "coupling") == "no solid"


def test_a_solid_alone(read_changed: Read, solid_alone: str) -> None:
    planned = plan(read_changed(text=solid_alone))
    assert {"fluid", "coupling"} <= set(_names(planned.skipped))
    assert _skipped(planned, "coupling") == "no fluid"
    assert "density ratio" not in _built(planned, "solid 'rubber'")


def test_a_steady_case_has_no_time_loop(read_changed: Read) -> None:
    case = read_changed(("dt = 0.1\nend = 2.0", "steady = true"), ("*sin(t)", ""))
    planned = plan(case)
    assert _skipped(planned, "time loop") == "steady: no inertia, no time steps"
    assert "not used" in _skipped(planned, "period")
    assert "every coupling iteration" in _built(planned, "geometry")
    assert "Newton" in _built(planned, "convection")


def test_the_density_ratio(read_changed: Read) -> None:
    assert _built(plan(read_changed()), "solid 'rubber'").endswith("density ratio solid/fluid 1.5")


def test_tables_that_nothing_reads(read_changed: Read, fluid_alone: str, solid_alone: str) -> None:
    more = ("[coupling]", "[coupling]\ntolerance = 1e-3\n\n[mover]\n\n[linear]\n\n[nonlinear]")

    def unused(case: Case) -> list[str]:
        return [name for name in _names(plan(case).skipped) if name.startswith("[")]

    assert unused(read_changed(more)) == []
    assert unused(read_changed(more, text=fluid_alone)) == ["[coupling]", "[mover]", "[nonlinear]"]
    assert unused(read_changed(more, text=solid_alone)) == ["[coupling]", "[mover]"]
    newton = ("viscosity = 0.01", 'viscosity = 0.01\nconvection = "newton"')
    assert unused(read_changed(more, newton, text=fluid_alone)) == ["[coupling]", "[mover]"]


@pytest.mark.parametrize(("every", "times"), [(1, "20 times"), (7, "3 times"), (10, "2 times"), (30, "1 time")])
def test_times_of_fields(read_changed: Read, every: int, times: str) -> None:
    case = read_changed(("[output]", f"[output]\nevery = {every}"))
    assert _built(plan(case), "fields").endswith(f" {times}")


def test_restart_files_are_told(read_changed: Read) -> None:
    assert "restart file" not in _names(plan(read_changed()).built)
    case = read_changed(("[output]", "[output]\ncheckpoint_every = 5"))
    assert _built(plan(case), "restart file") == "every 5 steps and at the end"


@pytest.mark.parametrize(("solver", "name"), [("direct", "sparse LU"), ("amg", "algebraic multigrid to")])
def test_linear_solver_of_solids(read_changed: Read, solid_alone: str, solver: str, name: str) -> None:
    planned = plan(read_changed(("[coupling]", f'[linear]\nsolver = "{solver}"'), text=solid_alone))
    assert f"after static condensation, {name}" in _built(planned, "solid")
    assert ("multigrid" in _names(planned.skipped)) == (solver == "direct")


def test_who_is_solved_together_with_whom(read_changed: Read) -> None:
    """Direct factors tell how the fluid answers, multigrid does not."""
    direct = plan(read_changed())
    assert "solid solved together" in _built(direct, "condensation")
    pytest.importorskip("pyamg")
    multigrid = plan(read_changed(("[coupling]", '[linear]\nsolver = "amg"\n[coupling]')))
    assert "condensation" not in _names(multigrid.built)
    assert "take iterations" in _skipped(multigrid, "condensation")


def test_linear_solver_is_chosen_with_a_reason(
    read_changed: Read, fluid_alone: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyamg")
    small = plan(read_changed(text=fluid_alone))
    assert "faster than multigrid" in _built(small, "fluid's linear solver")
    assert _skipped(small, "multigrid") == "LU serves"
    monkeypatch.setattr("hofsi.linear.choice.machine_memory", lambda: 2**14)
    large = plan(read_changed(text=fluid_alone))
    assert _built(large, "fluid's linear solver").startswith("FGMRES with multigrid on nested meshes")
    assert "would need about" in _built(large, "fluid's linear solver")
    assert "multigrid" not in _names(large.skipped)


def test_output_that_is_not_wanted(read_changed: Read) -> None:
    planned = plan(read_changed(("[output]", "[output]\nfields = false\nplots = false")))
    assert "vtk is not needed" in _skipped(planned, "fields")
    assert "matplotlib is not needed" in _skipped(planned, "plots")
    assert {"fields", "plots"}.isdisjoint(_names(planned.built))


def test_lines_have_one_column_of_names(read_changed: Read) -> None:
    planned = plan(read_changed())
    lines = planned.lines()
    assert lines[0] == "built:"
    assert lines.index("skipped:") == len(planned.built) + 1
    items = [line for line in lines if line.startswith("  ")]
    width = max(len(item.name) for item in (*planned.built, *planned.skipped))
    assert [line[2 : 2 + width].rstrip() for line in items] == _names(planned.built) + _names(planned.skipped)
    assert all(line[2 + width : 4 + width] == "  " and line[4 + width] != " " for line in items)


def test_an_invalid_element_is_found(read_changed: Read) -> None:
    curve = '[[mesh.curve]]\non = [["a0", "b0"]]\nkind = "parametric"\nx = "s"\ny = "1.2*s*(1 - s)*4"\n\n[fluid]'
    with pytest.raises(CaseError, match=r"mesh: .*a0"):
        plan(read_changed(("[fluid]\n", f"{curve}\n")))


def test_counts_that_contradict_each_other_are_found(read_changed: Read) -> None:
    counts = '[[mesh.count]]\non = [["a0", "a1"]]\nelements = 2\n\n[[mesh.count]]\non = [["b0", "b1"]]\nelements = 3\n'
    with pytest.raises(TopologyError, match=r"mesh.count\[1\]"):
        plan(read_changed(("[fluid]\n", f"{counts}\n[fluid]\n")))


def test_a_fluid_needs_second_order(read_changed: Read) -> None:
    with pytest.raises(CaseError, match=r"mesh.order: got 1; Taylor–Hood"):
        read_changed(("order = 2", "order = 1"))


def test_nothing_heavy_is_imported(tmp_path: Path, flap: str) -> None:
    scene = tmp_path / "flap.toml"
    scene.write_text(flap, encoding="utf-8")
    code = (
        "import sys\nfrom hofsi.io.scene import load_case\nfrom hofsi.plan import plan\nplan(load_case(sys.argv[1]))\n"
        "print(*sorted({name.partition('.')[0] for name in sys.modules}))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(scene)],
        check=True,
        capture_output=True,
        text=True,
        env={"PYTHONPATH": ":".join(path for path in sys.path if path)},
    )
    assert {"scipy", "vtkmodules", "matplotlib", "pyamg", "meshio"}.isdisjoint(done.stdout.split())


def test_the_plan_says_that_periodic_sides_need_a_direct_solver(read_changed: Read, periodic_channel: str) -> None:
    planned = plan(read_changed(text=periodic_channel))
    assert _built(planned, "fluid's linear solver").endswith("; there is no multigrid for periodic sides")


def test_a_solid_alone_is_not_said_to_take_backward_differences_if_it_does_not(
    read_changed: Callable[..., Case], solid_alone: str
) -> None:
    items = {}
    for scheme in ("bdf2", "energy-momentum"):
        found = plan(read_changed(("[time]", f'[time]\nsolid = "{scheme}"'), text=solid_alone))
        items[scheme] = {item.name: item.detail for item in found.built}
    assert "backward differences" in items["bdf2"]["time"]
    assert "backward differences" not in items["energy-momentum"]["time"]
    assert "midpoint rule" in items["energy-momentum"]["solid in time"]


def test_blocks_that_cannot_move_keep_their_matrices() -> None:
    rule = 'mover={type="rule", vertex=[{names=["r1t"], x=0, y="0.5*dy_T5"}]}'
    case = load_case(EXAMPLES[0].parent / "fsi3.toml", [rule, "mesh.order=2", "time.end=0.008"])
    found = re.match(r"(\d+) blocks of (\d+) cannot move: ", _skipped(plan(case), "motion of blocks"))
    assert found is not None
    still, blocks = map(int, found.groups())
    assert 0 < still < blocks == 52
    problem = _run(case)
    assert problem.fluid is not None
    topology = problem.fluid.structure.topology
    flag = [topology.vertex(f"{side}{k}") for side in "TB" for k in range(6)]
    standing = ~np.isin(topology.quads, [*flag, topology.vertex("r1t")]).any(axis=1)
    assert still <= standing.sum()  # some of these have an edge that may bend
    elements = topology.counts[topology.block_edges].reshape(blocks, -1)[:, :2].prod(axis=1)
    # Four steps; the second has another formula than the first, and all matrices are new.
    assert 2 * np.sort(elements)[:still].sum() <= problem.counts["fluid"].elements_kept <= 2 * elements[standing].sum()


def test_all_blocks_of_the_examples_move() -> None:
    assert "motion of blocks" not in _names(plan(load_case(EXAMPLES[0].parent / "fsi3.toml")).skipped)


@pytest.mark.parametrize("lag", [True, False])
def test_earlier_factors_serve_a_nonlinear_fluid(read_changed: Read, fluid_alone: str, lag: bool) -> None:
    newton = ("viscosity = 0.01", 'viscosity = 0.01\nconvection = "newton"')
    case = read_changed(newton, ("[coupling]", f"[linear]\nlag = {lag}".lower()), SHORT, text=fluid_alone)
    counts = _run(case).counts["fluid"]
    assert ("fluid's factors" in _names(plan(case).skipped)) == lag
    assert (counts.factorisations < counts.iterations) == lag
