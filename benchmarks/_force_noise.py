"""What a force has above a frequency: the oscillations that a step size or a mesh brings in."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import firwin, kaiserord

Array = NDArray[np.float64]

SETTLED = 2.5  # s, when the flap of Wall and Ramm swings fully
CUTOFF = 50.0  # Hz; the filter is half open here
WIDTH = 30.0  # Hz, of the transition: closed (10⁻⁵) below CUTOFF - WIDTH/2, open above CUTOFF + WIDTH/2
_ATTENUATION = 100.0  # dB


def high_passed(t: Array, values: Array, cutoff: float = CUTOFF, width: float = WIDTH) -> tuple[Array, Array]:
    """Return the times and values of what a series has above a frequency.

    A symmetric filter (sinc with Kaiser's window) with the same cutoff and duration in seconds whatever the step is, so
    that series of different steps can be compared. Smooth oscillations below it leave 10⁻⁵ of their amplitude, jumps
    and kinks from one step to the next pass nearly whole.

    Parameters
    ----------
    t, values : ndarray, shape (n,)
        Equal steps.
    cutoff, width : float
        In Hz.

    Raises
    ------
    ValueError
        If the steps differ, are too long for the cutoff, or too few for the filter.
    """
    dt = float(t[1] - t[0])
    if not np.allclose(np.diff(t), dt, rtol=1e-6):
        raise ValueError(f"t: steps from {np.diff(t).min():.6g} to {np.diff(t).max():.6g}; expected equal ones.")
    nyquist = 0.5 / dt
    if cutoff + width / 2.0 >= nyquist:
        raise ValueError(f"cutoff {cutoff:g} Hz with width {width:g}: expected an end below {nyquist:g} Hz, 1/(2 dt).")
    count, beta = kaiserord(_ATTENUATION, width / nyquist)
    count |= 1
    if count > len(values):
        raise ValueError(f"values: {len(values)} steps; expected at least the {count} of the filter.")
    taps = firwin(count, cutoff, window=("kaiser", beta), pass_zero=False, fs=1.0 / dt)
    half = count // 2
    return t[half : len(t) - half], np.convolve(values, taps, "valid")


def noise(t: Array, values: Array, start: float, cutoff: float = CUTOFF, width: float = WIDTH) -> tuple[float, float]:
    """Return the largest value and the root mean square of the high-passed series from ``start`` on.

    Both are relative to the amplitude of the series there, half of largest minus smallest value.
    """
    used = t >= start
    amplitude = float(np.ptp(values[used])) / 2.0
    _, high = high_passed(t[used], values[used], cutoff, width)
    return float(np.abs(high).max()) / amplitude, float(np.sqrt(np.mean(high**2))) / amplitude
