"""One condition an edge, where it can stand."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from hofsi.case import Case, Pressure
from hofsi.errors import CaseError

Read = Callable[..., Case]

TIP_PRESSURE = '[[solid.boundary]]\non = "tip"\ntype = "pressure"\nvalue = 2.0\n\n[time]'
MOTION = '[[motion]]\non = "{}"\nx = 0\ny = "0.1*sin(t)"\n\n[time]'


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        (
            '"bottom", "top"]',
            '"bottom"]',
            r"flap.toml: fluid.boundary: no condition on a2–b2, b2–c2, c2–d2; .* add a \[\[fluid.boundary\]\]",
        ),
        (
            '"bottom", "top"]',
            '"bottom", "top", "outlet"]',
            r"fluid.boundary\[2\].on: edge d0–d1 of 'outlet' has two conditions: this one and fluid.boundary\[1\]",
        ),
        (
            '"bottom", "top"]',
            '"bottom", "top", "flap"]',
            r"fluid.boundary\[1\].on: edge b0–b1 of 'flap' is shared by the fluid and solid 'rubber': it is coupled",
        ),
        (
            '"bottom", "top"]',
            '"bottom", "top", "inside"]',
            r"edge a1–b1 of 'inside' is inside the fluid; expected an outer edge of the fluid",
        ),
        (
            '"bottom", "top"]',
            '"bottom", "top", "foot"]',
            r"edge b0–c0 of 'foot' belongs to solid 'rubber' alone; expected an outer edge of the fluid",
        ),
        (
            'on = "foot"',
            'on = "tip"',
            r"solid\[0\].boundary\[0\].on: edge b1–c1 of 'tip' is shared by .* only traction and pressure",
        ),
        (
            'on = "foot"',
            'on = "inlet"',
            r"edge a0–a1 of 'inlet' belongs to the fluid alone; expected an outer edge of solid 'rubber'",
        ),
        (
            '[[solid.boundary]]\non = "foot"\ntype = "fixed"',
            "",
            r"solid\[0\].boundary: no condition on b0–c0; expected exactly one on every dry outer edge",
        ),
        (
            'inside = [["a1", "b1"]]',
            'inside = [["a1", "c1"]]',
            r"mesh.edges.inside: .* over a1–c1, which is not an edge of any block",
        ),
        (
            '"flap", "bottom"]',
            '"foot", "flap"]',
            r"quantities.lift.on: edge b0–b1 of 'flap' is at the fluid and edge b0–c0 of 'foot' at a solid alone",
        ),
        (
            '"flap", "bottom"]',
            '"flap", "inside"]',
            r"quantities.lift.on: edge a1–b1 of 'inside' is inside the fluid; .* boundary of the fluid or a solid",
        ),
        ("[time]", MOTION.format("flap"), r"motion\[0\].on: edge b0–b1 of 'flap' .* it moves with the solid"),
        ("[time]", MOTION.format("inside"), r"motion\[0\].on: edge a1–b1 of 'inside' is inside the fluid"),
        (
            "[time]",
            MOTION.format("top").replace("[time]", MOTION.format("top")),
            r"motion\[1\].on: edge a2–b2 of 'top' has two motions: this one and motion\[0\]",
        ),
    ],
)
def test_mistakes(read_changed: Read, old: str, new: str, match: str) -> None:
    with pytest.raises(CaseError, match=match):
        read_changed((old, new))


def test_one_edge_named_twice_in_one_condition(read_changed: Read) -> None:
    changes = ('inside = [["a1", "b1"]]', 'inside = [["a2", "b2"]]'), ('"bottom", "top"]', '"bottom", "top", "inside"]')
    with pytest.raises(CaseError, match=r"edge a2–b2 of 'inside' has two conditions"):
        read_changed(*changes)


def test_loads_may_be_added_to_coupled_edges(read_changed: Read) -> None:
    case = read_changed(("[time]", TIP_PRESSURE))
    assert isinstance(case.solids[0].boundaries[1], Pressure)


def test_coupled_edges_take_one_load(read_changed: Read) -> None:
    twice = TIP_PRESSURE.replace("[time]", TIP_PRESSURE)
    with pytest.raises(CaseError, match=r"solid\[0\].boundary\[2\].on: edge b1–c1 of 'tip' has two conditions"):
        read_changed(("[time]", twice))


def test_outer_edges_of_the_fluid_may_move(read_changed: Read) -> None:
    assert read_changed(("[time]", MOTION.format("top"))).motions[0].on == ("top",)


def test_motion_needs_a_fluid(read_changed: Read, solid_alone: str) -> None:
    with pytest.raises(CaseError, match=r"motion\[0\]: .* there is no \[fluid\].*\"displacement\""):
        read_changed(("[time]", MOTION.format("flap")), text=solid_alone)


@pytest.mark.parametrize("on", ["foot", "flap"])
def test_forces_may_be_those_of_a_solid(read_changed: Read, solid_alone: str, on: str) -> None:
    force = f'\n[quantities.F]\ntype = "force"\non = "{on}"\ncomponent = "x"\n'
    assert read_changed(text=solid_alone + force).quantities[0].on == (on,)


def test_dry_edges_of_a_coupled_solid_have_a_force(read_changed: Read) -> None:
    assert read_changed(('"flap", "bottom"]', '"foot"]')).quantities[1].on == ("foot",)


def test_forces_inside_a_solid_are_refused(read_changed: Read, solid_alone: str) -> None:
    halves = 'solid = [["b0", "m0", "m1", "b1"], ["m0", "c0", "c1", "m1"]]'
    changes = (
        ('solid = [["b0", "c0", "c1", "b1"]]', halves),
        ("c0 = [1.2, 0]", "c0 = [1.2, 0]\nm0 = [1.1, 0]\nm1 = [1.1, 0.5]"),
        ('flap = [["b0", "b1", "c1", "c0"]]', 'flap = [["b0", "b1", "m1", "c1", "c0"]]\nmiddle = [["m0", "m1"]]'),
        ('tip = [["b1", "c1"]]', ""),
        ('foot = [["b0", "c0"]]', 'foot = [["b0", "m0", "c0"]]'),
    )
    force = '\n[quantities.F]\ntype = "force"\non = "middle"\ncomponent = "x"\n'
    with pytest.raises(CaseError, match=r"quantities.F.on: .* is inside solid 'rubber'; .* boundary of a solid"):
        read_changed(*changes, text=solid_alone + force)
