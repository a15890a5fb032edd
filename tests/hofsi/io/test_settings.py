"""Settings of a scene."""

from __future__ import annotations

from typing import Any

import pytest

from hoblock.errors import SceneError
from hoblock.io.table import Table
from hofsi.case import (
    CouplingSettings,
    LinearSettings,
    NonlinearSettings,
    OutputSettings,
    SolidScheme,
    Steady,
    Unsteady,
)
from hofsi.errors import CaseError
from hofsi.io.settings import (
    read_coupling,
    read_linear,
    read_nonlinear,
    read_output,
    read_solid_scheme,
    read_time,
)

UNSTEADY = Unsteady(0.1, 0.0, 1.0, 10)


def test_empty_tables_give_the_defaults() -> None:
    assert read_coupling(Table({}), UNSTEADY) == CouplingSettings()
    assert read_nonlinear(Table({})) == NonlinearSettings()
    assert read_linear(Table({})) == LinearSettings()
    assert read_output(Table({}), ()) == OutputSettings()


def test_a_steady_coupling_is_implicit() -> None:
    assert read_coupling(Table({}), Steady()) == CouplingSettings(geometry="implicit")
    assert read_coupling(Table({"geometry": "extrapolated"}), Steady()).geometry == "extrapolated"  # refused later on


def test_coupling() -> None:
    values: dict[str, Any] = {
        "acceleration": "aitken", "geometry": "implicit", "predictor": 0, "tolerance": 1e-4, "max_iterations": 9,
        "reuse": 0, "filter": 0.0, "relaxation": 1.0, "condensed": False,
    }  # fmt: skip
    assert read_coupling(Table(values), UNSTEADY) == CouplingSettings(**values)


def test_solvers_and_output() -> None:
    assert read_nonlinear(Table({"tolerance": 1e-8, "max_iterations": 3})) == NonlinearSettings(1e-8, 3)
    assert read_linear(Table({"solver": "amg", "tolerance": 1e-7})) == LinearSettings("amg", 1e-7)
    output = {"fields": False, "every": 3, "plots": False, "period_of": "u", "checkpoint_every": 5}
    assert read_output(Table(output), ["u"]) == OutputSettings(False, 3, False, "u", 5)


@pytest.mark.parametrize(
    ("data", "time"),
    [
        ({"steady": True}, Steady()),
        ({"dt": 0.1, "end": 0.3}, Unsteady(0.1, 0.0, 0.3, 3)),
        ({"steady": False, "dt": 0.005, "end": 4}, Unsteady(0.005, 0.0, 4.0, 800)),
        ({"dt": 0.5, "steps": 3, "start": 1}, Unsteady(0.5, 1.0, 2.5, 3)),
        ({"dt": 1e-3, "end": 30.0, "start": -0.25}, Unsteady(1e-3, -0.25, 30.0, 30250)),
    ],
)
def test_time(data: dict[str, Any], time: Steady | Unsteady) -> None:
    assert read_time(Table(data, "time")) == time


@pytest.mark.parametrize(
    ("data", "match"),
    [
        ({}, r"time.dt: there is no time step; expected steady = true, or dt with end or steps"),
        ({"dt": 0.1}, r"time: got neither 'end' nor 'steps'; expected exactly one"),
        ({"dt": 0.1, "end": 1, "steps": 10}, r"time: got both 'end' and 'steps'"),
        ({"dt": 0.1, "end": 1, "start": 1}, r"time.end: got 1; expected an end after the start, 1"),
        ({"dt": 5, "end": 1}, r"time.dt: got 5, longer than the time from 0 to 1. Use dt = 1 or less"),
        ({"steady": True, "dt": 0.1}, r"time.dt: steady = true leaves no time; remove this key"),
        ({"steady": True, "steps": 1}, r"time.steps: steady = true leaves no time"),
    ],
)
def test_times_that_do_not_go_together(data: dict[str, Any], match: str) -> None:
    with pytest.raises(CaseError, match=match):
        read_time(Table(data, "time"))


@pytest.mark.parametrize(
    ("data", "match"),
    [
        ({"dt": 0, "end": 1}, r"time.dt: got 0; expected a number above 0"),
        ({"dt": "fast", "end": 1}, r"time.dt: got the text 'fast'"),
        ({"dt": 0.1, "steps": 0}, r"time.steps: got 0; expected an integer of at least 1"),
        ({"dt": 0.1, "steps": 1.5}, r"time.steps: got the number 1.5; expected an integer"),
        ({"steady": 1}, r"time.steady: got the number 1; expected true or false"),
        ({"dt": 0.1, "ends": 1, "end": 1}, r"time.ends: unknown key. Did you mean 'end'"),
        ({"steady": True, "stedy": True}, r"time.stedy: unknown key. Did you mean 'steady'"),
    ],
)
def test_mistakes_of_time(data: dict[str, Any], match: str) -> None:
    with pytest.raises(SceneError, match=match):
        read_time(Table(data, "time"))


