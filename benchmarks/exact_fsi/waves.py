"""Complex amplitudes as expressions of a scene, and what a time scheme makes of exp(iωt)."""

from __future__ import annotations

import cmath

__all__ = ["in_time", "symbol", "waves"]


def symbol(frequency: float, step: float | None) -> complex:
    """The s of d/dt exp(iωt) = s exp(iωt): iω, or what BDF2 with equal steps has instead.

    Parameters
    ----------
    frequency : float
        ω.
    step : float or None
        None for the derivative itself.
    """
    if step is None:
        return 1j * frequency
    z = cmath.exp(-1j * frequency * step)
    return (1.5 - 2.0 * z + 0.5 * z * z) / step


def in_time(amplitude: complex, frequency: float) -> str:
    """Re(A exp(iωt)) as an expression of t."""
    return f"({abs(amplitude)!r})*cos({frequency!r}*t + ({cmath.phase(amplitude)!r}))"


def waves(amplitude: complex, exponent: complex, frequency: float, along: str, time: str = "t") -> str:
    """Re(A exp(a z + iωt)) as an expression of z and t.

    Parameters
    ----------
    amplitude, exponent : complex
        A, a.
    frequency : float
        ω.
    along, time : str
        Expressions for z and t.
    """
    phase = f"({exponent.imag!r})*({along}) + {frequency!r}*({time}) + ({cmath.phase(amplitude)!r})"
    return f"({abs(amplitude)!r})*exp(({exponent.real!r})*({along}))*cos({phase})"
