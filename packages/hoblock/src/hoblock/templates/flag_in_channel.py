"""A channel with a body that carries a flag."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc
from hoblock.errors import TemplateError
from hoblock.grading import Exponential
from hoblock.templates.draft import Draft
from hoblock.templates.flag_layout import CIRCLE, COLUMNS, SQUARE, FlagSizes, flag_vertices
from hoblock.templates.parameters import Bounds, Example, Length, Point
from hoblock.templates.template import template

__all__ = ["flag_in_channel"]

_MIRROR = str.maketrans({"t": "b", "b": "t", "T": "B", "B": "T"})
_MIRRORED = {"c1": "c4", "c4": "c1", "c2": "c3", "c3": "c2", "i0": "i3", "i3": "i0", "i1": "i2", "i2": "i1"}

# Numbers of elements on the edges of the upper half: for a circle, for a square.
_COUNTS = {
    ("T0", "m0t"): (3, 3),
    ("at", "aT"): (2, 3),
    ("c2", "c3"): (2, 2),
    ("c1", "c2"): (2, 2),
    ("T0", "c1"): (1, 2),
    ("i1", "ab"): (1, 2),
    ("T5", "B5"): (1, 1),
    ("T0", "T1"): (2, 2),
    ("T1", "T2"): (1, 1),
    ("T2", "T3"): (1, 1),
    ("T3", "T4"): (1, 2),
    ("T4", "T5"): (2, 2),
    ("T5", "q0t"): (2, 3),
    ("q0t", "q1t"): (4, 3),
    ("q1t", "q2t"): (4, 3),
    ("q2t", "q3t"): (3, 3),
}

# Parameters of exponential gradings in the upper half, dense at the first vertex: for a circle, for a square.
_GRADINGS: dict[tuple[float, float], tuple[tuple[str, str], ...]] = {
    (1.2, 1.5): (("c1", "dt"), ("c2", "at"), *((f"T{k}", f"m{k}t") for k in range(6))),
    (1.2, 1.6): (("T5", "T4"), ("T5", "q0t")),
    (1.0, 1.0): (("T0", "T1"),),
    (0.5, 0.5): (("m5t", "r0t"),),
    (1.2, 1.2): (("q0t", "r0t"),),
    (0.6, 0.6): (("q1t", "r1t"), ("at", "i2"), ("aT", "i3")),
    (0.3, 0.3): (("q2t", "r2t"), ("q3t", "r3t")),
    (0.7, 0.7): (("q2t", "q3t"), ("r2t", "r3t"), ("r2T", "r3T")),
    (0.0, 1.6): (*((f"{column}t", f"{column}T") for column in COLUMNS), ("i2", "i3")),
}


def _mirror(name: str) -> str:
    return _MIRRORED.get(name) or name.translate(_MIRROR)


@template
def flag_in_channel(
    *,
    body: Literal["circle", "square"] = "circle",
    length: Annotated[Length, Example(2.5)] | None = None,
    height: Annotated[Length, Example(0.41)] | None = None,
    center: Annotated[Point, Example((0.2, 0.2))] | None = None,
    size: Annotated[Length, Example(0.1)] | None = None,
    flag_length: Annotated[Length, Example(0.35)] | None = None,
    flag_thickness: Annotated[Length, Example(0.02)] | None = None,
    refine: Annotated[int, Bounds("", minimum=1, maximum=100)] = 1,
) -> BlockStructure:
    """Channel with a circle or a square that carries a flag, for fluid-structure interaction.

    By default the geometry of Turek and Hron (circle, metres) or of Wall and Ramm (square, centimetres). 57 blocks:
    groups ``fluid`` and ``solid``; edges ``inlet``, ``outlet``, ``top``, ``bottom``, ``cylinder`` or ``square``,
    ``flag`` (interface of fluid and solid) and ``clamp``. Vertices: ``T0`` to ``T5`` and ``B0`` to ``B5`` on the flag,
    ``c1`` to ``c4`` on the body, columns ``a``, ``d``, ``m0`` … ``m5``, ``r0`` … ``r3`` with ``B``, ``b``, ``t``, ``T``
    for bottom, mid lines and top, ``q0`` … ``q3`` behind the flag, ``i0`` to ``i3`` on the inlet.

    Parameters
    ----------
    body : str
        The body's shape.
    length : float or None
        Of the channel, which begins at (0, 0). Default 2.5 (circle) or 19.5 (square).
    height : float or None
        Of the channel. Default 0.41 or 12.
    center : (float, float) or None
        Centre of the body. Default (0.2, 0.2) or (5, 6).
    size : float or None
        Diameter of the circle or side of the square. Default 0.1 or 1.
    flag_length : float or None
        From the body's rearmost point to the tip. Default 0.35 or 4.
    flag_thickness : float or None
        Of the flag. Default 0.02 or 0.06.
    refine : int
        Factor on all numbers of elements.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range, or body and flag do not fit into the channel.

    References
    ----------
    S. Turek, J. Hron, Proposal for numerical benchmarking of fluid-structure interaction between an elastic object and
    laminar incompressible flow, LNCSE 53 (2006) 371–385, doi:10.1007/3-540-34596-5_15; W. A. Wall, E. Ramm,
    Fluid-structure interaction based upon a stabilized (ALE) finite element method, 4th World Congress on
    Computational Mechanics, Buenos Aires (1998).
    """
    square = body == "square"
    known = (SQUARE if square else CIRCLE).sizes
    sizes = FlagSizes(
        known.length if length is None else length,
        known.height if height is None else height,
        known.center if center is None else center,
        known.size if size is None else size,
        known.flag_length if flag_length is None else flag_length,
        known.flag_thickness if flag_thickness is None else flag_thickness,
    )
    _check_sizes(sizes)
    draft = Draft()
    for name, point in flag_vertices(sizes, square).items():
        draft.vertex(name, point)
    _add_blocks(draft)
    _name_edges(draft, "square" if square else "cylinder")
    if not square:
        for first, second in [*draft.names["cylinder"], *draft.names["clamp"]]:
            ends = (draft.vertices[str(first)], draft.vertices[str(second)])
            draft.curve(str(first), str(second), Arc.from_center(sizes.center, *ends))
    for (first, second), elements in _COUNTS.items():
        draft.count(refine * elements[square], first, second)
        draft.count(refine * elements[square], _mirror(first), _mirror(second))
    for a, pairs in _GRADINGS.items():
        draft.grade(Exponential(a[square]), *pairs, *((_mirror(first), _mirror(second)) for first, second in pairs))
    return draft.structure()


def _check_sizes(sizes: FlagSizes) -> None:
    (x, y), half = sizes.center, 0.5 * sizes.size
    if not (half < x and half < y < sizes.height - half):
        raise TemplateError(
            f"got ({x:g}, {y:g}); a body of size {sizes.size:g} there touches the inlet or a wall of the channel of "
            f"height {sizes.height:g}. Move it or make it smaller.",
            "center",
        )
    if sizes.tip >= sizes.length:
        raise TemplateError(
            f"got {sizes.flag_length:g}: the flag ends at x = {sizes.tip:g}; expected less than length = "
            f"{sizes.length:g}. Shorten it or lengthen the channel.",
            "flag_length",
        )
    if sizes.flag_length < 0.5 * sizes.size:
        raise TemplateError(
            f"got {sizes.flag_length:g}; expected at least half of size = {sizes.size:g}.", "flag_length"
        )
    if sizes.flag_thickness > 0.5 * sizes.size:
        raise TemplateError(
            f"got {sizes.flag_thickness:g}; expected at most half of size = {sizes.size:g}.", "flag_thickness"
        )


def _add_blocks(draft: Draft) -> None:
    upper = [(f"{x}t", f"{y}t", f"{y}T", f"{x}T") for x, y in pairwise(COLUMNS)]
    upper += [("c1", "T0", "m0t", "dt"), ("c2", "c1", "dt", "at"), ("i2", "at", "aT", "i3")]
    upper += [(f"T{k}", f"T{k + 1}", f"m{k + 1}t", f"m{k}t") for k in range(5)]
    upper += [("T5", "q0t", "r0t", "m5t"), *((f"q{k}t", f"q{k + 1}t", f"r{k + 1}t", f"r{k}t") for k in range(3))]
    centre = [("i1", "ab", "at", "i2"), ("ab", "c3", "c2", "at"), ("B5", "q0b", "q0t", "T5")]
    centre += [(f"q{k}b", f"q{k + 1}b", f"q{k + 1}t", f"q{k}t") for k in range(3)]
    for a, b, c, d in upper:
        draft.block("fluid", a, b, c, d)
        draft.block("fluid", *(_mirror(name) for name in (d, c, b, a)))
    for a, b, c, d in centre:
        draft.block("fluid", a, b, c, d)
    for k in range(5):
        draft.block("solid", f"B{k}", f"B{k + 1}", f"T{k + 1}", f"T{k}")


def _name_edges(draft: Draft, body: str) -> None:
    flag: list[Any] = [f"T{k}" for k in range(6)]
    draft.call("inlet", "i0", "i1", "i2", "i3")
    draft.call("outlet", "r3B", "r3b", "q3b", "q3t", "r3t", "r3T")
    draft.call("top", "i3", *(f"{column}T" for column in COLUMNS))
    draft.call("bottom", "i0", *(f"{column}B" for column in COLUMNS))
    draft.call(body, "T0", "c1", "c2", "c3", "c4", "B0")
    draft.call("flag", *flag, *(_mirror(name) for name in reversed(flag)))
    draft.call("clamp", "B0", "T0")
