"""Boundary conditions of a scene."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from typing import Any

import pytest

from hoblock.errors import SceneError
from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hofsi.case import Displacement, DoNothing, Free, NoSlip, Periodic, Pressure, Roller, Slip, Traction, Velocity
from hofsi.errors import CaseError
from hofsi.io.conditions import read_fluid_condition, read_solid_condition

MESH = MeshScene(order=1, vertices={}, blocks={}, edges={"wall": (("a", "b"),), "lid": (("c", "d"),)})


def _read(reader: Callable[..., Any], text: str) -> Any:
    table = Table(tomllib.loads('on = "wall"\n' + text), "boundary[3]")
    return reader(table, MESH, {"U": 2.0})


def fluid(text: str) -> Any:
    return _read(read_fluid_condition, text)


def solid(text: str) -> Any:
    return _read(read_solid_condition, text)


@pytest.mark.parametrize(
    ("name", "kind"), [("no-slip", NoSlip), ("slip", Slip), ("symmetry", Slip), ("do-nothing", DoNothing)]
)
def test_fluid_conditions_without_values(name: str, kind: type) -> None:
    assert fluid(f'type = "{name}"') == kind(("wall",), "boundary[3]")


@pytest.mark.parametrize("kind", ['"do-nothing"', '"pressure"\nvalue = 2', '"traction"\nx = 1'])
def test_open_boundaries_may_be_stabilised_against_backflow(kind: str) -> None:
    assert fluid(f"type = {kind}").backflow == 0.0
    assert fluid(f"type = {kind}\nbackflow = 0.5").backflow == 0.5
    with pytest.raises(SceneError, match=r"backflow: got -1"):
        fluid(f"type = {kind}\nbackflow = -1")
    with pytest.raises(SceneError, match=r"backflow: unknown key"):
        fluid('type = "no-slip"\nbackflow = 1')


@pytest.mark.parametrize(("name", "kind"), [("roller", Roller), ("symmetry", Roller), ("free", Free)])
def test_solid_conditions_without_values(name: str, kind: type) -> None:
    assert solid(f'type = "{name}"') == kind(("wall",), "boundary[3]")


def test_periodic_sides() -> None:
    assert fluid('type = "periodic"\nwith = "lid"') == Periodic(("wall", "lid"), ("wall",), ("lid",), "boundary[3]")
    assert Periodic.between(("a", "b"), ("c",)).on == ("a", "b", "c")


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ('type = "periodic"', r"boundary\[3\].with: "),
        ('type = "periodic"\nwith = "lit"', r"boundary\[3\].with: got the unknown name 'lit'. Did you mean 'lid'"),
        ('type = "periodic"\nwith = ["lid", "wall"]', r"boundary\[3\].with: 'wall' is on the other side already"),
        ('type = "periodic"\nwith = "lid"\nx = 1', r"boundary\[3\].x: unknown key"),
        ('type = "no-slip"\nwith = "lid"', r"boundary\[3\].with: unknown key"),
    ],
)
def test_periodic_sides_that_are_not_two(text: str, match: str) -> None:
    with pytest.raises(SceneError, match=match):
        fluid(text)


def test_velocity() -> None:
    condition = fluid('type = "velocity"\nx = "U*y*t"\ny = 0.5')
    assert isinstance(condition, Velocity)
    assert condition.x is not None
    assert condition.x.evaluate(y=3.0, t=0.5) == 3.0
    assert condition.y is not None
    assert condition.y.value == 0.5
    assert (condition.traction_x, condition.traction_y) == (None, None)


def test_a_velocity_component_may_be_free() -> None:
    condition = fluid('type = "velocity"\ny = 0\ntraction_x = "-U"')
    assert condition.x is None
    assert condition.traction_x.value == -2.0
    assert condition.traction_y is None


def test_displacement() -> None:
    condition = solid('type = "displacement"\nx = "U*t"')
    assert isinstance(condition, Displacement)
    assert condition.x is not None
    assert condition.x.evaluate(t=0.25) == 0.5
    assert condition.y is None


def test_fixed_is_a_displacement_of_zero() -> None:
    condition = solid('type = "fixed"')
    assert isinstance(condition, Displacement)
    assert condition.x is not None
    assert condition.y is not None
    assert condition.x.is_zero
    assert condition.y.is_zero


@pytest.mark.parametrize("read", [fluid, solid])
def test_traction_and_pressure(read: Callable[[str], Any]) -> None:
    traction = read('type = "traction"\ny = "x"')
    assert isinstance(traction, Traction)
    assert traction.x.is_zero
    assert traction.y.evaluate(x=[1.0, 2.0]).tolist() == [1.0, 2.0]
    pressure = read('type = "pressure"\nvalue = "U*t"')
    assert isinstance(pressure, Pressure)
    assert pressure.value.evaluate(t=2.0) == 4.0


@pytest.mark.parametrize("read", [fluid, solid])
def test_several_names(read: Callable[[str], Any]) -> None:
    reader = read_fluid_condition if read is fluid else read_solid_condition
    table = Table({"on": ["wall", "lid"], "type": "pressure", "value": 1}, "b")
    assert reader(table, MESH, {}).on == ("wall", "lid")


@pytest.mark.parametrize(
    ("read", "text", "match"),
    [
        (fluid, 'type = "noslip"', r"boundary\[3\].type: got 'noslip'. Did you mean 'no-slip'\?"),
        (fluid, 'type = "fixed"', r"boundary\[3\].type: got 'fixed'"),
        (solid, 'type = "clamped"', r"boundary\[3\].type: got 'clamped'"),
        (fluid, "", r"boundary\[3\].type: the required key is missing"),
        (fluid, 'type = "no-slip"\nx = 0', r"boundary\[3\].x: unknown key"),
        (fluid, 'type = "pressure"\nx = 0', r"boundary\[3\].value: the required key is missing"),
        (solid, 'type = "pressure"\nvalue = "z"', r"boundary\[3\].value: .*'z'"),
        (solid, 'type = "free"\nvalue = 1', r"boundary\[3\].value: unknown key"),
        (solid, 'type = "displacement"\nx = [1]', r"boundary\[3\].x: got a list of 1"),
    ],
)
def test_mistakes(read: Callable[[str], Any], text: str, match: str) -> None:
    with pytest.raises(SceneError, match=match):
        read(text)


@pytest.mark.parametrize(
    ("read", "text", "match"),
    [
        (fluid, 'type = "velocity"', r"boundary\[3\]: neither x nor y is given; .* use \"traction\" or \"do-nothing\""),
        (fluid, 'type = "traction"', r"boundary\[3\]: neither x nor y is given; .* write x = 0"),
        (solid, 'type = "displacement"', r"boundary\[3\]: neither x nor y is given; .* use \"free\""),
        (
            fluid,
            'type = "velocity"\nx = 1\ntraction_x = 1',
            r"boundary\[3\].traction_x: the velocity component 'x' is given too",
        ),
    ],
)
def test_keys_that_do_not_go_together(read: Callable[[str], Any], text: str, match: str) -> None:
    with pytest.raises(CaseError, match=match):
        read(text)


def test_unknown_edges() -> None:
    table = Table({"on": ["wall", "Lid"], "type": "no-slip"}, "fluid.boundary[0]")
    with pytest.raises(CaseError, match=r"fluid.boundary\[0\].on: got the unknown name 'Lid'. Did you mean 'lid'\?"):
        read_fluid_condition(table, MESH, {})
