"""Whether a case can be simulated at all."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import pytest

from hofsi.case import Case, Steady
from hofsi.case_checks import check_case
from hofsi.errors import CaseError

Read = Callable[..., Case]

STEADY = (("dt = 0.1\nend = 2.0", "steady = true"), ("*sin(t)", ""))


def test_nothing_to_simulate(read_changed: Read) -> None:
    case = dataclasses.replace(read_changed(), fluid=None, solids=())
    with pytest.raises(CaseError, match=r"nothing to simulate: neither \[fluid\] nor \[\[solid\]\]"):
        check_case(case)


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        (
            'name = "rubber"',
            'name = "rubber"\nblocks = ["fluid"]',
            r"solid\[0\].blocks: the block group 'fluid' is used by fluid already",
        ),
        (
            "[time]",
            '[[solid]]\nname = "rubber"\nblocks = "more"\ndensity = 1\nyoungs_modulus = 1\npoissons_ratio = 0\n[time]',
            r"solid\[1\].name: 'rubber' is the name of solid\[0\] already",
        ),
    ],
)
def test_materials(read_changed: Read, old: str, new: str, match: str) -> None:
    more = ("solid = [[", 'more = [["b0", "b1", "c1", "c0"]]\nsolid = [[') if "more" in new else ("H = 1.0", "H = 1")
    with pytest.raises(CaseError, match=match):
        read_changed((old, new), more)


@pytest.mark.parametrize(
    "closed",
    [
        'type = "no-slip"',
        'type = "slip"',
        'type = "velocity"\nx = "U"\ny = 0',
    ],
)
def test_enclosed_fluid_cannot_be_coupled(read_changed: Read, closed: str) -> None:
    with pytest.raises(CaseError, match=r"fluid.boundary: the fluid is enclosed .* at b0–b1, b1–c1, c0–c1: .* Open"):
        read_changed(('type = "do-nothing"', closed))


def test_enclosed_fluid_may_be_coupled_at_rest(read_changed: Read) -> None:
    case = read_changed(('type = "do-nothing"', 'type = "no-slip"'), *STEADY)
    assert case.fluid is not None
    assert case.solids


@pytest.mark.parametrize(
    "opened",
    [
        'type = "traction"\nx = 0',
        'type = "pressure"\nvalue = "0.1*t"',
        'type = "velocity"\ny = 0',
    ],
)
def test_an_opening_makes_coupling_possible(read_changed: Read, opened: str) -> None:
    read_changed(('type = "do-nothing"', opened))


def test_every_part_of_the_fluid_needs_an_opening(read_changed: Read) -> None:
    """Without the blocks above the flap the inlet's part has walls and the solid only."""
    gone = '    ["a1", "b1", "b2", "a2"], ["b1", "c1", "c2", "b2"], ["c1", "d1", "d2", "c2"],\n'
    changes = (
        (gone, ""),
        ('inlet = [["a0", "a1", "a2"]]', 'inlet = [["a0", "a1"]]'),
        ('outlet = [["d0", "d1", "d2"]]', 'outlet = [["d0", "d1"]]'),
        ('top = [["a2", "b2", "c2", "d2"]]', 'top = [["a1", "b1"], ["c1", "d1"]]'),
        ('type = "fixed"', 'type = "fixed"\n[[solid.boundary]]\non = "tip"\ntype = "free"'),
        ('"flap", "bottom"]', '"bottom"]'),
        ('inside = [["a1", "b1"]]', ""),
    )
    with pytest.raises(CaseError, match=r"the solid at b0–b1: "):
        read_changed(*changes)
    read_changed(*changes, ('on = "inlet"\ntype = "velocity"', 'on = "inlet"\ntype = "traction"'))


def test_a_fluid_alone_may_be_enclosed(read_changed: Read, fluid_alone: str) -> None:
    case = read_changed(('type = "do-nothing"', 'type = "no-slip"'), text=fluid_alone)
    assert case.fluid is not None
    assert case.solids == ()


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        (STEADY[:1], r"fluid.boundary\[0\].x: \"4\*U.*\" depends on t, and the case is steady"),
        (
            (*STEADY, ("viscosity = 0.01", 'viscosity = 0.01\nbody_force = [0, "t"]')),
            r"fluid.body_force\[1\]: \"t\" depends on t",
        ),
        (
            (*STEADY, ("[time]", '[[motion]]\non = "top"\nx = 0\ny = "0.1*t"\n[time]')),
            r"motion\[0\].y: \"0.1\*t\" depends on t",
        ),
        (
            (*STEADY, ("[time]", '[[solid.boundary]]\non = "tip"\ntype = "traction"\nx = "sin(t)"\n[time]')),
            r"solid\[0\].boundary\[1\].x: \"sin\(t\)\" depends on t",
        ),
        (
            (*STEADY, ("[time]", '[[solid.boundary]]\non = "tip"\ntype = "pressure"\nvalue = "t"\n[time]')),
            r"solid\[0\].boundary\[1\].value: \"t\" depends on t",
        ),
        (
            (*STEADY, ("viscosity = 0.01", 'viscosity = 0.01\nconvection = "extrapolated"')),
            r"fluid.convection: a steady flow has no earlier steps",
        ),
        (
            (*STEADY, ("[coupling]", '[coupling]\ngeometry = "extrapolated"')),
            r"coupling.geometry: a steady state has no earlier steps .* expected \"implicit\"",
        ),
        (
            (*STEADY, ('type = "fixed"', 'type = "free"')),
            r"solid\[0\].boundary: solid 'rubber' is floating: .* type = \"fixed\"",
        ),
    ],
)
def test_steady(read_changed: Read, changes: tuple[tuple[str, str], ...], match: str) -> None:
    with pytest.raises(CaseError, match=match):
        read_changed(*changes)


