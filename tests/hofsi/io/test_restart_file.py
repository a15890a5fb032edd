"""Restart files: what a solver has in memory goes through them to the bit; what is no such file is told."""

from __future__ import annotations

import itertools
import json
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from hofsi.build import Problem, build
from hofsi.case import Case
from hofsi.errors import RestartError
from hofsi.io.restart_file import read_restart, write_restart
from hofsi.io.scene import read_case
from hofsi.motion import MeshState
from hofsi.records import StepRecord
from hofsi.simulate import simulate

Changes = tuple[tuple[str, str], ...]

NEWTON = ("viscosity = 0.1", 'viscosity = 0.1\nconvection = "newton"')
GROWING = ('"4*y*(1 - y)"', '"4*y*(1 - y)*(1 + t)"')
AMG = ("[time]", '[linear]\nsolver = "amg"\n\n[time]')
FINE = ("elements = 2", "elements = 4")
BOTH_WALLS = 'on = ["bottom", "top"]\ntype = "no-slip"'
SLIP = (BOTH_WALLS, 'on = "bottom"\ntype = "no-slip"\n\n[[fluid.boundary]]\non = "top"\ntype = "slip"')
FLOW = (
    'on = "left"\ntype = "velocity"\nx = "4*y*(1 - y)"',
    'on = ["left", "right"]\ntype = "velocity"\nx = "4*y*(1 - y)"',
)
ENCLOSED = (FLOW, ('[[fluid.boundary]]\non = "right"\ntype = "do-nothing"\n', ""))
MOVING = ("[time]", '[[motion]]\non = "bottom"\nx = 0\ny = "0.1*sin(pi*x/2)*sin(4*t)"\n\n[time]')
LOADED = 'on = "tip"\ntype = "pressure"\nvalue = "3*t"\n\n[[solid.boundary]]\non = "foot"\ntype = "fixed"'

CHANNELS: dict[str, Changes] = {
    "one linearisation a step": (),
    "factors of earlier steps": (NEWTON, GROWING),
    "Picard's iteration": (("viscosity = 0.1", 'viscosity = 0.1\nconvection = "picard"'), GROWING),
    "Stokes flow": (("viscosity = 0.1", 'viscosity = 0.1\nmodel = "stokes"'), GROWING),
    "an enclosed flow": (*ENCLOSED, NEWTON),
    "a mesh that moves": (MOVING, NEWTON),
    "a mesh that moves along slip walls": (SLIP, MOVING, NEWTON),
    "an old preconditioner": (AMG, FINE, GROWING),
    "an old preconditioner of Stokes flow": (AMG, FINE, ("viscosity = 0.1", 'viscosity = 0.1\nmodel = "stokes"')),
    "an old preconditioner in Newton's method": (AMG, FINE, NEWTON, GROWING),
}
FLAPS: dict[str, Changes] = {
    "secants of earlier steps": (),
    "Aitken's factor": (("[coupling]", '[coupling]\nacceleration = "aitken"\nrelaxation = 0.9'),),
    "a constant factor": (("[coupling]", '[coupling]\nacceleration = "constant"\nrelaxation = 0.3'),),
    "a mesh in every iteration": (("[coupling]", '[coupling]\ngeometry = "implicit"'),),
    "a solid with generalised-alpha": (("end = 2.0", 'end = 2.0\nsolid = "generalised-alpha"'),),
    "a solid with energy-momentum": (("end = 2.0", 'end = 2.0\nsolid = "energy-momentum"'),),
    "the tangent of a linear solid": (
        ("youngs_modulus = 1e3", 'youngs_modulus = 1e3\nmodel = "linear"'),
        ('on = "foot"\ntype = "fixed"', LOADED),
    ),
    "a mover that depends on the state": (("[coupling]", '[mover]\ntype = "pseudo-solid"\nincremental = true'),),
    "a solid by multigrid": (("[coupling]", '[linear]\nsolver = "amg"\n\n[coupling]'),),
    "steps chosen by their error": (("end = 2.0", "end = 2.0\ntolerance = 1e-3"),),
}


def case_of(text: str, changes: Changes) -> Case:
    for old, new in changes:
        assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times"
        text = text.replace(old, new)
    return read_case(tomllib.loads(text), "scene.toml")


def leaves(value: object, name: str = "") -> Iterator[tuple[str, object]]:
    """All numbers in a record, arrays as bytes."""
    if isinstance(value, np.ndarray):
        yield name, value.tobytes()
    elif isinstance(value, MeshState):
        yield from leaves((value.mesh.points, value.vertices, value.positions, value.min_det_J, value.substeps), name)
    elif is_dataclass(value):
        for field in fields(value):
            yield from leaves(getattr(value, field.name), f"{name}.{field.name}")
    elif isinstance(value, tuple | list):
        for k, item in enumerate(value):
            yield from leaves(item, f"{name}[{k}]")
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, f"{name}[{key}]")
    else:
        yield name, value


