"""What a coupled step that did not converge says."""

import numpy as np
import pytest

from hofsi.case import CouplingSettings
from hofsi.coupling.convergence import ConvergenceTest, Residuals
from hofsi.coupling.failure import coupling_failure, in_iteration, solid_failure
from hofsi.coupling.stall import StallWatch
from hofsi.errors import AddedMassError, CouplingError, NewtonError

TEST = ConvergenceTest(1e-6, 1e-4)


def watch_of(gain):
    watch = StallWatch()
    for k in range(3):
        d, image = np.full((2, 2), float(k)), np.full((2, 2), -gain * k)
        watch.observe(image, image - d, 30.0)
    return watch


def failure(verdict="", residuals=(2e-3, 0.4), gain=0.2, acceleration="iqn-ils", steady=False, together=True):
    settings, left = CouplingSettings(acceleration=acceleration), Residuals(*residuals)
    return coupling_failure(verdict, left, TEST, watch_of(gain), settings, "here", steady=steady, together=together)


@pytest.mark.parametrize(
    ("options", "reason", "expected"),
    [
        (
            {},
            "max_iterations",
            r"here: not converged after 3 iterations: displacement residual 0.002, expected below 1e-06",
        ),
        ({}, "max_iterations", r"force residual 0.4, expected below 0.0001. Lower time.dt, or raise coupling.max_iter"),
        ({"verdict": "stalled"}, "stalled", r"stalled after 3 iterations, the last 20 without progress: .*time.dt\.$"),
        ({"verdict": "diverging"}, "diverged", r"diverging: in 3 iterations the residual has grown by a factor of"),
        (
            {"residuals": (3e-8, 3e-4), "gain": 18.0, "verdict": "stalled"},
            "stalled",
            r"close to the noise of the solvers: raise coupling\.tolerance",
        ),
        (
            {"residuals": (1e-8, 2e-6)},
            "max_iterations",
            r"noise of the solvers: raise coupling.tolerance or coupling.for",
        ),
        (
            {"residuals": (5e-6, 3e-6), "gain": 3.0},  # still falling, for all that is known
            "max_iterations",
            r"expected below 0.0001. The fluid answers .* Raise coupling.max_iterations, or make the solid",
        ),
        (
            {"acceleration": "aitken"},
            "max_iterations",
            r'Lower time.dt, or set coupling.acceleration = "iqn-ils", or raise',
        ),
        (
            {"steady": True, "gain": 3.0},
            "max_iterations",
            r"Raise coupling.max_iterations, or lower the load, or start nearer to the solution\.$",
        ),
        (
            {"gain": 3.0, "together": False, "verdict": "stalled"},
            "stalled",
            r'added mass .* Let fluid and solid be solved together, with linear.solver = "direct" and linear',
        ),
        ({"steady": True, "together": False}, "max_iterations", r"0.0001. Raise coupling.max_iterations, or lower the"),
        (
            {"gain": 3.0},
            "max_iterations",
            r"by 3 times the opposite one: its added mass .* Raise .*, or make the solid heavier",
        ),
    ],
)
def test_message(options, reason, expected):
    error = failure(**options)
    assert error.reason == reason
    with pytest.raises(CouplingError, match=expected):
        raise error


def test_the_added_mass_is_an_error_of_its_own():
    error = failure(gain=3.0)
    assert isinstance(error, AddedMassError)
    assert (error.gain, error.residual) == (pytest.approx(3.0), 30.0)
    assert not isinstance(failure(gain=0.9), AddedMassError)
    assert not isinstance(failure(gain=3.0, steady=True), AddedMassError)
    longer = error.extended("And more.")
    assert (longer.gain, longer.reason, str(longer)) == (error.gain, error.reason, f"{error} And more.")


def test_solids_that_fail_under_the_iterates_of_a_heavy_fluid_are_not_blamed():
    error = NewtonError("Newton's method stopped.", "max_iterations", "solid, t = 1")
    settings = CouplingSettings()
    assert (
        solid_failure(error, watch_of(4.0), settings, "here", steady=False, together=True) is error
    )  # accelerations bear that
    found = solid_failure(error, watch_of(30.0), settings, "here", steady=False, together=True)
    assert isinstance(found, AddedMassError)
    assert (found.gain, found.reason) == (pytest.approx(30.0), "diverged")
    with pytest.raises(
        AddedMassError, match=r"here: diverging: after 3 iterations the solids bear .*Newton.*added mass"
    ):
        raise found


def test_where_fluid_and_solid_are_not_solved_together_that_is_a_way_out():
    error = NewtonError("Newton's method stopped.", "max_iterations", "solid, t = 1")
    apart = CouplingSettings(condensed=False)
    found = solid_failure(error, watch_of(30.0), apart, "here", steady=False, together=False)
    assert "Leave coupling.condensed on, or make the solid heavier" in str(found)
    assert in_iteration(found, apart, steady=False) is found
    told = in_iteration(error, apart, steady=False)
    assert isinstance(told, NewtonError)
    assert (told.reason, told.where) == (error.reason, error.where)
    assert str(told).startswith(f"{error} That was in an iteration between fluid and solid")
    assert "leave coupling.condensed on" in str(told)
    for settings, steady in ((CouplingSettings(), False), (apart, True)):
        assert in_iteration(error, settings, steady=steady) is error