@pytest.mark.parametrize("held", ['"roller"', '"symmetry"', '"displacement"\ny = 0'])
def test_steady_solid_is_held(read_changed: Read, held: str) -> None:
    case = read_changed(*STEADY, ('"fixed"', held))
    assert case.time == Steady()
    assert case.coupling.geometry == "implicit"


def test_steady_motion_without_time(read_changed: Read) -> None:
    case = read_changed(*STEADY, ("[time]", '[[motion]]\non = "top"\nx = 0\ny = "0.1*x"\n[time]'))
    assert len(case.motions) == 1


def test_a_moving_solid_may_float(read_changed: Read) -> None:
    read_changed(('type = "fixed"', 'type = "free"'))


def test_solids_hold_each_other(read_changed: Read, solid_alone: str) -> None:
    second = (
        '[[solid]]\nname = "cap"\nblocks = "cap"\ndensity = 1\nyoungs_modulus = 1\npoissons_ratio = 0\n'
        '[[solid.boundary]]\non = "cap"\ntype = "free"\n[time]\nsteady = true'
    )
    edges = 'sides = [["b0", "b1"], ["c0", "c1"]]\ncap = [["c1", "c2", "b2", "b1"]]'
    text = solid_alone.replace('tip = [["b1", "c1"]]', edges)
    text = text.replace('on = "flap"', 'on = "sides"').replace("[time]\ndt = 0.1\nend = 2.0", second)
    text = text.replace("solid = [[", 'cap = [["b1", "c1", "c2", "b2"]]\nsolid = [[')
    assert [solid.name for solid in read_changed(text=text).solids] == ["rubber", "cap"]
    with pytest.raises(CaseError, match=r"solid 'rubber' is floating"):
        read_changed(('type = "fixed"', 'type = "free"'), text=text)


@pytest.mark.parametrize(
    ("quantity", "match"),
    [
        ('type = "probe"\nfield = "velocity"\ncomponent = "x"\nat = "b1"', r"quantities.q: .* Set of = \"solid\""),
        ('type = "probe"\nfield = "pressure"\nat = "b1"', r"quantities.q: it is of the fluid, .* Remove the quantity"),
        ('type = "pressure-difference"\nfrom = "b1"\nto = [1, 0]', r"quantities.q: it is of the fluid"),
    ],
)
def test_quantities_of_a_missing_fluid(read_changed: Read, solid_alone: str, quantity: str, match: str) -> None:
    with pytest.raises(CaseError, match=match):
        read_changed(text=solid_alone + f"\n[quantities.q]\n{quantity}\n")


def test_quantities_of_a_missing_solid(read_changed: Read, fluid_alone: str) -> None:
    probe = '\n[quantities.q]\ntype = "probe"\nfield = "displacement"\ncomponent = "x"\nat = "b1"\n'
    with pytest.raises(CaseError, match=r"quantities.q: a probe of the solid, and there is no \[\[solid\]\]"):
        read_changed(text=fluid_alone + probe)


def test_blocks_without_a_material_are_left_out(read_changed: Read, flap: str) -> None:
    """The flap alone, in the mesh of the channel."""
    changes = (
        (flap[flap.index("[fluid]") : flap.index("[[solid]]")], ""),
        (flap[flap.index("[output]") :], ""),
        ("[time]", '[[solid.boundary]]\non = "flap"\ntype = "free"\n\n[time]'),
    )
    case = read_changed(*changes)
    assert case.fluid is None
    assert {"fluid", "solid"} <= set(case.mesh.blocks)
    wrong = (*changes[:2], ("[time]", '[[solid.boundary]]\non = ["flap", "inlet"]\ntype = "free"\n\n[time]'))
    with pytest.raises(CaseError, match=r"solid\[0\].boundary\[1\].on: .* is not an edge of a block with a material"):
        read_changed(*wrong)
