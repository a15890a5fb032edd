"""A vessel that splits into two."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Bezier, piece
from hoblock.errors import TemplateError
from hoblock.grading import Exponential
from hoblock.templates.draft import Draft
from hoblock.templates.junction import balanced
from hoblock.templates.parameters import Bounds, Count, Length, Stretch
from hoblock.templates.template import template

Array = NDArray[np.float64]
BranchAngle = Annotated[float, Bounds("degrees", minimum=0.0, maximum=120.0)]

__all__ = ["bifurcation"]

_FREE = ("p", "c", "mu", "ml")
"""Vertices inside the junction: in the mouth of the vessel, in the centre, in the mouths of the branches."""

_BLOCKS: tuple[tuple[str, str, str, str], ...] = (
    ("i0", "a0", "a1", "i1"),
    ("i1", "a1", "a2", "i2"),
    # where the walls bend, the junction, the beginning of the branches
    ("a0", "n0", "p", "a1"),
    ("a1", "p", "n2", "a2"),
    ("n2", "p", "c", "mu"),
    ("n0", "ml", "c", "p"),
    ("k", "mu", "c", "ml"),
    ("k", "u0", "u1", "mu"),
    ("mu", "u1", "u2", "n2"),
    ("n0", "l0", "l1", "ml"),
    ("ml", "l1", "l2", "k"),
    # straight branches
    ("u0", "v0", "v1", "u1"),
    ("u1", "v1", "v2", "u2"),
    ("l0", "m0", "m1", "l1"),
    ("l1", "m1", "m2", "l2"),
)


@template
def bifurcation(
    *,
    width: Length = 1.0,
    upper_width: Length = 0.75,
    lower_width: Length = 0.75,
    upper_angle: BranchAngle = 40.0,
    lower_angle: BranchAngle = 40.0,
    inlet_length: Length = 2.0,
    upper_length: Length = 3.0,
    lower_length: Length = 3.0,
    rounding: Length = 0.8,
    elements_across: Count = 4,
    elements_inlet: Count = 6,
    elements_bend: Count = 4,
    elements_branch: Count = 8,
    stretch: Stretch = 1.0,
) -> BlockStructure:
    """Vessel that splits into two branches: smooth outer walls, a sharp carina in which three blocks meet.

    The vessel comes from the left along y = 0. Vertices ``k`` (carina), ``n0`` and ``n2`` (where the outer walls bend
    most), ``i``, ``a`` (vessel), ``u``, ``v`` (upper branch), ``l``, ``m`` (lower branch) with 0 to 2 upwards; blocks
    ``fluid``; edges ``inlet``, ``upper_outlet``, ``lower_outlet``, ``upper_wall``, ``lower_wall``, ``inner_wall``.

    Parameters
    ----------
    width : float
        Of the vessel.
    upper_width : float
        Of the upper branch.
    lower_width : float
        Of the lower branch.
    upper_angle : float
        By which the upper branch turns up; together with the lower angle from 20 to 170 degrees.
    lower_angle : float
        By which the lower branch turns down; together with the upper angle from 20 to 170 degrees.
    inlet_length : float
        Of the straight vessel.
    upper_length : float
        Of the straight upper branch.
    lower_length : float
        Of the straight lower branch.
    rounding : float
        Length of the outer walls' bends on the vessel's side, and at least on the branches'.
    elements_across : int
        Elements across each half of the vessel and of the branches.
    elements_inlet : int
        Elements along the straight vessel.
    elements_bend : int
        Elements along each half of the bends.
    elements_branch : int
        Elements along each straight branch.
    stretch : float
        Exponential grading across, dense at the walls for positive values.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range, or the branches cannot meet in a carina.
    """
    if not 20.0 <= upper_angle + lower_angle <= 170.0:
        raise TemplateError(
            f"got {upper_angle:g} and lower_angle = {lower_angle:g}; expected a sum from 20 to 170 degrees.",
            "upper_angle",
        )
    branches = {
        1: _Branch(1, width, upper_width, math.radians(upper_angle), upper_length),
        -1: _Branch(-1, width, lower_width, math.radians(lower_angle), lower_length),
    }
    carina = _carina(branches[1], branches[-1])
    if carina[0] < 0.1 * width or abs(carina[1]) > width:
        raise TemplateError(
            f"got {upper_width:g} and lower_width = {lower_width:g}: the carina would lie at ({carina[0]:.3g}, "
            f"{carina[1]:.3g}); expected x >= {0.1 * width:g} and |y| <= {width:g}. Widen the branches, make their "
            "widths more alike, or change their angles.",
            "upper_width",
        )
    draft = Draft()
    _place_vessel(draft, width, upper_width / (upper_width + lower_width), inlet_length, rounding)
    draft.vertex("k", carina)
    bends = {name: _place_branch(draft, branches[side], carina, rounding) for name, side in (("n2", 1), ("n0", -1))}
    _place_junction(draft, bends, 0.25 * (upper_width + lower_width))
    for block in _BLOCKS:
        draft.block("fluid", *block)
    _name_edges(draft)
    for path in ("i2 i1 i0", "k mu n2"):
        draft.count(elements_across, *path.split())
    draft.count(elements_inlet, "i1", "a1")
    draft.count(elements_bend, "a1", "p")
    for path in ("mu u1", "ml l1"):
        draft.count(elements_bend, *path.split())
    for path in ("u1 v1", "l1 m1"):
        draft.count(elements_branch, *path.split())
    middles = (("i2", "i1", "i0"), ("a2", "a1", "a0"), ("n2", "p", "n0"), ("n2", "mu", "k"), ("n0", "ml", "k"))
    ends = [(f"{c}0", f"{c}1", f"{c}2") for c in "uvlm"]
    for first, middle, second in (*middles, *ends):
        draft.grade(Exponential(stretch), (first, middle), (second, middle))
    return draft.structure()


@dataclass(frozen=True)
class _Branch:
    """A branch: upwards (side 1) or downwards (-1)."""

    side: int
    vessel: float
    width: float
    angle: float
    length: float

    @property
    def knee(self) -> Array:
        """Where its outer wall would leave the vessel's wall without a bend."""
        return np.array([0.0, 0.5 * self.side * self.vessel])

    @property
    def along(self) -> Array:
        """Direction of the branch."""
        return np.array([math.cos(self.angle), self.side * math.sin(self.angle)])

    @property
    def outwards(self) -> Array:
        """Direction from its inner wall to the outer one."""
        return np.array([-math.sin(self.angle), self.side * math.cos(self.angle)])


