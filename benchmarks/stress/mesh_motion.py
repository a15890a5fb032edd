"""Movers driven until they fail: no accepted mesh may be folded, and the way back leads to the first mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from hoblock import GradingError, InvalidMeshError, MoverError
from hoblock.motion import MeshMotion
from hoblock.movers import AngleOptimisation, BarrierEnergy, Mover, PseudoSolid, Rule
from motion_cases import MotionCase, motion_case
from stress.case import Numbers, Stops, StressCase, Within
from stress.runs import marched
from stress.sampling import sampled_det_J

Array = NDArray[np.float64]

__all__ = ["CASES"]

_ORDER = 4
_ROUNDING = 1e-12


@dataclass(frozen=True)
class _Maker:
    """A mover, and whether its mesh depends on the body's position alone."""

    make: Callable[[MotionCase], Mover]
    returns: bool = True


def _followed(case: MotionCase) -> Mover:
    """Every vertex goes as far as the body on the whole, the less the further away it is."""
    structure, driven = case.structure, case.driven
    free = Rule(structure, driven, np.zeros_like).free
    centre = structure.vertices[driven].mean(axis=0)
    far = np.abs(structure.vertices - centre).max()
    weights = np.clip(1.0 - np.abs(structure.vertices[free] - centre).max(axis=1) / far, 0.0, 1.0)
    return Rule(structure, driven, lambda displacement: weights[:, None] * displacement.mean(axis=0))


_MAKERS = {
    "barrier": _Maker(lambda c: BarrierEnergy(c.structure, c.driven, edges=c.edges)),
    "barrier, sliding": _Maker(lambda c: BarrierEnergy(c.structure, c.driven, edges=c.edges, sliding=c.sliding)),
    "barrier, ang": _Maker(lambda c: BarrierEnergy(c.structure, c.driven, edges=c.edges, energy="ang")),
    "pseudo-solid": _Maker(lambda c: PseudoSolid(c.structure, c.driven)),
    "pseudo-solid, m = 1": _Maker(lambda c: PseudoSolid(c.structure, c.driven, exponent=1.0)),
    "pseudo-solid, incremental": _Maker(lambda c: PseudoSolid(c.structure, c.driven, incremental=True), returns=False),
    "angles, robust": _Maker(lambda c: AngleOptimisation(c.structure, c.driven), returns=False),
    "angles, published": _Maker(lambda c: AngleOptimisation.as_published(c.structure, c.driven), returns=False),
    "rule": _Maker(_followed),
}

# Test, layout, last s, and where a body meets a wall or itself, so that no mesh can go further.
_WAYS = {
    "pushed into a wall": ("T3a", "cross4x", 1.2, 0.99),
    "turned": ("T3b", "cross4x", 360.0, np.inf),
    "bent to a ring": ("T3c", "cross4x", 420.0, 360.0),
    "turned and pushed into a corner": ("T4a", "cross24", 1.5, 1.008),
    "flag bent to the wall": ("TH", "b3", 0.6, 0.31),
}
# How far it gets at least, from docs/meshing; movers that are not listed need not get anywhere.
_REACH = {
    ("pushed into a wall", "barrier"): 0.95,
    ("pushed into a wall", "pseudo-solid"): 0.80,
    ("turned", "barrier"): 150.0,
    ("turned", "barrier, sliding"): 180.0,
    ("turned", "pseudo-solid"): 45.0,
    ("bent to a ring", "barrier"): 250.0,
    ("bent to a ring", "pseudo-solid"): 110.0,
    ("turned and pushed into a corner", "barrier, sliding"): 1.0,
    ("flag bent to the wall", "barrier"): 0.28,
}
_QUICK = {("pushed into a wall", "barrier"), ("bent to a ring", "pseudo-solid"), ("turned", "angles, published")}


def _motion(case: MotionCase, mover: str) -> MeshMotion:
    return MeshMotion(case.structure, _ORDER, case.edges, _MAKERS[mover].make(case), halvings=1)


def _journey(way: str, mover: str, quick: bool) -> Numbers:
    """From the start until a motion fails, and back to the start at once."""
    test, layout, end, _ = _WAYS[way]
    case = motion_case(test, layout, 1 if quick else 2)
    motion = _motion(case, mover)
    start, positions = motion.start(), motion.reference.positions
    state, reach, folded, above, stopped = start, 0.0, 0, -np.inf, 0
    for s in np.linspace(0.0, end, 16 if quick else 61)[1:].tolist():
        try:
            moved = motion.move(state, case.motion(positions, s))
        except (GradingError, InvalidMeshError, MoverError):
            stopped = 1
            break
        det_J = sampled_det_J(moved.mesh)
        folded += int(det_J.min() <= 0.0)
        above = max(above, float((moved.min_det_J - det_J.min()) / np.abs(det_J).max()))
        state, reach = moved, s
    found = {"reach": reach, "stopped": stopped, "folded": folded, "bound - sample": above}
    if _MAKERS[mover].returns:
        back = motion.move(state, positions)
        found["return"] = float(np.abs(back.mesh.points - start.mesh.points).max() / np.ptp(start.mesh.points))
    return found


