"""Suggestions for misspelt names."""

from __future__ import annotations

import pytest

from hoblock.spelling import did_you_mean, listing, suggestion


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("vicosity", "Did you mean 'viscosity'? "),
        ("Viscosity", "Did you mean 'viscosity'? "),
        ("no_slip", "Did you mean 'no-slip'? "),
        ("qqq", ""),
        ("", ""),
    ],
)
def test_suggestions(name, expected):
    assert suggestion(name, ["density", "viscosity", "no-slip"]) == expected


def test_listing():
    assert listing(["a", "b"]) == "'a', 'b'"
    assert listing([]) == "none"


def test_did_you_mean():
    assert did_you_mean("wall_3", ["wall_1", "wall_2", "inlet"]) == "; did you mean 'wall_2' or 'wall_1'?"
    assert did_you_mean("zzz", ["a", "b"]) == "; known names: a, b."
    assert did_you_mean("zzz", [f"v{k}" for k in range(20)]).endswith("v11, ….")
