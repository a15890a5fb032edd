"""What counts as found."""

from __future__ import annotations

import math

import pytest

from hofsi.bench.checks import Check, Limit, judged

DRAG = Check("drag mean", -4.0, 0.01, 0.05, "a table")


@pytest.mark.parametrize(
    ("value", "passed"), [(-4.0, True), (-4.19, True), (-3.81, True), (-4.21, False), (4.0, False)]
)
def test_a_number_passes_within_its_relative_error(value: float, passed: bool) -> None:
    finding = DRAG.judge(value)
    assert finding.passed == passed
    assert finding.error == pytest.approx((value + 4.0) / 4.0)
    assert (finding.reference, finding.uncertainty, finding.source) == (-4.0, 0.01, "a table")


@pytest.mark.parametrize("value", [None, math.nan])
def test_a_number_that_is_missing_does_not_pass(value: float | None) -> None:
    assert not DRAG.judge(value).passed
    assert not Limit("iterations", "few", at_most=5.0).judge(value).passed
    assert not Limit("quality", "good", at_least=0.0).judge(value).passed


def test_limits_are_on_either_side() -> None:
    few, good = Limit("iterations", "few", at_most=5.0), Limit("quality", "good", at_least=0.3)
    assert few.judge(5.0).passed
    assert not few.judge(5.1).passed
    assert good.judge(0.3).passed
    assert not good.judge(0.29).passed
    assert few.judge(1.0).error is None


def test_every_number_that_is_asked_for_is_judged() -> None:
    found = judged([DRAG, Limit("iterations", "few", at_most=5.0)], {"drag mean": -4.0, "other": 1.0})
    assert [finding.quantity for finding in found] == ["drag mean", "iterations"]
    assert [finding.passed for finding in found] == [True, False]
