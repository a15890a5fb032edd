"""Settings of a scene: ``[time]``, ``[coupling]``, ``[nonlinear]``, ``[linear]``, ``[output]``."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from hoblock.io.table import Table
from hofsi.case import (
    CouplingSettings,
    LinearSettings,
    NonlinearSettings,
    OutputSettings,
    SolidScheme,
    Steady,
    TimeSettings,
    Unsteady,
)
from hofsi.errors import CaseError
from hofsi.io.names import check_name, choice

__all__ = ["read_coupling", "read_linear", "read_nonlinear", "read_output", "read_solid_scheme", "read_time"]

_WHOLE = 1e-6
"""How far (end - start)/dt may be from a whole number, in steps."""

_HALVINGS = 10
"""Of a step whose local error is too large."""

_DEEPEST = 40
"""Halvings that can be asked for: times keep a few digits beyond them."""

_SMALL = 4
"""Halvings of the first steps, for which there is no estimate of the error."""


def read_time(table: Table) -> TimeSettings:
    """Read ``[time]``: ``steady = true``, or ``dt`` with ``end`` or ``steps``.

    Raises
    ------
    CaseError
        Both or neither, an end before the start, a step longer than the interval, or a first step out of range.
    """
    if table.boolean("steady", False):
        return _steady(table)
    if not table.has("dt"):
        raise CaseError("there is no time step; expected steady = true, or dt with end or steps", table.place_of("dt"))
    dt = table.number("dt", positive=True)
    start = table.number("start", 0.0)
    if table.has("end") == table.has("steps"):
        got = "both 'end' and 'steps'" if table.has("end") else "neither 'end' nor 'steps'"
        raise CaseError(f"got {got}; expected exactly one of them", table.place)
    steps = table.integer("steps", None, minimum=1)
    time = _until_end(table, dt, start) if steps is None else Unsteady(dt, start, start + steps * dt, steps)
    time = _divided(table, time)
    table.finish()
    return time


def read_solid_scheme(table: Table) -> SolidScheme:
    """Read how solids are advanced from ``[time]``: ``solid`` and ``spectral_radius``; the rest is left to `read_time`.

    Raises
    ------
    CaseError
        A spectral radius for a scheme that has none.
    """
    default = SolidScheme()
    name = choice(table, "solid", ("bdf2", "generalised-alpha", "energy-momentum"), default.name)
    radius = table.number("spectral_radius", default.spectral_radius, minimum=0.0, maximum=1.0)
    if table.has("spectral_radius") and name != "generalised-alpha":
        raise CaseError(
            f'time.solid = "{name}" has none; expected it with "generalised-alpha" alone. Remove it, or choose that',
            table.place_of("spectral_radius"),
        )
    return SolidScheme(name, radius)


def _divided(table: Table, time: Unsteady) -> Unsteady:
    """Read how steps are divided: with a tolerance the first ones are small unless something else is given."""
    tolerance = table.number("tolerance", None, above=0.0, below=1.0)
    halvings = table.integer("halvings", time.halvings if tolerance is None else _HALVINGS, minimum=0, maximum=_DEEPEST)
    first = table.number("first", None, positive=True)
    if first is not None and not 2.0**-halvings * (1.0 - _WHOLE) <= first / time.dt <= 1.0 + _WHOLE:
        raise CaseError(
            f"got {first:g}; expected a step from {time.dt / 2**halvings:g}, which is dt halved 'halvings' = "
            f"{halvings} times, to dt = {time.dt:g}",
            table.place_of("first"),
        )
    if first is None and tolerance is not None:
        first = time.dt / 2 ** min(halvings, _SMALL)
    return replace(time, tolerance=tolerance, halvings=halvings, first=first)


def _steady(table: Table) -> Steady:
    for key in ("dt", "start", "end", "steps", "tolerance", "halvings", "first", "solid", "spectral_radius"):
        if table.has(key):
            raise CaseError("steady = true leaves no time; remove this key, or 'steady'", table.place_of(key))
    table.finish()
    return Steady()


def _until_end(table: Table, dt: float, start: float) -> Unsteady:
    end = table.number("end")
    if end <= start:
        raise CaseError(f"got {end:g}; expected an end after the start, {start:g}", table.place_of("end"))
    steps = (end - start) / dt
    if steps < 1.0 - _WHOLE:
        raise CaseError(
            f"got {dt:g}, longer than the time from {start:g} to {end:g}. Use dt = {end - start:.12g} or less",
            table.place_of("dt"),
        )
    return Unsteady(dt, start, end, math.ceil(steps - _WHOLE * max(1.0, steps)))


def read_coupling(table: Table, time: TimeSettings) -> CouplingSettings:
    """Read ``[coupling]``; the geometry of a steady case is implicit unless something else is given."""
    default = CouplingSettings(geometry="implicit" if isinstance(time, Steady) else "extrapolated")
    settings = CouplingSettings(
        acceleration=choice(table, "acceleration", ("iqn-ils", "imvj", "aitken", "constant"), default.acceleration),
        geometry=choice(table, "geometry", ("extrapolated", "implicit"), default.geometry),
        predictor=table.integer("predictor", default.predictor, minimum=0, maximum=3),
        tolerance=_tolerance(table, default.tolerance),
        force_tolerance=table.number("force_tolerance", default.force_tolerance, above=0.0, below=1.0),
        max_iterations=table.integer("max_iterations", default.max_iterations, minimum=1),
        reuse=table.integer("reuse", default.reuse, minimum=0),
        filter=table.number("filter", default.filter, minimum=0.0, below=1.0),
        relaxation=table.number("relaxation", default.relaxation, above=0.0, maximum=1.0),
        condensed=table.boolean("condensed", default.condensed),
    )
    table.finish()
    return settings


def read_nonlinear(table: Table) -> NonlinearSettings:
    """Read ``[nonlinear]``."""
    default = NonlinearSettings()
    settings = NonlinearSettings(
        tolerance=_tolerance(table, default.tolerance),
        max_iterations=table.integer("max_iterations", default.max_iterations, minimum=1),
    )
    table.finish()
    return settings


def read_linear(table: Table) -> LinearSettings:
    """Read ``[linear]``."""
    default = LinearSettings()
    settings = LinearSettings(
        solver=choice(table, "solver", ("auto", "direct", "amg"), default.solver),
        tolerance=_tolerance(table, default.tolerance),
        lag=table.boolean("lag", default.lag),
    )
    table.finish()
    return settings


def read_output(table: Table, quantities: Iterable[str]) -> OutputSettings:
    """Read ``[output]``; ``quantities`` are the names that ``period_of`` may have."""
    default = OutputSettings()
    period_of = table.string("period_of", None)
    if period_of is not None:
        check_name(period_of, quantities, "quantities in [quantities]", table.place_of("period_of"))
    settings = OutputSettings(
        fields=table.boolean("fields", default.fields),
        every=table.integer("every", default.every, minimum=1),
        plots=table.boolean("plots", default.plots),
        period_of=period_of,
        checkpoint_every=table.integer("checkpoint_every", default.checkpoint_every, minimum=1),
        energy=table.boolean("energy", default.energy),
    )
    table.finish()
    return settings


def _tolerance(table: Table, default: float) -> float:
    return table.number("tolerance", default, above=0.0, below=1.0)
