"""A small scene with everything in it: a channel with an elastic flap on its bottom."""

from __future__ import annotations

import tomllib
from collections.abc import Callable

import pytest

from hofsi.case import Case
from hofsi.io.scene import read_case

# a2 ─── b2 ─── c2 ─── d2
# │      │      │      │
# a1 ─── b1 ─── c1 ─── d1      the flap is b0 c0 c1 b1
# │      │ flap │      │
# a0 ─── b0 ─── c0 ─── d0
FLAP = """
title = "Flap in a channel"

[constants]
U = 1.5
H = 1.0

[mesh]
order = 2

[mesh.vertices]
a0 = [0, 0]
a1 = [0, 0.5]
a2 = [0, "H"]
b0 = [1, 0]
b1 = [1, 0.5]
b2 = [1, "H"]
c0 = [1.2, 0]
c1 = [1.2, 0.5]
c2 = [1.2, "H"]
d0 = [3, 0]
d1 = [3, 0.5]
d2 = [3, "H"]

[mesh.blocks]
fluid = [
    ["a0", "b0", "b1", "a1"], ["c0", "d0", "d1", "c1"],
    ["a1", "b1", "b2", "a2"], ["b1", "c1", "c2", "b2"], ["c1", "d1", "d2", "c2"],
]
solid = [["b0", "c0", "c1", "b1"]]

[mesh.edges]
inlet = [["a0", "a1", "a2"]]
outlet = [["d0", "d1", "d2"]]
bottom = [["a0", "b0"], ["c0", "d0"]]
top = [["a2", "b2", "c2", "d2"]]
flap = [["b0", "b1", "c1", "c0"]]
tip = [["b1", "c1"]]
foot = [["b0", "c0"]]
inside = [["a1", "b1"]]

[fluid]
density = 2.0
viscosity = 0.01

[[fluid.boundary]]
on = "inlet"
type = "velocity"
x = "4*U*y*(H - y)/H**2*sin(t)"
y = 0

[[fluid.boundary]]
on = ["bottom", "top"]
type = "no-slip"

[[fluid.boundary]]
on = "outlet"
type = "do-nothing"

[[solid]]
name = "rubber"
density = 3.0
youngs_modulus = 1e3
poissons_ratio = 0.4

[[solid.boundary]]
on = "foot"
type = "fixed"

[time]
dt = 0.1
end = 2.0

[coupling]

[output]
period_of = "u_x"

[quantities.u_x]
type = "probe"
field = "displacement"
component = "x"
at = "b1"

[quantities.lift]
type = "force"
on = ["flap", "bottom"]
component = "y"
"""

FLUID_BLOCKS = FLAP[FLAP.index("fluid = [") : FLAP.index("solid = [")]
FLUID = FLAP[FLAP.index("[fluid]") : FLAP.index("[[solid]]")]
SOLID = FLAP[FLAP.index("[[solid]]") : FLAP.index("[time]")]
QUANTITIES = FLAP[FLAP.index("[output]") :]

Changes = tuple[str, str]


CHANNEL = """
[mesh]
order = 3
elements = 2

[mesh.vertices]
a = [0, 0]
b = [2, 0]
c = [2, 1]
d = [0, 1]

[mesh.blocks]
fluid = [["a", "b", "c", "d"]]

[mesh.edges]
bottom = [["a", "b"]]
right = [["b", "c"]]
top = [["c", "d"]]
left = [["d", "a"]]

[fluid]
density = 1.0
viscosity = 0.1

[[fluid.boundary]]
on = ["bottom", "top"]
type = "no-slip"

[[fluid.boundary]]
on = "left"
type = "velocity"
x = "4*y*(1 - y)"
y = 0

[[fluid.boundary]]
on = "right"
type = "do-nothing"

[time]
dt = 0.1
steps = 5
"""


@pytest.fixture
def flap() -> str:
    """The scene as text."""
    return FLAP


@pytest.fixture
def read_changed() -> Callable[..., Case]:
    """A function that reads the scene with some parts of its text exchanged, each of which must occur once."""

    def read(*changes: Changes, text: str = FLAP) -> Case:
        for old, new in changes:
            assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times"
            text = text.replace(old, new)
        return read_case(tomllib.loads(text), "flap.toml")

    return read


@pytest.fixture
def fluid_alone() -> str:
    """The channel with a rigid flap."""
    text = FLAP.replace(SOLID, "").replace(QUANTITIES, "").replace('solid = [["b0", "c0", "c1", "b1"]]', "")
    return text.replace('["bottom", "top"]', '["bottom", "top", "flap"]').replace('foot = [["b0", "c0"]]', "")


@pytest.fixture
def solid_alone() -> str:
    """The flap without a fluid."""
    text = FLAP.replace(FLUID, "").replace(QUANTITIES, "").replace(FLUID_BLOCKS, "")
    for name in ("inlet", "outlet", "bottom", "top", "inside"):
        line = text[text.index(f"\n{name} = ") + 1 :]
        text = text.replace(line[: line.index("\n") + 1], "")
    return text.replace("[time]", '[[solid.boundary]]\non = "flap"\ntype = "free"\n\n[time]')


@pytest.fixture
def channel() -> str:
    """A scene of flow through a channel, as text."""
    return CHANNEL


@pytest.fixture
def periodic_channel() -> str:
    """The channel with periodic ends and a force, as text."""
    start, end = CHANNEL.index('[[fluid.boundary]]\non = "left"'), CHANNEL.index("[time]")
    ends = '[[fluid.boundary]]\non = "left"\ntype = "periodic"\nwith = "right"\n\n'
    text = CHANNEL[:start] + ends + CHANNEL[end:]
    return text.replace("viscosity = 0.1", 'viscosity = 0.1\nbody_force = ["0.8", "0"]')
