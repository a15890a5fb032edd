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


def test_energies_of_a_solid_need_no_fluid(read_changed: Read, solid_alone: str, fluid_alone: str) -> None:
    energies = "".join(
        f'\n[quantities.{name}]\ntype = "{kind}"{of}\n'
        for name, kind, of in (("k", "kinetic-energy", '\nof = "solid"'), ("s", "strain-energy", ""))
    )
    assert [quantity.name for quantity in read_changed(text=solid_alone + energies).quantities] == ["k", "s"]
    with pytest.raises(CaseError, match=r"quantities.k: an energy of the solid, and there is no \[\[solid\]\]"):
        read_changed(text=fluid_alone + energies)


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


PERIODIC = (
    'on = "inlet"\ntype = "velocity"\nx = "4*U*y*(H - y)/H**2*sin(t)"\ny = 0',
    'on = "inlet"\ntype = "periodic"\nwith = "outlet"',
)
ONE_END = ('[[fluid.boundary]]\non = "outlet"\ntype = "do-nothing"', "")


def test_a_fluid_between_periodic_sides_and_walls_is_enclosed(read_changed: Read, fluid_alone: str) -> None:
    with pytest.raises(CaseError, match=r"fluid.boundary: the fluid is enclosed .* at b0–b1, b1–c1, c0–c1: "):
        read_changed(PERIODIC, ONE_END)
    opened = '[[fluid.boundary]]\non = "top"\ntype = "do-nothing"'
    read_changed(PERIODIC, (ONE_END[0], opened), ('"bottom", "top"]', '"bottom"]'))
    read_changed(PERIODIC, ONE_END, text=fluid_alone)


def test_an_opening_beyond_a_periodic_side_serves_too(read_changed: Read) -> None:
    """Without the blocks above the flap its two sides hang together by the periodic one alone."""
    gone = '    ["a1", "b1", "b2", "a2"], ["b1", "c1", "c2", "b2"], ["c1", "d1", "d2", "c2"],\n'
    changes = (
        (gone, ""),
        ('inlet = [["a0", "a1", "a2"]]', 'inlet = [["a0", "a1"]]'),
        ('outlet = [["d0", "d1", "d2"]]', 'outlet = [["d0", "d1"]]'),
        ('top = [["a2", "b2", "c2", "d2"]]', 'top = [["a1", "b1"]]'),
        ('inside = [["a1", "b1"]]', 'inside = [["c1", "d1"]]'),
        ('type = "fixed"', 'type = "fixed"\n[[solid.boundary]]\non = "tip"\ntype = "free"'),
        ('"flap", "bottom"]', '"bottom"]'),
        PERIODIC,
    )
    lid = '[[fluid.boundary]]\non = "inside"\ntype = "{}"'
    read_changed(*changes, (ONE_END[0], lid.format("do-nothing")))
    with pytest.raises(CaseError, match=r"the solid at b0–b1, c0–c1: "):
        read_changed(*changes, (ONE_END[0], lid.format("no-slip")))


def test_periodic_sides_do_not_hold_a_steady_flow(read_changed: Read, channel: str) -> None:
    torus = channel[: channel.index("[[fluid.boundary]]")]
    for first, second in (("left", "right"), ("bottom", "top")):
        torus += f'[[fluid.boundary]]\non = "{first}"\ntype = "periodic"\nwith = "{second}"\n'
    with pytest.raises(CaseError, match=r"no condition gives a velocity, only periodic sides, tractions or pressures"):
        read_changed(text=torus + "[time]\nsteady = true\n")
    read_changed(text=torus + "[time]\ndt = 0.1\nsteps = 1\n")


def test_a_wall_holds_what_hangs_together_with_it_by_periodic_sides(read_changed: Read, channel: str) -> None:
    case = read_changed(
        ('fluid = [["a", "b", "c", "d"]]', 'fluid = [["a", "b", "c", "d"], ["e", "f", "g", "h"]]'),
        ("d = [0, 1]", "d = [0, 1]\ne = [5, 0]\nf = [6, 0]\ng = [6, 1]\nh = [5, 1]"),
        (
            'left = [["d", "a"]]',
            'left = [["d", "a"]]\nwest = [["h", "e"]]\neast = [["f", "g"]]\nopen = [["e", "f"], ["g", "h"]]',
        ),
        ('on = "left"\ntype = "velocity"\nx = "4*y*(1 - y)"\ny = 0', 'on = "left"\ntype = "periodic"\nwith = "east"'),
        ('on = "right"\ntype = "do-nothing"', 'on = "right"\ntype = "periodic"\nwith = "west"'),
        ("dt = 0.1\nsteps = 5", "steady = true"),
        ("[time]", '[[fluid.boundary]]\non = "open"\ntype = "do-nothing"\n[time]'),
        text=channel,
    )
    assert case.fluid is not None
    assert case.fluid.periodic


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (
            ("[time]", '[linear]\nsolver = "amg"\n[time]'),
            r'linear.solver: there is no multigrid for periodic sides, as those of fluid.boundary\[1\]; expected "au',
        ),
        (
            ("[time]", '[[motion]]\non = "top"\nx = 0\ny = 0\n[mover]\nsliding = "right"\n[time]'),
            r"mover.sliding: edge b–c of 'right' is periodic \('right' of fluid.boundary\[1\]\): its vertices",
        ),
        (
            ('with = "right"', 'with = "top"'),
            r"fluid.boundary\[1\].on: edge c–d of 'top' has two conditions: this one and fluid.boundary\[0\]",
        ),
    ],
)
def test_what_periodic_sides_cannot_have(
    read_changed: Read, periodic_channel: str, change: tuple[str, str], match: str
) -> None:
    with pytest.raises(CaseError, match=match):
        read_changed(change, text=periodic_channel)


def test_a_coupled_edge_cannot_be_periodic(read_changed: Read) -> None:
    wet = 'on = "inlet"\ntype = "periodic"\nwith = ["outlet", "flap"]'
    with pytest.raises(CaseError, match=r"fluid.boundary\[0\].on: edge b0–b1 of 'flap' is shared .*: it is coupled"):
        read_changed((PERIODIC[0], wet), ONE_END)


def test_a_scheme_for_solids_needs_a_solid(read_changed: Callable[..., Case], fluid_alone: str) -> None:
    with pytest.raises(CaseError, match=r"time\.solid: there is no \[\[solid\]\]"):
        read_changed(("[time]", '[time]\nsolid = "generalised-alpha"'), text=fluid_alone)
