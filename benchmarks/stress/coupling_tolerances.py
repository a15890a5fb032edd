"""Coupling at loose and tight tolerances: loose does not drift away, tight converges or says that rounding forbids."""

from __future__ import annotations

from functools import cache, partial

import numpy as np

from stress.case import Expectation, Numbers, Stops, StressCase, Within
from stress.flap import Flap
from stress.runs import Run, marched

__all__ = ["CASES"]

_WAYS = {
    "condensed": "",
    "condensed, implicit": 'geometry = "implicit"',
    "IQN-ILS": "condensed = false",
    "IQN-ILS, implicit": 'condensed = false\ngeometry = "implicit"',
    "IMVJ": 'condensed = false\nacceleration = "imvj"',
    "Aitken": 'condensed = false\nacceleration = "aitken"\nmax_iterations = 300\nrelaxation = 0.2',
}
_DEFAULT = 1e-7


@cache
def _run(way: str, tolerance: float, steps: int, start: str) -> Run:
    """A flap as heavy as the fluid in a flow that goes to and fro, or sets in at once."""
    inflow = "sin(pi*t)" if start == "smooth" else "1"
    coupling = f"{_WAYS[way]}\ntolerance = {tolerance!r}\nforce_tolerance = {tolerance!r}"
    time = f"dt = 0.02\nsteps = {steps}"
    return marched(Flap(2, youngs_modulus=3000.0, inflow=inflow, time=time, coupling=coupling).scene)


def _off(found: Run, reference: Run, name: str) -> tuple[float, float]:
    """Largest difference in the first and the second half, relative to the largest value."""
    values = reference.at_whole_steps(name)
    off = np.abs(found.at_whole_steps(name) - values) / np.abs(values).max()
    half = len(off) // 2
    return float(off[:half].max()), float(off[half:].max())


def _loose(way: str, tolerance: float, start: str, quick: bool) -> Numbers:
    """Against the default tolerance of these runs; errors of the second half are not much larger than of the first."""
    steps = 20 if quick else 40
    found, reference = _run(way, tolerance, steps, start), _run(way, _DEFAULT, steps, start)
    (u_early, u_late), (f_early, f_late) = (_off(found, reference, name) for name in ("u_x", "f_x"))
    return {
        "u_x": max(u_early, u_late),
        "f_x": max(f_early, f_late),
        "u_x late/early": u_late / max(u_early, tolerance),
        "iterations": found.mean,
    }


def _tight(way: str, tolerance: float, start: str, quick: bool) -> Numbers:
    """The same values as with the default tolerance of these runs, to that."""
    steps = 10
    found, reference = _run(way, tolerance, steps, start), _run(way, _DEFAULT, steps, start)
    return {
        "u_x": max(_off(found, reference, "u_x")),
        "f_x": max(_off(found, reference, "f_x")),
        "iterations": found.mean,
        "halved": float((~found.whole).sum()),
    }


def _limits(way: str) -> float:
    return {"condensed": 10.0, "Aitken": 200.0}.get(way, 30.0)


def _loose_case(way: str, tolerance: float, start: str) -> StressCase:
    # An error of the tolerance in each step's increment, and as much again in the velocity it leaves.
    bounds = {"u_x": 10.0 * tolerance, "f_x": 1.0, "u_x late/early": 5.0, "iterations": _limits(way)}
    return StressCase(
        f"{tolerance:g}, {start} start: {way}",
        "Many steps at a loose tolerance stay near those of a tight one.",
        (Within(bounds),),
        partial(_loose, way, tolerance, start),
        quick=tolerance == 1e-2 and way in ("condensed", "IQN-ILS"),
    )


def _tight_case(way: str, tolerance: float, start: str) -> StressCase:
    rounding: tuple[Expectation, ...] = (Stops("CouplingError", "close to the noise of the solvers"),)
    ends = Within({"u_x": 1e-5, "f_x": 1e-4, "iterations": _limits(way), "halved": 0.0})
    return StressCase(
        f"{tolerance:g}, {start} start: {way}",
        "A tolerance near rounding is reached, or the error says that it is close to the noise of the solvers.",
        (ends, *rounding) if tolerance < 1e-11 else (ends,),
        partial(_tight, way, tolerance, start),
        quick=tolerance == 1e-12 and way in ("condensed", "IQN-ILS"),
    )


_TWO = ("condensed", "IQN-ILS")

CASES = (
    *(_loose_case(way, 1e-2, "smooth") for way in _WAYS if way != "IQN-ILS, implicit"),
    *(_loose_case(way, 1e-2, "sudden") for way in _TWO),
    *(_loose_case(way, 1e-1, "smooth") for way in _TWO),
    *(_tight_case(way, 1e-12, "smooth") for way in _WAYS),
    *(_tight_case(way, 1e-12, "sudden") for way in _TWO),
    *(_tight_case(way, 1e-14, "smooth") for way in _TWO),
)
