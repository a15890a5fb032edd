"""Means, amplitudes and frequencies of series."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi.statistics import last_period, statistics, upward_crossings

PI2 = 2.0 * np.pi
RNG_SEED = 20240517


def test_crossings_are_interpolated_linearly() -> None:
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    values = np.array([-1.0, 3.0, -1.0, -2.0, 2.0, 3.0])
    np.testing.assert_allclose(upward_crossings(times, values, 0.0, 0.5), [0.25, 3.5])


def test_excursions_within_the_band_are_no_crossings() -> None:
    times = np.arange(8.0)
    values = np.array([-1.0, 0.1, -0.1, 0.1, -0.1, 1.0, 0.1, -0.1])
    assert len(upward_crossings(times, values, 0.0, 0.5)) == 1
    assert len(upward_crossings(times, values, 0.0, 0.05)) == 3


@pytest.mark.parametrize("frequency", [1.93, 5.3])
def test_a_sine_wave(frequency: float) -> None:
    times = np.arange(0.005, 4.0, 0.005)
    values = 0.3 + 1.2 * np.sin(PI2 * frequency * times + 0.7)
    found = statistics(times, {"u": values}, "u")["u"]
    assert found.mean == pytest.approx(0.3, abs=1e-3)
    assert found.amplitude == pytest.approx(1.2, rel=2e-3)
    assert found.frequency == pytest.approx(frequency, rel=1e-5)
    assert found.last == values[-1]
    assert (found.max, found.t_max) == (values.max(), times[values.argmax()])
    assert (found.min, found.t_min) == (values.min(), times[values.argmin()])


def test_the_period_is_the_last_full_one() -> None:
    times = np.linspace(0.0, 3.2, 3201)
    period = last_period(times, np.sin(PI2 * times))
    assert period is not None
    assert (period.start, period.end) == pytest.approx((2.0, 3.0), abs=1e-6)


def test_other_quantities_share_the_window_and_keep_their_frequency() -> None:
    times = np.arange(0.0, 6.0, 0.004)
    u_y = np.sin(PI2 * 1.1 * times)
    drag = 20.0 - 3.0 * np.cos(2.0 * PI2 * 1.1 * times + 0.3)
    level = np.full_like(times, 4.0)
    found = statistics(times, {"drag": drag, "u_y": u_y, "level": level}, "u_y")
    assert found["drag"].frequency == pytest.approx(2.2, rel=1e-4)
    assert (found["drag"].mean, found["drag"].amplitude) == pytest.approx((20.0, 3.0), rel=1e-3)
    assert (found["level"].mean, found["level"].amplitude, found["level"].frequency) == (4.0, 0.0, None)


def test_means_are_taken_over_the_last_period_not_over_the_start_up() -> None:
    times = np.arange(0.0, 10.0, 0.01)
    growing = (1.0 - np.exp(-times)) * np.sin(PI2 * times) + 5.0 * np.exp(-2.0 * times)
    found = statistics(times, {"u": growing}, "u")["u"]
    assert found.max == growing.max() > 4.0
    assert (found.mean, found.amplitude) == pytest.approx((0.0, 1.0), abs=3e-3)
    assert found.frequency == pytest.approx(1.0, rel=1e-3)


def test_noise_changes_the_frequency_little() -> None:
    times = np.arange(0.0, 8.0, 0.005)
    noise = np.random.default_rng(RNG_SEED).normal(scale=0.03, size=len(times))
    found = statistics(times, {"u": np.sin(PI2 * 1.7 * times) + noise}, "u")["u"]
    assert found.frequency == pytest.approx(1.7, rel=5e-3)
    assert found.amplitude == pytest.approx(1.0, abs=0.15)


STEADY = {
    "constant": lambda t: np.full_like(t, 3.0),
    "zero": np.zeros_like,
    "rounding": lambda t: 1.0 + 1e-12 * np.sin(PI2 * t),
    "monotonic": lambda t: 1.0 - np.exp(-t),
    "noise": lambda t: 1.0 + 1e-3 * np.random.default_rng(RNG_SEED).normal(size=len(t)),
    "decayed": lambda t: 1.0 + np.exp(-12.0 * t) * np.cos(PI2 * t),
    "half a period": lambda t: np.sin(0.5 * t),
}


@pytest.mark.parametrize("name", STEADY)
def test_steady_series_have_no_period(name: str) -> None:
    times = np.arange(0.0, 6.0, 0.01)
    values = STEADY[name](times)
    assert last_period(times, values) is None
    found = statistics(times, {"u": values}, "u")["u"]
    assert (found.mean, found.amplitude, found.frequency) == (None, None, None)
    assert found.last == values[-1]


def test_a_slowly_decaying_oscillation_is_measured_at_its_end() -> None:
    times = np.arange(0.0, 20.0, 0.01)
    found = statistics(times, {"u": np.exp(-0.2 * times) * np.sin(PI2 * times)}, "u")["u"]
    assert found.amplitude == pytest.approx(np.exp(-0.2 * 18.5), rel=0.01)  # the last full period is from 18 to 19
    assert found.frequency == pytest.approx(1.0, rel=2e-3)


def test_a_period_longer_than_half_the_run_is_found() -> None:
    times = np.arange(0.0, 2.6, 0.01)
    period = last_period(times, -np.cos(PI2 * times / 1.8))
    assert period is not None
    assert 1.0 / period.frequency == pytest.approx(1.8, rel=1e-3)


def test_without_a_defining_quantity_there_are_extremes_only() -> None:
    times = np.arange(0.0, 6.0, 0.01)
    found = statistics(times, {"u": np.sin(PI2 * times)}, None)["u"]
    assert (found.mean, found.amplitude, found.frequency) == (None, None, None)
    assert found.max == pytest.approx(1.0)


def test_values_that_are_not_finite_are_left_out() -> None:
    times = np.arange(5.0)
    found = statistics(times, {"p": np.array([np.nan, 2.0, 1.0, 4.0, np.nan])}, "p")["p"]
    assert (found.last, found.max, found.t_max, found.min, found.t_min) == (None, 4.0, 3.0, 1.0, 2.0)
    nothing = statistics(times, {"p": np.full(5, np.nan)}, "p")["p"]
    assert (nothing.last, nothing.max, nothing.mean) == (None, None, None)


@pytest.mark.parametrize("count", [0, 1, 2, 3, 5])
def test_short_series(count: int) -> None:
    times = np.arange(float(count))
    values = np.cos(3.0 * times)
    found = statistics(times, {"u": values}, "u")["u"]
    assert found.last == (values[-1] if count else None)
    assert found.frequency is None


def test_a_quantity_that_is_missing_in_the_last_period_has_no_mean() -> None:
    times = np.arange(0.0, 6.0, 0.01)
    u = np.sin(PI2 * times)
    found = statistics(times, {"u": u, "p": np.where(times > 4.5, np.nan, u)}, "u")
    assert found["u"].mean is not None
    assert (found["p"].mean, found["p"].frequency) == (None, None)


def test_a_quantity_that_is_missing_after_the_last_period_has_a_mean_but_no_frequency() -> None:
    times = np.arange(0.0, 6.0, 0.01)
    u = np.sin(PI2 * times)
    found = statistics(times, {"u": u, "p": np.where(times > 5.2, np.nan, u)}, "u")["p"]
    assert (found.last, found.mean, found.frequency) == (None, pytest.approx(0.0, abs=1e-3), None)


@pytest.mark.parametrize("shift", [-150.0, -40.0, 0.0, 75.0, 180.0])
def test_the_phase_is_by_how_much_a_series_is_ahead(shift: float) -> None:
    times = np.arange(0.0, 6.0, 0.01)
    motion = 0.4 * np.sin(PI2 * 0.9 * times)
    force = 3.0 - 2.0 * np.sin(PI2 * 0.9 * times + np.radians(shift)) + 0.7 * np.cos(3.0 * PI2 * 0.9 * times)
    found = statistics(times, {"force": -force, "motion": motion}, "motion")
    assert found["motion"].phase == 0.0
    assert found["motion"].harmonic == pytest.approx(0.4, rel=2e-3)
    assert found["force"].harmonic == pytest.approx(2.0, rel=2e-3)
    phase = found["force"].phase
    assert phase is not None
    assert -180.0 < phase <= 180.0
    assert (phase - shift + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=0.02)


def test_phases_need_no_equal_steps_and_converge_at_second_order() -> None:
    def error(steps: int) -> float:
        times = np.linspace(0.0, 1.0, steps) ** 1.3 * 5.0
        series = {"a": np.sin(PI2 * times), "b": np.sin(PI2 * times + 0.5)}
        phase = statistics(times, series, "a")["b"].phase
        assert phase is not None
        return abs(np.radians(phase) - 0.5)

    assert error(200) < 2e-3
    assert error(800) < error(200) / 10.0


def test_what_does_not_oscillate_with_the_motion_has_no_phase() -> None:
    times = np.arange(0.0, 6.0, 0.01)
    series = {
        "motion": np.sin(PI2 * times),
        "constant": np.full(len(times), 2.0),
        "twice": np.cos(2.0 * PI2 * times),
        "gone": np.where(times > 4.3, np.nan, np.sin(PI2 * times)),
    }
    found = statistics(times, series, "motion")
    assert found["constant"].phase is None
    assert found["twice"].phase is None
    assert found["twice"].harmonic == pytest.approx(0.0, abs=1e-6)
    assert (found["gone"].phase, found["gone"].harmonic) == (None, None)
    assert statistics(times, series, None)["motion"].phase is None
