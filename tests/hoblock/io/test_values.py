"""Words for places, values and limits."""

from __future__ import annotations

import datetime

import pytest

from hoblock.errors import SceneError
from hoblock.io.values import Limits, describe, number_of, place_of


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (True, "the boolean true"),
        (False, "the boolean false"),
        ("heavy", "the text 'heavy'"),
        (3, "the number 3"),
        (0.25, "the number 0.25"),
        ([], "an empty list"),
        ([1, 2], "a list of 2"),
        ({}, "a table"),
        (datetime.date(2024, 5, 6), "a date (2024-05-06)"),
        ("a" * 100, "the text '" + "a" * 57 + "...'"),
    ],
)
def test_values_in_words(value, words):
    assert describe(value) == words


@pytest.mark.parametrize(
    ("place", "key", "expected"),
    [("", "mesh", "mesh"), ("mesh", "c-1_X", "mesh.c-1_X"), ("mesh", "a b", 'mesh."a b"'), ("", 'q"', '"q\\""')],
)
def test_places(place, key, expected):
    assert place_of(place, key) == expected


@pytest.mark.parametrize(
    ("limits", "inside", "outside", "words"),
    [
        (Limits(minimum=0.0), 0.0, -1e-9, "of at least 0"),
        (Limits(maximum=1.0), 1.0, 1.1, "of at most 1"),
        (Limits(above=0.0), 1e-300, 0.0, "above 0"),
        (Limits(below=0.5), 0.4999, 0.5, "below 0.5"),
        (Limits(minimum=0.0, below=0.5), 0.0, 0.5, "of at least 0 and below 0.5"),
    ],
)
def test_limits(limits, inside, outside, words):
    assert number_of(inside, "a", limits) == inside
    with pytest.raises(SceneError, match=f"^a: got {outside!r}; expected a number {words}$"):
        number_of(outside, "a", limits)
