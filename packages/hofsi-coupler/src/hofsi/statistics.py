"""What a series says in the end: last and extreme values; mean, amplitude, frequency and phase of an oscillation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["Period", "Statistics", "fundamental", "last_period", "statistics", "upward_crossings"]

_BAND = 0.25  # of the amplitude: a crossing counts when the series went this far below before and above after it
_NOISE = 0.2  # of the amplitude: with more noise than this there is no oscillation to speak of
_STEADY = 1e-9  # peak to peak, relative to the largest value, from which a series does not move
_ABSENT = 1e-6  # of the amplitude: a part of an oscillation that is smaller has no phase
_DEAD = 2.0  # periods without a crossing after which an oscillation is over
_REFINEMENTS = 30  # of the level, at most; a decaying oscillation needs one for every few periods
_PERIODS = 5  # at most as many of the last periods are used for a frequency


@dataclass(frozen=True)
class Period:
    """The last full period of a series, and the moment when the periods that its frequency is taken from begin.

    Attributes
    ----------
    start, end : float
    first : float
        ``end`` minus a whole number of periods, at most five.
    frequency : float
    """

    start: float
    end: float
    first: float
    frequency: float


@dataclass(frozen=True)
class Statistics:
    """Summary of one quantity; None where there is no such number.

    Attributes
    ----------
    last, max, t_max, min, t_min : float or None
        Of the whole series.
    mean, amplitude : float or None
        (max + min)/2 and (max - min)/2 over the last full period of the quantity that defines it.
    frequency : float or None
        Of the quantity itself, from its own crossings during the last periods.
    harmonic : float or None
        Amplitude of the part that oscillates with the frequency of the quantity that defines the period: twice the
        modulus of the first Fourier coefficient over the last full periods, at most five.
    phase : float or None
        In degrees, by how much that part is ahead of that of the quantity that defines the period, in (-180, 180]; None
        where there is no such part to speak of.
    """

    last: float | None
    max: float | None
    t_max: float | None
    min: float | None
    t_min: float | None
    mean: float | None = None
    amplitude: float | None = None
    frequency: float | None = None
    harmonic: float | None = None
    phase: float | None = None


def statistics(times: Array, series: Mapping[str, Array], period_of: str | None) -> dict[str, Statistics]:
    """Summarise series.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Ascending.
    series : mapping of str to ndarray, shape (n,)
        Values that are not finite are left out.
    period_of : str or None
        The series whose last full period defines means and amplitudes; None for no period.
    """
    if period_of is None or period_of not in series or (period := last_period(times, series[period_of])) is None:
        return {name: _statistics(times, values, None, None) for name, values in series.items()}
    reference = fundamental(times, series[period_of], period)
    return {name: _statistics(times, values, period, reference) for name, values in series.items()}


def fundamental(times: Array, values: Array, period: Period) -> complex | None:
    """Return the complex amplitude c of a series' part Re c exp(2πi f t) over the last full periods.

    The integral of the straight lines through the samples, so that it needs no equal steps; of second order in them.

    Parameters
    ----------
    times, values : ndarray, shape (n,)
    period : Period
        With the frequency f, and the times between which to integrate.

    Returns
    -------
    complex or None
        None if a value there is not finite.
    """
    inside = (times > period.first) & (times < period.end)
    t = np.concatenate([[period.first], times[inside], [period.end]])
    v = np.interp(t, times, values)
    if not np.isfinite(v).all():
        return None
    v = v - np.trapezoid(v, t) / (t[-1] - t[0])
    wave = np.exp(-2.0j * np.pi * period.frequency * t)
    return complex(2.0 * np.trapezoid(v * wave, t) / (t[-1] - t[0]))


def _phase(part: complex, reference: complex, amplitude: float) -> float | None:
    """Degrees by which a part is ahead of the reference; None if it is less than 1e-6 of the whole oscillation."""
    if abs(part) <= _ABSENT * amplitude or reference == 0.0:
        return None
    return float(np.degrees(np.angle(part / reference)))


def _statistics(times: Array, values: Array, period: Period | None, reference: complex | None) -> Statistics:
    finite = np.isfinite(values)
    last = float(values[-1]) if len(values) and finite[-1] else None
    if not finite.any():
        return Statistics(last, None, None, None, None)
    t, v = times[finite], values[finite]
    high, low = int(v.argmax()), int(v.argmin())
    extremes = float(v[high]), float(t[high]), float(v[low]), float(t[low])
    window = _window(times, values, period) if period is not None else np.zeros(0)
    if period is None or not window.size or not np.isfinite(window).all():
        return Statistics(last, *extremes)
    top, bottom = float(window.max()), float(window.min())
    mean, amplitude, frequency = (top + bottom) / 2.0, (top - bottom) / 2.0, _frequency(times, values, period)
    part = fundamental(times, values, period)
    if part is None or reference is None or 2.0 * amplitude <= _STEADY * max(abs(top), abs(bottom)):
        return Statistics(last, *extremes, mean, amplitude, frequency)
    return Statistics(last, *extremes, mean, amplitude, frequency, abs(part), _phase(part, reference, amplitude))


def _window(times: Array, values: Array, period: Period) -> Array:
    """Values during the last full period, ends included."""
    inside = (times > period.start) & (times < period.end)
    return np.concatenate([values[inside], np.interp([period.start, period.end], times, values)])


def _frequency(times: Array, values: Array, period: Period) -> float | None:
    """Frequency from a series' own crossings during the last periods of the one that defines the period."""
    window = _window(times, values, period)
    tail = times >= period.first - 0.25 * (period.end - period.start)
    if not np.isfinite(values[tail]).all():
        return None
    crossings = _crossings_of(times[tail], values[tail], float(window.max()), float(window.min()))
    return None if len(crossings) < 2 else float((len(crossings) - 1) / (crossings[-1] - crossings[0]))


