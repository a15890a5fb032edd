"""A channel whose text can be changed, and the notes on it."""

from __future__ import annotations

import tomllib
from collections.abc import Callable

import pytest

from hofsi.build import build
from hofsi.io.scene import read_case
from hofsi.notes import notes

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
def channel() -> str:
    """The scene as text."""
    return CHANNEL


@pytest.fixture
def noted() -> Callable[..., tuple[str, ...]]:
    """A function that changes the scene, each old text occurring once, and returns the notes."""

    def read(*changes: tuple[str, str]) -> tuple[str, ...]:
        text = CHANNEL
        for old, new in changes:
            assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times"
            text = text.replace(old, new)
        return notes(build(read_case(tomllib.loads(text), "channel.toml")))

    return read
