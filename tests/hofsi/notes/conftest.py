"""The notes on a channel whose text can be changed."""

from __future__ import annotations

import tomllib
from collections.abc import Callable

import pytest

from hofsi.build import build
from hofsi.io.scene import read_case
from hofsi.notes import notes


@pytest.fixture
def noted(channel: str) -> Callable[..., tuple[str, ...]]:
    """A function that changes the scene, each old text occurring once, and returns the notes."""

    def read(*changes: tuple[str, str], text: str = channel) -> tuple[str, ...]:
        for old, new in changes:
            assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times"
            text = text.replace(old, new)
        return notes(build(read_case(tomllib.loads(text), "channel.toml")))

    return read
