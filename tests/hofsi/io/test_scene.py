"""Whole scenes, read into a case."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from hoblock.errors import ExpressionError, SceneError
from hofsi.case import (
    BarrierSettings,
    Case,
    Displacement,
    DoNothing,
    Force,
    NoSlip,
    Point,
    Probe,
    Unsteady,
    Velocity,
)
from hofsi.errors import CaseError
from hofsi.io.scene import load_case, read_case

Read = Callable[..., Case]
EXAMPLES = sorted((Path(__file__).parents[3] / "examples").glob("*.toml"))


@pytest.fixture
def scene_file(tmp_path: Path, flap: str) -> Path:
    path = tmp_path / "flap.toml"
    path.write_text(flap, encoding="utf-8")
    return path


def test_a_complete_scene(scene_file: Path) -> None:
    case = load_case(scene_file)
    assert case.title == "Flap in a channel"
    assert case.file == str(scene_file)
    assert case.mesh.order == 2
    assert len(case.mesh.blocks["fluid"]) == 5
    assert case.time == Unsteady(dt=0.1, start=0.0, end=2.0, steps=20)
    assert case.mover == BarrierSettings()
    assert case.coupling.geometry == "extrapolated"
    assert case.output.period_of == "u_x"
    assert case.motions == ()
    assert case.tables == (
        "title", "constants", "mesh", "fluid", "solid", "time", "coupling", "output", "quantities",
    )  # fmt: skip


def test_the_fluid_of_a_complete_scene(scene_file: Path) -> None:
    fluid = load_case(scene_file).fluid
    assert fluid is not None
    assert (fluid.density, fluid.viscosity, fluid.model, fluid.convection) == (2.0, 0.01, "navier-stokes", "auto")
    assert fluid.blocks == ("fluid",)
    assert (fluid.body_force, fluid.initial_velocity) == (None, None)
    inlet, walls, outlet = fluid.boundaries
    assert isinstance(inlet, Velocity)
    assert inlet.x is not None
    assert inlet.x.evaluate(y=0.5, t=2.0) == pytest.approx(1.5 * 0.9092974268256817)
    assert inlet.y is not None
    assert inlet.y.is_zero
    assert walls == NoSlip(("bottom", "top"), "fluid.boundary[1]")
    assert outlet == DoNothing(("outlet",), "fluid.boundary[2]")


def test_the_solid_of_a_complete_scene(scene_file: Path) -> None:
    (solid,) = load_case(scene_file).solids
    assert (solid.name, solid.density, solid.youngs_modulus, solid.poissons_ratio) == ("rubber", 3.0, 1e3, 0.4)
    assert (solid.model, solid.plane, solid.place) == ("st-venant-kirchhoff", "strain", "solid[0]")
    (foot,) = solid.boundaries
    assert isinstance(foot, Displacement)
    assert foot.x is not None
    assert foot.y is not None
    assert foot.x.is_zero
    assert foot.y.is_zero


def test_the_quantities_of_a_complete_scene(scene_file: Path) -> None:
    assert load_case(scene_file).quantities == (
        Probe("u_x", "displacement", "x", Point(1.0, 0.5, "b1"), "solid", "quantities.u_x"),
        Force("lift", ("flap", "bottom"), "y", 1.0, "quantities.lift"),
    )


def test_overrides(scene_file: Path) -> None:
    case = load_case(scene_file, ["time.dt=0.5", "constants.U=3", "solid[0].density=7.5", "coupling.predictor=3"])
    assert case.time == Unsteady(0.5, 0.0, 2.0, 4)
    assert case.solids[0].density == 7.5
    assert case.coupling.predictor == 3
    assert case.fluid is not None
    inlet = case.fluid.boundaries[0]
    assert isinstance(inlet, Velocity)
    assert inlet.x is not None
    assert inlet.x.evaluate(y=0.5, t=1.5707963267948966) == pytest.approx(3.0)


def test_fluid_alone(read_changed: Read, fluid_alone: str) -> None:
    case = read_changed(text=fluid_alone)
    assert case.solids == ()
    assert case.quantities == ()


def test_solid_alone(read_changed: Read, solid_alone: str) -> None:
    case = read_changed(text=solid_alone)
    assert case.fluid is None
    assert len(case.solids[0].boundaries) == 2


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_can_be_read(path: Path) -> None:
    assert load_case(path).title


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("[fluid]", "[flud]\n[fluid]", r"^flap.toml: flud: unknown key. Did you mean 'fluid'\?"),
        ("[coupling]", "[couplng]", r"^flap.toml: couplng: unknown key. Did you mean 'coupling'\?"),
        ("density = 2.0", "densty = 2.0", r"fluid.density: the required key is missing. .*'densty'"),
        ("viscosity = 0.01", "viscosity = 0.01\nbody_forces = 1", r"body_forces: unknown key. Did you mean 'body_"),
        ('on = "outlet"', 'on = "outlets"', r"boundary\[2\].on: got the unknown name 'outlets'. Did you mean 'outlet'"),
        ("4*U*y", "4*V*y", r"fluid.boundary\[0\].x: .*'V'"),
        ("[mesh]\norder = 2", "[mesh]\norder = 0", r"mesh.order: got 0"),
        ("[coupling]", "[nonlinear]\ntolerances = 1", r"nonlinear.tolerances: unknown key. Did you mean 'tolerance'"),
        ("[coupling]", "coupling = 3", r"time.coupling: unknown key"),
        ('title = "Flap in a channel"', "title = 3", r"title: got the number 3"),
        ("[[solid]]", "[solid]", r"solid: got a table; expected an array of tables. Write \[\[solid\]\]"),
    ],
)
def test_mistakes(read_changed: Read, old: str, new: str, match: str) -> None:
    with pytest.raises(SceneError, match=match):
        read_changed((old, new))


def test_expressions_are_reported_as_such(read_changed: Read) -> None:
    with pytest.raises(ExpressionError, match=r"fluid.boundary\[0\].x"):
        read_changed(("4*U*y", "4*import*y"))


def test_nothing_to_simulate(flap: str, scene_file: Path) -> None:
    scene_file.write_text(flap[: flap.index("[fluid]")], encoding="utf-8")
    with pytest.raises(CaseError, match=r"flap.toml: there is nothing to simulate: neither \[fluid\] nor"):
        load_case(scene_file)


def test_time_is_needed(read_changed: Read) -> None:
    with pytest.raises(CaseError, match=r"flap.toml: time: \[time\] is missing. Add it with steady = true"):
        read_changed(("[time]\ndt = 0.1\nend = 2.0", ""))


def test_a_file_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"none.toml: no such file"):
        load_case(tmp_path / "none.toml")


def test_a_wrong_override_names_the_file(scene_file: Path) -> None:
    with pytest.raises(SceneError, match=r"flap.toml: fluid.density: got -1"):
        load_case(scene_file, ["fluid.density=-1"])


def test_data_may_come_from_elsewhere() -> None:
    with pytest.raises(SceneError, match=r"^memory: mesh: the required key is missing"):
        read_case({"fluid": {}}, "memory")


@pytest.mark.parametrize(
    ("overrides", "steps", "end"),
    [(["time.steps=3"], 3, 0.3), (["time.end=0.4"], 4, 0.4), (["time.steps=3", "time.dt=0.2"], 3, 0.6)],
)
def test_an_override_takes_the_place_of_what_excludes_it(
    scene_file: Path, overrides: list[str], steps: int, end: float
) -> None:
    time = load_case(scene_file, overrides).time
    assert isinstance(time, Unsteady)
    assert (time.steps, time.end) == (steps, pytest.approx(end))


def test_two_overrides_that_exclude_each_other_are_an_error(scene_file: Path) -> None:
    with pytest.raises(CaseError, match="both 'end' and 'steps'"):
        load_case(scene_file, ["time.steps=3", "time.end=1"])
