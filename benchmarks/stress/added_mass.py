"""Light bodies in a fluid: density ratios from 10 to 0.01, thin walls, a slender flap and a stocky one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from stress.case import Expectation, Numbers, Stops, StressCase, Within
from stress.flap import Flap
from stress.runs import Run, example, marched

__all__ = ["CASES"]

RATIOS = (10.0, 1.0, 0.1, 0.01)
_BODIES = ("thin walls", "slender flap", "stocky flap")
_SAME = 1e-4  # of the largest value: the tolerances are 1e-7 and 1e-6, and leave that much over some steps


@dataclass(frozen=True)
class _Way:
    """How the coupling is iterated, and how many iterations a step that may take.

    Attributes
    ----------
    changes : dict
        Keys of ``[coupling]``.
    reference : str
        The way whose values it must find.
    most : float
        Mean iterations.
    gives_up : float
        Density ratio from which down added mass may be too much for it, as the documentation says.
    """

    changes: dict[str, str]
    reference: str
    most: float
    gives_up: float = 0.0


_PLAIN = {"condensed": "false"}
_IMPLICIT = {"geometry": '"implicit"'}
_WAYS = {
    "condensed": _Way({}, "condensed", 3.0),
    "condensed, implicit": _Way(_IMPLICIT, "condensed, implicit", 6.0),
    "IQN-ILS": _Way(_PLAIN | {"acceleration": '"iqn-ils"'}, "condensed", 20.0, 0.1),
    "IMVJ": _Way(_PLAIN | {"acceleration": '"imvj"'}, "condensed", 20.0, 0.1),
    "Aitken": _Way(
        _PLAIN | {"acceleration": '"aitken"', "max_iterations": "400", "relaxation": "0.1"}, "condensed", 150.0, 1.0
    ),
}
_TOLERANCES = {"tolerance": "1e-7", "force_tolerance": "1e-6"}


@cache
def _run(body: str, ratio: float, way: str, quick: bool) -> Run:
    keys = _TOLERANCES | _WAYS[way].changes
    steps = 4 if quick else 8
    if body == "thin walls":
        changes = [f"coupling.{key}={value}" for key, value in keys.items()]
        changes += [f"solid[0].density={ratio}", "mesh.order=3", f"time.steps={steps}"]
        return marched(example("pressure_pulse", *changes))
    coupling = "\n".join(f"{key} = {value}" for key, value in keys.items())
    time = f"dt = 0.02\nsteps = {steps}"
    inflow = "sin(pi*t)**2"
    if body == "slender flap":
        flap = Flap(3, thickness=0.01, youngs_modulus=6e5, density=ratio, inflow=inflow, time=time, coupling=coupling)
    else:
        flap = Flap(3, thickness=0.4, youngs_modulus=600.0, density=ratio, inflow=inflow, time=time, coupling=coupling)
    return marched(flap.scene)


def _measured(body: str, ratio: float, way: str, quick: bool) -> Numbers:
    found = _run(body, ratio, way, quick)
    reference = _run(body, ratio, _WAYS[way].reference, quick)
    names = [name for name in found.series if name.startswith(("u_", "f_", "wall", "pressure"))]
    # A component that symmetry makes small is compared on the scale of its kind.
    size = {name[0]: 0.0 for name in names}
    for name in names:
        size[name[0]] = max(size[name[0]], float(np.abs(reference.series[name]).max()))
    off = max(
        float(np.abs(found.at_whole_steps(name) - reference.at_whole_steps(name)).max()) / size[name[0]]
        for name in names
    )
    return {"iterations": found.mean, "halved": float((~found.whole).sum()), "difference": off}


def _case(body: str, ratio: float, way: str) -> StressCase:
    given = _WAYS[way]
    ends: tuple[Expectation, ...] = (Within({"iterations": given.most, "halved": 0.0, "difference": _SAME}),)
    if ratio <= given.gives_up:  # a sudden load may be begun again with half the step, whose own error then counts
        ends += (Within({"iterations": 3.0 * given.most, "halved": (1.0, 8.0), "difference": 0.2}),)
        ends += (Stops("AddedMassError", "its added mass dominates a light solid"),)
    text = f"{body.capitalize()} of {ratio:g} times the fluid's density, {way}: few iterations, the same values."
    return StressCase(
        f"{body}, {ratio:g}: {way}",
        text,
        ends,
        partial(_measured, body, ratio, way),
        quick=ratio == 0.01 and way in ("condensed", "IQN-ILS"),
    )


CASES = tuple(
    _case(body, ratio, way) for body in _BODIES for ratio in RATIOS for way in _WAYS if way != "Aitken" or ratio >= 1.0
)