def _journeys() -> list[StressCase]:
    cases = []
    for way, (_, _, end, most) in _WAYS.items():
        for mover, maker in _MAKERS.items():
            limits: dict[str, float | tuple[float, float]] = {
                "reach": (_REACH.get((way, mover), 0.0), min(most, end)),
                "folded": 0,
                "bound - sample": _ROUNDING,
            }
            limits |= {"return": 1e-9} if maker.returns else {}
            limits |= {"stopped": (1, 1)} if np.isfinite(most) else {}
            text = f"A body is {way} by small steps until {mover} fails by the named error, then put back at once."
            measure = partial(_journey, way, mover)
            cases.append(StressCase(f"{way}: {mover}", text, (Within(limits),), measure, quick=(way, mover) in _QUICK))
    return cases


def _leap(mover: str, quick: bool) -> Numbers:
    """Difference between the mesh of one leap and that of many steps."""
    case = motion_case("T3c", "cross4x", 1)
    motion = _motion(case, mover)
    state, positions = motion.start(), motion.reference.positions
    to = 120.0
    for s in np.linspace(0.0, to, 31)[1:]:
        state = motion.move(state, case.motion(positions, s))
    leapt = motion.move(motion.start(), case.motion(positions, to))
    return {"difference": float(np.abs(leapt.mesh.points - state.mesh.points).max())}


def _roughened(mover: str, quick: bool) -> Numbers:
    """Nodes of the body's surface thrown about, further and further: valid meshes or the named error."""
    case = motion_case("T3b", "cross4x", 1)
    motion = _motion(case, mover)
    start, positions = motion.start(), motion.reference.positions
    noise = np.random.default_rng(7).uniform(-1.0, 1.0, (12, *positions.shape))
    folded = refused = 0
    for amplitude, throw in zip(np.geomspace(1e-4, 0.3, len(noise)), noise, strict=True):
        try:
            moved = motion.move(start, positions + amplitude * throw)
        except (GradingError, InvalidMeshError, MoverError):
            refused += 1
            continue
        folded += int(sampled_det_J(moved.mesh).min() <= 0.0)
    return {"refused": refused, "folded": folded}


_HOLE = """
[mesh]
order = 3
elements = 1
[mesh.vertices]
{vertices}
[mesh.blocks]
fluid = [{blocks}]
[mesh.edges]
outer = [["v00", "v10", "v20", "v30", "v31", "v32", "v33", "v23", "v13", "v03", "v02", "v01", "v00"]]
body = [["v11", "v21", "v22", "v12", "v11"]]
[fluid]
density = 1.0
viscosity = 0.1
[[fluid.boundary]]
on = "outer"
type = "do-nothing"
[[fluid.boundary]]
on = "body"
type = "no-slip"
[[motion]]
on = "body"
x = "t"
y = 0
[time]
dt = 0.05
end = 2.0
halvings = 2
"""


def _driven_through_a_wall(quick: bool) -> Numbers:
    """A block in a box of fluid that is driven beyond the box."""
    vertices = "\n".join(f"v{i}{j} = [{i}, {j}]" for i in range(4) for j in range(4))
    quads = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    blocks = ", ".join(f'["v{i}{j}", "v{i + 1}{j}", "v{i + 1}{j + 1}", "v{i}{j + 1}"]' for i, j in quads)
    return {"time": float(marched(_HOLE.format(vertices=vertices, blocks=blocks)).times[-1])}


CASES = (
    *_journeys(),
    *(
        StressCase(
            f"one leap: {mover}",
            "A plate bent to 120° at once has the mesh of 30 small steps.",
            (Within({"difference": 1e-8}),),
            partial(_leap, mover),
            quick=True,
        )
        for mover in ("barrier", "pseudo-solid")
    ),
    *(
        StressCase(
            f"roughened body: {mover}",
            "Nodes of the surface are thrown about by noise from 1e-4 to 0.3 of a plate of thickness 0.02.",
            (Within({"refused": (2, 11), "folded": 0}),),
            partial(_roughened, mover),
            quick=mover == "pseudo-solid",
        )
        for mover in ("barrier", "pseudo-solid", "angles, robust")
    ),
    StressCase(
        "fluid: body driven through a wall",
        "A run whose moving body leaves the box ends with the mesh's error, not with a folded mesh.",
        (Stops("MeshMotionError", r"Use smaller steps, another \[mover\]"),),
        _driven_through_a_wall,
        quick=True,
    ),
)
