"""Residuals that do not fall any more, residuals that grow, and how the loop answers."""

import numpy as np
import pytest

from hofsi.coupling.stall import StallWatch


def verdicts(excesses, off=None):
    watch = StallWatch()
    found = []
    for k, excess in enumerate(excesses):
        size = 1e-3 if off is None else off[k]
        found.append(watch.observe(np.full((3, 2), 0.1 * k), np.full((3, 2), size), excess))
    return watch, found


def test_residuals_that_fall_slowly_go_on():
    _, found = verdicts(1e6 * 0.98 ** np.arange(300))
    assert set(found) == {""}


def test_twenty_iterations_without_progress_are_a_stall():
    falling = list(10.0 ** -np.arange(1.0, 6.0) * 1e6)
    watch, found = verdicts(falling + [11.0, 9.5] * 20)
    assert found.index("stalled") == 24
    assert watch.best == 9.5


def test_a_standstill_that_ends_in_time_is_none():
    _, found = verdicts([100.0] * 19 + [50.0] * 19 + [0.4])
    assert set(found) == {""}


def test_what_is_below_its_tolerance_does_not_stall():
    """The flow may need iterations when displacement and force have agreed already."""
    _, found = verdicts([10.0] + [0.8] * 40)
    assert set(found) == {""}


def test_a_residual_that_grows_without_bound_diverges():
    watch, found = verdicts([1.0] * 8, off=1e-3 * 5.0 ** np.arange(8))  # relative residuals tend to 1
    assert found.index("diverging") == 6
    assert watch.growth == pytest.approx(5.0**7)


@pytest.mark.parametrize("gain", [0.3, 4.0])
def test_the_gain_is_that_of_the_loop(gain):
    """d̃ = b - G d with the eigenvalues gain and gain/10 of G, iterated with relaxation."""
    rng = np.random.default_rng(41)
    Q = np.linalg.qr(rng.normal(size=(6, 6)))[0]
    G, b, d = Q @ np.diag(np.linspace(0.1 * gain, gain, 6)) @ Q.T, rng.normal(size=6), np.zeros(6)
    watch = StallWatch()
    for _ in range(60):
        image = b - G @ d
        watch.observe(image.reshape(3, 2), (image - d).reshape(3, 2), 1e3)
        d = d + 0.9 * (image - d)
    assert watch.gain <= gain * (1.0 + 1e-9)
    assert watch.gain >= (0.99 if gain > 1.0 else 0.4) * gain


def test_a_loop_that_helps_has_no_gain():
    watch = StallWatch()
    for k in range(4):
        watch.observe(np.full((2, 2), 0.5 * k), np.full((2, 2), -0.5 * k), 1e3)
    assert watch.gain == 0.0