def last_period(times: Array, values: Array) -> Period | None:
    """Find the last full period of a series, between two upward crossings of its mean (max + min)/2.

    The level is that of the second half of the series at first and of the last period then, so that neither a start-up
    nor a slow change of the mean matters.

    Parameters
    ----------
    times, values : ndarray, shape (n,)

    Returns
    -------
    Period or None
        None if the series is steady in the end, too short, noise, or not finite in its second half.
    """
    if len(values) < 4:
        return None
    half = times >= (times[0] + times[-1]) / 2.0
    part = values[half]
    if part.size < 4 or not np.isfinite(part).all():
        return None
    crossings = _crossings_of(times[half], part, float(part.max()), float(part.min()))
    if len(crossings) < 2:
        return _slow_period(times, values)
    for _ in range(_REFINEMENTS):
        before = times >= crossings[max(0, len(crossings) - 1 - _PERIODS)] - 0.5 * (crossings[-1] - crossings[-2])
        window = values[(times >= crossings[-2]) & (times <= crossings[-1])]
        if not window.size or not np.isfinite(values[before]).all():
            break
        refined = _crossings_of(times[before], values[before], float(window.max()), float(window.min()))
        if len(refined) < 2 or np.array_equal(refined, crossings):
            break
        crossings = refined
    return _period(crossings, float(times[-1]))


def _slow_period(times: Array, values: Array) -> Period | None:
    """A period that is longer than half of the series."""
    if not np.isfinite(values).all():
        return None
    crossings = _crossings_of(times, values, float(values.max()), float(values.min()))
    return _period(crossings, float(times[-1])) if len(crossings) >= 2 else None


def _period(crossings: Array, now: float) -> Period | None:
    """Period between the last crossings, unless the oscillation has died since."""
    used = crossings[-(_PERIODS + 1) :]
    if now - used[-1] > _DEAD * (used[-1] - used[-2]):
        return None
    return Period(float(used[-2]), float(used[-1]), float(used[0]), float((len(used) - 1) / (used[-1] - used[0])))


def _crossings_of(times: Array, values: Array, top: float, bottom: float) -> Array:
    """Upward crossings of the middle between two extremes; none for steady or noisy series."""
    amplitude = (top - bottom) / 2.0
    if 2.0 * amplitude <= _STEADY * max(abs(top), abs(bottom)) or _noise(values) > _NOISE * amplitude:
        return np.zeros(0)
    return upward_crossings(times, values, (top + bottom) / 2.0, _BAND * amplitude)


def _noise(values: Array) -> float:
    """Standard deviation of white noise that would give the third differences of a series."""
    return float(np.sqrt(np.mean(np.diff(values, 3) ** 2) / 20.0)) if len(values) > 3 else 0.0


def upward_crossings(times: Array, values: Array, level: float, band: float) -> Array:
    """Times at which a series crosses a level upwards, interpolated linearly between samples.

    Parameters
    ----------
    times, values : ndarray, shape (n,)
    level : float
    band : float
        A crossing counts only if the series was below ``level - band`` before it and is above ``level + band`` after
        it, so that noise near the level causes no further ones. Of several crossings in between the middle one is
        taken.

    Returns
    -------
    ndarray
        Ascending.
    """
    side = np.where(values > level + band, 1, np.where(values < level - band, -1, 0))
    decided = np.flatnonzero(side)
    rises = np.flatnonzero((side[decided[:-1]] < 0) & (side[decided[1:]] > 0))
    found = []
    for low, high in zip(decided[rises], decided[rises + 1], strict=True):
        part = values[low : high + 1] - level
        steps = np.flatnonzero((part[:-1] < 0.0) & (part[1:] >= 0.0))
        k = int(low + steps[len(steps) // 2])
        share = (level - values[k]) / (values[k + 1] - values[k])
        found.append(times[k] + share * (times[k + 1] - times[k]))
    return np.array(found)