def steps_of(problem: Problem, count: int, after: StepRecord | None = None) -> list[StepRecord]:
    return list(itertools.islice(simulate(problem, after), count))


def through_file(record: StepRecord, problem: Problem, other: Problem, path: Path) -> StepRecord:
    write_restart(path, problem, record, {})
    return read_restart(path).content(other)[0]


def check_resumed(case: Case, path: Path, before: int, count: int) -> None:
    """Going on from a file, in another problem, is the same to the bit as going on: states, memories and counts."""
    problem, other = build(case), build(case)
    steps = steps_of(problem, before)
    start = through_file(steps[-1], problem, other, path)
    assert dict(leaves(start)) == dict(leaves(steps[-1]))
    whole = steps_of(build(case), before + count)[before:]
    resumed = steps_of(other, count, start)
    assert len(whole) == len(resumed) == count
    for one, two in zip(whole, resumed, strict=True):
        expected, found = dict(leaves(one)), dict(leaves(two))
        assert [name for name in expected.keys() | found.keys() if expected.get(name) != found.get(name)] == []


@pytest.mark.parametrize("name", CHANNELS)
def test_fluids_go_on_to_the_bit(channel: str, tmp_path: Path, name: str) -> None:
    if "preconditioner" in name:
        pytest.importorskip("pyamg")
    check_resumed(case_of(channel, CHANNELS[name]), tmp_path / "restart.npz", 2, 3)


@pytest.mark.parametrize("name", FLAPS)
def test_coupled_problems_go_on_to_the_bit(flap: str, tmp_path: Path, name: str) -> None:
    if "multigrid" in name:
        pytest.importorskip("pyamg")
    before = 8 if "error" in name else 3
    check_resumed(case_of(flap, FLAPS[name]), tmp_path / "restart.npz", before, 3)


@pytest.mark.parametrize("scheme", ["bdf2", "generalised-alpha", "energy-momentum"])
@pytest.mark.parametrize("model", ["st-venant-kirchhoff", "neo-hooke", "linear"])
def test_solids_go_on_to_the_bit(
    read_changed: Callable[..., Case], solid_alone: str, tmp_path: Path, scheme: str, model: str
) -> None:
    used = [line for line in solid_alone.splitlines() if line[:4] not in ("a0 =", "a1 =", "a2 =", "b2 =", "c2 =")]
    text = "\n".join(line for line in used if line[:4] not in ("d0 =", "d1 =", "d2 ="))
    case = read_changed(
        ("dt = 0.1\nend = 2.0", f'dt = 0.02\nend = 2.0\nsolid = "{scheme}"'),
        ("youngs_modulus = 1e3", f'youngs_modulus = 1e3\nmodel = "{model}"\ninitial_velocity = ["y", "0"]'),
        text=text,
    )
    check_resumed(case, tmp_path / "restart.npz", 3, 3)


@pytest.mark.parametrize(
    "name", ["factors of earlier steps", "an enclosed flow", "Stokes flow", "an old preconditioner"]
)
def test_a_problem_can_go_back_to_an_earlier_step(channel: str, name: str) -> None:
    if "preconditioner" in name:
        pytest.importorskip("pyamg")
    problem = build(case_of(channel, CHANNELS[name]))
    whole = steps_of(problem, 4)
    for one, two in zip(whole[1:], steps_of(problem, 3, whole[0]), strict=True):
        assert dict(leaves(one)) == dict(leaves(two))


@pytest.mark.parametrize("name", ["factors of earlier steps", "an old preconditioner"])
def test_without_what_factors_were_made_from_the_rounding_is_another(channel: str, name: str) -> None:
    """Which is why it is in the file: results would depend on where a run was broken off, if only a little."""
    if "preconditioner" in name:
        pytest.importorskip("pyamg")
    case = case_of(channel, CHANNELS[name])
    start = steps_of(build(case), 2)[-1]
    assert start.memory is not None
    poorer = replace(start, memory=replace(start.memory, march=start.memory.march.without_factors()))
    one, two = (steps_of(build(case), 1, record)[-1].state.fluid for record in (start, poorer))
    assert one is not None
    assert two is not None
    assert not np.array_equal(one.velocity, two.velocity)
    np.testing.assert_allclose(one.velocity, two.velocity, atol=1e-8)