@pytest.mark.parametrize(
    ("data", "match"),
    [
        ({"acceleration": "iqnils"}, r"coupling.acceleration: got 'iqnils'. Did you mean 'iqn-ils'"),
        ({"geometry": "explicit"}, r"coupling.geometry: got 'explicit'"),
        ({"predictor": 4}, r"coupling.predictor: got 4; expected an integer of at least 0 and of at most 3"),
        ({"tolerance": 0}, r"coupling.tolerance: got 0"),
        ({"tolerance": 1}, r"coupling.tolerance: got 1; .* below 1"),
        ({"max_iterations": 0}, r"coupling.max_iterations: got 0"),
        ({"reuse": -1}, r"coupling.reuse: got -1"),
        ({"filter": -1e-3}, r"coupling.filter: got -0.001"),
        ({"relaxation": 1.5}, r"coupling.relaxation: got 1.5; expected a number .*of at most 1"),
        ({"relax": 0.5}, r"coupling.relax: unknown key. Did you mean 'relaxation'"),
    ],
)
def test_mistakes_of_the_coupling(data: dict[str, Any], match: str) -> None:
    with pytest.raises(SceneError, match=match):
        read_coupling(Table(data, "coupling"), UNSTEADY)


def test_mistakes_of_the_solvers() -> None:
    with pytest.raises(SceneError, match=r"nonlinear.max_iterations: got 0"):
        read_nonlinear(Table({"max_iterations": 0}, "nonlinear"))
    with pytest.raises(SceneError, match=r"linear.solver: got 'lu'"):
        read_linear(Table({"solver": "lu"}, "linear"))
    with pytest.raises(SceneError, match=r"linear.restart: unknown key"):
        read_linear(Table({"restart": 30}, "linear"))


@pytest.mark.parametrize(
    ("data", "match"),
    [
        ({"every": 0}, r"output.every: got 0"),
        ({"checkpoint_every": 0}, r"output.checkpoint_every: got 0"),
        ({"fields": "yes"}, r"output.fields: got the text 'yes'; expected true or false"),
        ({"period_of": "u_z"}, r"output.period_of: got the unknown name 'u_z'. Did you mean 'u_y'.*in \[quantities\]"),
        ({"plot": True}, r"output.plot: unknown key. Did you mean 'plots'"),
    ],
)
def test_mistakes_of_the_output(data: dict[str, Any], match: str) -> None:
    with pytest.raises(SceneError, match=match):
        read_output(Table(data, "output"), ["drag", "u_y"])


def test_the_last_step_lands_on_the_end() -> None:
    time = read_time(Table({"dt": 0.3, "end": 1.1, "start": 0.1}))
    assert isinstance(time, Unsteady)
    assert time.steps == 4
    assert time.step(1) == pytest.approx((0.4, 0.3))
    assert time.step(4) == pytest.approx((1.1, 0.1))


@pytest.mark.parametrize(("dt", "end", "steps"), [(0.005, 4.0, 800), (0.1, 0.3, 3), (1e-3, 10.0, 10000), (1.0, 1.0, 1)])
def test_whole_numbers_of_steps_stay_whole(dt: float, end: float, steps: int) -> None:
    time = read_time(Table({"dt": dt, "end": end}))
    assert isinstance(time, Unsteady)
    assert time.steps == steps
    assert time.step(steps)[1] == dt


def test_steps_may_be_halved_four_times_and_ten_with_a_tolerance():
    time = read_time(Table({"dt": 0.1, "end": 1.0}, "time"))
    assert (time.halvings, time.tolerance, time.first) == (4, None, None)
    time = read_time(Table({"dt": 0.1, "end": 1.0, "tolerance": 1e-3}, "time"))
    assert (time.halvings, time.tolerance, time.first) == (10, 1e-3, pytest.approx(0.1 / 16))
    time = read_time(Table({"dt": 0.1, "end": 1.0, "tolerance": 1e-3, "halvings": 2}, "time"))
    assert (time.halvings, time.first) == (2, pytest.approx(0.025))
    time = read_time(Table({"dt": 0.1, "end": 1.0, "first": 0.02, "halvings": 3}, "time"))
    assert (time.halvings, time.tolerance, time.first) == (3, None, 0.02)


@pytest.mark.parametrize(
    ("keys", "place"),
    [
        ({"tolerance": 0.0}, "time.tolerance"),
        ({"tolerance": 1.0}, "time.tolerance"),
        ({"halvings": -1}, "time.halvings"),
        ({"halvings": 41}, "time.halvings"),
        ({"first": 0.2}, "time.first"),
        ({"first": 0.006}, "time.first"),
        ({"first": 0.0}, "time.first"),
    ],
)
def test_divisions_out_of_range_are_refused(keys, place):
    with pytest.raises(SceneError) as caught:
        read_time(Table({"dt": 0.1, "end": 1.0, **keys}, "time"))
    assert caught.value.place == place


def test_schemes_of_solids() -> None:
    assert read_solid_scheme(Table({"dt": 0.1}, "time")) == SolidScheme("bdf2", 0.8)
    assert read_solid_scheme(Table({"solid": "energy-momentum"}, "time")).name == "energy-momentum"
    scheme = read_solid_scheme(Table({"solid": "generalised-alpha", "spectral_radius": 0.5}, "time"))
    assert scheme == SolidScheme("generalised-alpha", 0.5)
    table = Table({"dt": 0.1, "steps": 2, "solid": "generalised-alpha"}, "time")
    read_solid_scheme(table)
    read_time(table)  # knows the key


@pytest.mark.parametrize(
    ("keys", "place"),
    [
        ({"solid": "newmark"}, "time.solid"),
        ({"spectral_radius": 0.5}, "time.spectral_radius"),
        ({"solid": "energy-momentum", "spectral_radius": 1.0}, "time.spectral_radius"),
        ({"solid": "generalised-alpha", "spectral_radius": 1.1}, "time.spectral_radius"),
    ],
)
def test_schemes_that_do_not_exist_are_refused(keys: dict[str, Any], place: str) -> None:
    with pytest.raises(SceneError) as caught:
        read_solid_scheme(Table(keys, "time"))
    assert caught.value.place == place
