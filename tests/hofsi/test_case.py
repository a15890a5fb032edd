"""Plain data of a case."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import pytest

from hofsi import case as module
from hofsi.case import (
    AngleOptimisationSettings,
    BarrierSettings,
    Case,
    CouplingSettings,
    LinearSettings,
    NonlinearSettings,
    OutputSettings,
    Point,
    PseudoSolidSettings,
)


def test_all_classes_are_frozen() -> None:
    classes = [cls for name in module.__all__ if isinstance(cls := getattr(module, name), type)]
    assert len(classes) > 20
    for cls in classes:
        assert dataclasses.is_dataclass(cls), cls
        assert cls.__dataclass_params__.frozen, cls  # type: ignore[attr-defined]


def test_defaults_are_those_of_the_scene_format() -> None:
    coupling = ("iqn-ils", "extrapolated", 2, 1e-6, 1e-4, 50, 10, 1e-3, 0.5, True)
    assert dataclasses.astuple(CouplingSettings()) == coupling
    assert dataclasses.astuple(NonlinearSettings()) == (1e-10, 25)
    assert dataclasses.astuple(LinearSettings()) == ("auto", 1e-10, True)
    assert dataclasses.astuple(OutputSettings()) == (True, 10, True, None, None, False)
    assert dataclasses.astuple(BarrierSettings()) == ((), "auto", 4, "bar", 1.0, 1.0, 0.1)
    assert dataclasses.astuple(PseudoSolidSettings()) == ((), "auto", 4, -1.0, 0.3, False)
    assert AngleOptimisationSettings().power == 2
    assert AngleOptimisationSettings().upper is None


def test_a_case_is_changed_by_replacing(read_changed: Callable[..., Case]) -> None:
    case = read_changed()
    coarse = dataclasses.replace(case, coupling=dataclasses.replace(case.coupling, tolerance=1e-3))
    assert (case.coupling.tolerance, coarse.coupling.tolerance) == (1e-6, 1e-3)
    assert coarse.mesh is case.mesh
    with pytest.raises(dataclasses.FrozenInstanceError):
        case.title = "another"  # type: ignore[misc]


def test_a_point_may_have_no_name() -> None:
    assert Point(0.6, 0.2).vertex is None