@pytest.mark.parametrize("solvers", [("direct", "amg"), ("amg", "direct")])
def test_another_machine_may_choose_another_solver(channel: str, tmp_path: Path, solvers: tuple[str, str]) -> None:
    """By linear.solver = "auto", which looks at the memory."""
    pytest.importorskip("pyamg")
    one, other = (
        build(case_of(channel, (FINE, NEWTON, GROWING, ("[time]", f'[linear]\nsolver = "{name}"\n\n[time]'))))
        for name in solvers
    )
    steps = steps_of(one, 4)
    start = through_file(steps[1], one, other, tmp_path / "restart.npz")
    last = steps_of(other, 2, start)[-1].state.fluid
    assert last is not None
    assert steps[-1].state.fluid is not None
    np.testing.assert_allclose(last.velocity, steps[-1].state.fluid.velocity, atol=1e-8)


@pytest.fixture
def written(flap: str, tmp_path: Path) -> Path:
    """A restart file of the flap after two steps."""
    problem = build(case_of(flap, ()))
    write_restart(tmp_path / "restart.npz", problem, steps_of(problem, 2)[-1], {"table": {"size": 3}})
    return tmp_path / "restart.npz"


def test_what_observers_know_is_in_the_file(written: Path, flap: str) -> None:
    file = read_restart(written)
    assert file.values["time.dt"] == "0.1"
    assert {"numpy", "scipy", "hoblock", "hofsi"} <= set(file.versions)
    record, observers = file.content(build(case_of(flap, ())))
    assert (record.step, observers) == (2, {"table": {"size": 3}})
    assert [path.name for path in written.parent.iterdir()] == ["restart.npz"]


def test_nothing_in_a_file_is_pickled(written: Path) -> None:
    with np.load(written, allow_pickle=False) as archive:
        assert {archive[name].dtype.kind for name in archive.files} <= set("fiu")


def test_an_array_that_is_shared_is_written_once_and_shared_again(written: Path, flap: str) -> None:
    record, _ = read_restart(written).content(build(case_of(flap, ())))
    assert record.state.fluid is not None
    assert record.state.mesh is not None
    assert record.state.fluid.points[0] is record.state.mesh.mesh.points
    with np.load(written) as archive:
        points = record.state.mesh.mesh.points
        same = [name for name in archive.files if np.array_equal(archive[name], points)]
    assert len(same) == 1


def damaged(path: Path, place: float) -> None:
    data = bytearray(path.read_bytes())
    start = int(place * len(data))
    data[start : start + 200] = bytes(255 - byte for byte in data[start : start + 200])
    path.write_bytes(data)


@pytest.mark.parametrize("place", [0.0, 0.3, 0.6, 0.9, 0.95, 0.98])
def test_a_damaged_file(written: Path, place: float) -> None:
    damaged(written, place)
    with pytest.raises(RestartError, match=r"restart\.npz: is not a restart file of hofsi, or is damaged"):
        read_restart(written)


@pytest.mark.parametrize("content", [b"", b"step,t\n1,0.1\n", b"PK\x03\x04"])
def test_another_file(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "restart.npz"
    path.write_bytes(content)
    with pytest.raises(RestartError, match="is not a restart file of hofsi"):
        read_restart(path)


def test_another_archive(tmp_path: Path) -> None:
    np.savez(tmp_path / "mesh.npz", points=np.zeros((3, 2)))
    with pytest.raises(RestartError, match="Take another one"):
        read_restart(tmp_path / "mesh.npz")


def test_half_a_file(written: Path) -> None:
    written.write_bytes(written.read_bytes()[: written.stat().st_size // 2])
    with pytest.raises(RestartError, match="damaged"):
        read_restart(written)


def rewritten(path: Path, part: str, **changes: object) -> None:
    """Change entries of the JSON text in a file."""
    with np.load(path) as archive:
        arrays = dict(archive)
    text = json.dumps({**json.loads(arrays[part].tobytes()), **changes})
    arrays[part] = np.frombuffer(text.encode(), dtype=np.uint8)
    with path.open("wb") as file:
        np.savez(file, **arrays)


def test_a_file_of_a_later_version(written: Path) -> None:
    rewritten(written, "head", format=2, versions={"hofsi": "9.1"})
    with pytest.raises(RestartError, match=r"has the format 2, written by hofsi 9\.1; expected format 1"):
        read_restart(written)


def test_contents_that_are_not_a_run(written: Path, flap: str) -> None:
    rewritten(written, "content", record={"kind": "Popen", "fields": {"args": "true"}})
    with pytest.raises(RestartError, match=r"its contents are not those of a run \(KeyError: 'Popen'\)"):
        read_restart(written).content(build(case_of(flap, ())))


def test_no_file(tmp_path: Path) -> None:
    with pytest.raises(RestartError, match="there is no restart file; expected one that a run wrote"):
        read_restart(tmp_path / "restart.npz")
