"""The exceptions of hofsi."""

from __future__ import annotations

import pickle

import pytest

from hoblock.errors import SceneError
from hofsi import errors
from hofsi.errors import CaseError, ConvergenceError, HofsiError, NewtonError


def test_all_errors_derive_from_one_class() -> None:
    classes = [getattr(errors, name) for name in errors.__all__]
    assert all(issubclass(cls, HofsiError) for cls in classes)


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("HofsiError", 1),
        ("CaseError", 2),
        ("ConvergenceError", 3),
        ("NewtonError", 3),
        ("LinearSolverError", 3),
        ("CouplingError", 3),
        ("MeshMotionError", 3),
    ],
)
def test_exit_codes(name: str, code: int) -> None:
    assert getattr(errors, name).exit_code == code


def test_case_error_is_a_mistake_in_a_scene() -> None:
    error = CaseError("got -1; expected a positive number", "fluid.density")
    error.file = "a.toml"
    assert isinstance(error, SceneError)
    assert str(error) == "a.toml: fluid.density: got -1; expected a positive number"


def test_convergence_error_says_where() -> None:
    error = NewtonError("25 iterations left a residual of 1e-3", reason="max_iterations", where="fluid, t = 0.1")
    assert isinstance(error, ConvergenceError)
    assert (error.reason, error.where) == ("max_iterations", "fluid, t = 0.1")
    assert str(error) == "fluid, t = 0.1: 25 iterations left a residual of 1e-3"
    assert str(ConvergenceError("stalled")) == "stalled"


@pytest.mark.parametrize("error", [CaseError("what", "where"), NewtonError("what", "stalled", "fluid")])
def test_errors_survive_a_process_boundary(error: HofsiError) -> None:
    copy = pickle.loads(pickle.dumps(error))  # noqa: S301
    assert type(copy) is type(error)
    assert str(copy) == str(error)