def _carina(upper: _Branch, lower: _Branch) -> Array:
    """Where the inner walls of the branches meet."""
    normals = np.array([upper.outwards, lower.outwards])
    offsets = [branch.outwards @ branch.knee - branch.width for branch in (upper, lower)]
    return np.linalg.solve(normals, offsets)


def _place_vessel(draft: Draft, width: float, upper_share: float, length: float, rounding: float) -> None:
    for name, x in (("i", -rounding - length), ("a", -rounding)):
        for j, y in enumerate((-0.5, 0.5 - upper_share, 0.5)):
            draft.vertex(f"{name}{j}", (x, y * width))


def _place_branch(draft: Draft, branch: _Branch, carina: Array, rounding: float) -> Bezier:
    """Place the ends of a branch; return its outer wall's bend."""
    names, start = ("uv", "a2") if branch.side == 1 else ("lm", "a0")
    begin = max(rounding, float(branch.along @ (carina - branch.knee)) + 0.5 * branch.width)
    for name, distance in zip(names, (begin, begin + branch.length), strict=True):
        outer = branch.knee + distance * branch.along
        for share, j in zip((0.0, 0.5, 1.0), (2, 1, 0) if branch.side == 1 else (0, 1, 2), strict=True):
            draft.vertex(f"{name}{j}", outer - share * branch.width * branch.outwards)
    end = f"{names[0]}{2 if branch.side == 1 else 0}"
    return Bezier(np.array([draft.vertices[start], branch.knee, draft.vertices[end]]))


def _place_junction(draft: Draft, bends: dict[str, Bezier], size: float) -> None:
    """Place what is free between the vessel, the branches and the carina, and cut the outer walls there."""
    fixed = {name: np.array(point) for name, point in draft.vertices.items()}
    cuts = {"n2": ("a2", "u2"), "n0": ("a0", "l0")}

    def positions(unknowns: Array) -> dict[str, Array]:
        free = dict(zip(_FREE, size * unknowns[2:].reshape(-1, 2), strict=True))
        return fixed | free | {name: bends[name](unknowns[k : k + 1])[0] for k, name in enumerate(cuts)}

    def tangents(unknowns: Array) -> dict[tuple[str, str], Array]:
        found: dict[tuple[str, str], Array] = {}
        for k, (name, (first, second)) in enumerate(cuts.items()):
            direction = _direction(bends[name], unknowns[k])
            found |= {(name, second): direction, (name, first): -direction}
        return found

    start = np.array([0.5, 0.5])
    walls = [bends[name](start[:1])[0] for name in cuts]
    mouths = [0.5 * (wall + fixed["k"]) for wall in walls]
    vessel = np.mean(walls, axis=0) - (0.2 * size, 0.0)
    centre = np.mean([vessel, *mouths], axis=0)
    found = balanced(
        positions,
        np.concatenate([start, *(point / size for point in (vessel, centre, *mouths))]),
        _BLOCKS[2:11],
        tangents,
        _FREE,
        size,
    )
    for k, (name, (first, second)) in enumerate(cuts.items()):
        cut = float(np.clip(found[k], 0.1, 0.9))
        draft.vertex(name, bends[name](np.array([cut]))[0])
        draft.curve(first, name, piece(bends[name], 0.0, cut))
        draft.curve(name, second, piece(bends[name], cut, 1.0))
    for name, point in zip(_FREE, size * found[2:].reshape(-1, 2), strict=True):
        draft.vertex(name, point)


def _direction(bend: Bezier, t: float) -> Array:
    """Direction of a parabola at a parameter."""
    legs = np.diff(bend.points, axis=0)
    return np.asarray((1.0 - t) * legs[0] + t * legs[1])


def _name_edges(draft: Draft) -> None:
    for name, path in (
        ("inlet", "i0 i1 i2"),
        ("upper_outlet", "v0 v1 v2"),
        ("lower_outlet", "m0 m1 m2"),
        ("upper_wall", "i2 a2 n2 u2 v2"),
        ("lower_wall", "i0 a0 n0 l0 m0"),
        ("inner_wall", "v0 u0 k l2 m2"),
    ):
        draft.call(name, *path.split())
