"""A C-grid around an airfoil and its wake."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, Displaced
from hoblock.errors import TemplateError, TopologyError
from hoblock.grading import BoundaryLayer, Exponential
from hoblock.grading.layer_heights import layer_elements
from hoblock.templates.draft import Draft
from hoblock.templates.layer import wall_layer
from hoblock.templates.naca_profile import NacaProfile, NacaSurface
from hoblock.templates.parameters import Bounds, Chords, Count, Growth, Length
from hoblock.templates.spacing import first_size, with_first_size
from hoblock.templates.template import template

Array = NDArray[np.float64]

__all__ = ["naca_c_grid"]

_FAR_SHARE = 0.65
"""Share of the quarter of the C that belongs to the front of the airfoil."""

_FAR_SIZE = 0.02
"""Length of the elements on the far field next to the trailing edge's line, over the far field's radius."""

_WAKE_SPREAD = 3.0
"""Thickness of the layer at the outflow over that on the airfoil."""


@template
def naca_c_grid(
    *,
    digits: str = "0012",
    chord: Length = 1.0,
    angle_of_attack: Annotated[float, Bounds("degrees", minimum=-30.0, maximum=30.0)] = 0.0,
    closed: bool = True,
    far_field_radius: Chords = 15.0,
    wake_length: Chords = 15.0,
    first_height: Chords = 1e-4,
    growth: Growth = 1.5,
    layer: Chords = 0.25,
    trailing_edge_size: Chords = 0.01,
    elements_airfoil: Annotated[int, Bounds("elements", minimum=4, maximum=100_000)] = 20,
    elements_wake: Count = 16,
    elements_base: Count = 1,
) -> BlockStructure:
    """C-grid around an airfoil of the NACA four-digit series, with a boundary layer normal to its surface.

    The nose is at (0, 0), the chord on the x axis; the angle of attack turns the airfoil about its quarter-chord point,
    far field and wake stay. A layer of blocks follows the surface at a constant distance: its lines are normal to the
    wall, and every element on the wall has the first height. Vertices: ``n`` (nose), ``mu`` and ``ml`` (upper and lower
    surface), ``t`` (trailing edge; ``tu`` and ``tl`` if it is blunt), ``w`` (end of the wake; ``wu`` and ``wl``); at
    the edge of the layer ``en``, ``emu``, ``etu``, ``ewu``, …, on the far field ``fn``, ``fmu``, ``ftu``, ``fwu``, ….
    Blocks ``fluid``; edges ``airfoil``, ``inflow`` (the C), ``far_field`` (top and bottom), ``outflow`` and ``wake``
    (the cut behind the airfoil).

    Parameters
    ----------
    digits : str
        The four digits: camber, its position, thickness; a symmetric airfoil begins with 00.
    chord : float
        Length of the airfoil.
    angle_of_attack : float
        By which the nose turns up.
    closed : bool
        A sharp trailing edge (last coefficient of the thickness -0.1036) or the original blunt one (-0.1015).
    far_field_radius : float
        Of the half circle about (chord, 0).
    wake_length : float
        From the trailing edge of the airfoil at rest to the outflow.
    first_height : float
        Height of the elements on the airfoil. It is kept when counts change or the airfoil moves.
    growth : float
        Largest height of an element over that of the one below it; the numbers of elements normal to the
        wall follow from it.
    layer : float
        Thickness of the layer with normal lines.
    trailing_edge_size : float
        Length of the elements at the trailing edge.
    elements_airfoil : int
        Elements along each surface, upper and lower.
    elements_wake : int
        Elements along the wake.
    elements_base : int
        Elements across a blunt trailing edge.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range, or the lengths are out of order.
    """
    try:
        profile = NacaProfile.from_digits(digits, chord, math.radians(angle_of_attack), closed)
    except ValueError as error:
        raise TemplateError(f"got {digits!r}; {error}.", "digits") from None
    _check_order(far_field_radius, first_height, layer, trailing_edge_size)
    grid = _CGrid(profile, far_field_radius * chord, wake_length * chord, layer * chord)
    grid.place_layer()
    grid.place_far_field()
    grid.add_blocks()
    grid.name_edges()
    grid.grade_along(elements_airfoil, elements_wake, trailing_edge_size)
    grid.grade_across(first_height * chord, growth)
    if not closed:
        grid.draft.count(elements_base, "tl", "tu")
    try:
        return grid.draft.structure()
    except TopologyError as error:
        raise TemplateError(
            f"got {digits!r} with layer = {layer:g}: a line at that distance from so strongly curved a surface turns "
            "over. Take a thinner layer or less camber.",
            "digits",
        ) from error


def _check_order(radius: float, first_height: float, layer: float, trailing_edge_size: float) -> None:
    if first_height >= layer:
        raise TemplateError(f"got {first_height:g}; expected less than layer = {layer:g}.", "first_height")
    if layer > 0.5:
        raise TemplateError(f"got {layer:g}; expected at most 0.5 chords.", "layer")
    if radius < 2.0:
        raise TemplateError(f"got {radius:g}; expected at least 2 chords.", "far_field_radius")
    if trailing_edge_size > 0.2:
        raise TemplateError(f"got {trailing_edge_size:g}; expected at most 0.2 chords.", "trailing_edge_size")


class _CGrid:
    """The grid in the making; ``u`` and ``l`` are the upper and lower sides."""

    def __init__(self, profile: NacaProfile, radius: float, wake: float, layer: float) -> None:
        self.draft = Draft()
        self.profile, self.radius, self.layer = profile, radius, layer
        self.outflow = profile.chord + wake
        self.tail = {"u": "t", "l": "t"} if profile.closed else {"u": "tu", "l": "tl"}
        self.wake = {"u": "w", "l": "w"} if profile.closed else {"u": "wu", "l": "wl"}

    def place_layer(self) -> None:
        """Place the airfoil, its wake and the line at a constant distance."""
        draft, profile = self.draft, self.profile
        for side, sign in (("u", 1), ("l", -1)):
            middle, tail, wake = f"m{side}", self.tail[side], self.wake[side]
            edges = {"": ("n", middle, tail), "e": ("en", f"em{side}", f"et{side}")}
            for distance, (nose, mid, end) in zip((0.0, self.layer), edges.values(), strict=True):
                front, rear = (NacaSurface(profile, sign, part, distance) for part in (False, True))
                first, second = front(np.array([0.0, 1.0])), rear(np.array([0.0, 1.0]))
                if nose not in draft.vertices:
                    draft.vertex(nose, first[0])
                draft.vertex(mid, second[0])
                if end not in draft.vertices:
                    draft.vertex(end, second[1])
                # Behind the top of the camber line the normal turns by a tiny angle; the line shall not jump there.
                gap = second[0] - first[1]
                draft.curve(nose, mid, Displaced(front, (0.0, 0.0), (float(gap[0]), float(gap[1]))))
                draft.curve(mid, end, rear)
            height = draft.vertices[tail][1]
            spread = 0.0 if profile.closed else 0.1 * self.layer
            draft.vertex(wake, (self.outflow, height + sign * spread))
            draft.vertex(f"ew{side}", (self.outflow, height + sign * (spread + _WAKE_SPREAD * self.layer)))

    def place_far_field(self) -> None:
        """Place the vertices of the far field, and its arcs."""
        draft, center, angle = self.draft, (self.profile.chord, 0.0), self.profile.angle
        right = 0.5 * math.pi
        directions = {
            "fn": angle,
            "fmu": angle + _FAR_SHARE * (right - angle),
            "ftu": right,
            "fml": angle - _FAR_SHARE * (right + angle),
            "ftl": -right,
        }
        for name, phi in directions.items():
            x = 0.0 if abs(phi) == right else math.cos(phi)
            draft.vertex(name, (center[0] - self.radius * x, self.radius * math.sin(phi)))
        for side, sign in (("u", 1), ("l", -1)):
            draft.vertex(f"fw{side}", (self.outflow, sign * self.radius))
            for first, second in (("fn", f"fm{side}"), (f"fm{side}", f"ft{side}")):
                draft.curve(first, second, Arc.from_center(center, *(draft.vertices[v] for v in (first, second))))

    def add_blocks(self) -> None:
        """Add the blocks of the layer, those around it, and the strip behind a blunt trailing edge."""
        for side in "ul":
            stations = ("n", f"m{side}", self.tail[side], self.wake[side])
            edge = ("en", f"em{side}", f"et{side}", f"ew{side}")
            far = ("fn", f"fm{side}", f"ft{side}", f"fw{side}")
            for inner, outer in ((stations, edge), (edge, far)):
                for k in range(3):
                    quad = (inner[k], inner[k + 1], outer[k + 1], outer[k])
                    self.draft.block("fluid", *(quad if side == "u" else quad[::-1]))
        if not self.profile.closed:
            self.draft.block("fluid", "tl", "wl", "wu", "tu")

    def name_edges(self) -> None:
        """Name the boundary and the wake."""
        draft, tail, wake = self.draft, self.tail, self.wake
        draft.call("airfoil", tail["l"], "ml", "n", "mu", tail["u"])
        draft.call("inflow", "ftl", "fml", "fn", "fmu", "ftu")
        draft.call("far_field", "ftu", "fwu")
        draft.call("far_field", "ftl", "fwl")
        draft.call("outflow", "fwl", "ewl", wake["l"])
        draft.call("outflow", wake["u"], "ewu", "fwu")
        draft.call("wake", tail["u"], wake["u"])
        if not self.profile.closed:
            draft.call("airfoil", "tl", "tu")
            draft.call("outflow", "wl", "wu")
            draft.call("wake", "tl", "wl")

    def grade_along(self, elements: int, elements_wake: int, tail_size: float) -> None:
        """Distribute elements along the airfoil, dense at nose and trailing edge, and along the wake."""
        front, rear = self._split(elements, tail_size)
        for side in "ul":
            tail, wake = self.tail[side], self.wake[side]
            self.draft.count(front[0], "n", f"m{side}")
            self.draft.count(rear[0], f"m{side}", tail)
            self.draft.count(elements_wake, tail, wake)
            self.draft.grade(front[1], ("n", f"m{side}"), ("en", f"em{side}"))
            self.draft.grade(rear[1], (tail, f"m{side}"), (f"et{side}", f"em{side}"))
            self._grade_wake(side, elements_wake, tail_size, rear[0])

    def _grade_wake(self, side: str, elements: int, tail_size: float, rear: int) -> None:
        """Let elements grow along the wake; on the far field they are less dense behind the trailing edge."""
        length, chord = self.outflow - self.profile.chord, self.profile.chord
        near = with_first_size(length, elements, min(tail_size * chord, length / elements))
        self.draft.grade(near, (self.tail[side], self.wake[side]), (f"et{side}", f"ew{side}"))
        arc = (1.0 - _FAR_SHARE) * 0.5 * math.pi * self.radius
        far_size = max(tail_size * chord, _FAR_SIZE * self.radius)
        self.draft.grade(with_first_size(arc, rear, min(far_size, arc / rear)), (f"ft{side}", f"fm{side}"))
        self.draft.grade(
            with_first_size(length, elements, min(far_size, length / elements)), (f"ft{side}", f"fw{side}")
        )

    def _split(self, elements: int, tail_size: float) -> tuple[tuple[int, Exponential], tuple[int, Exponential]]:
        """Numbers of elements of front and rear with their gradings, such that sizes agree where they meet.

        Sizes are lengths in √x. At the nose one element turns by about 11 degrees, or less if there are many.
        """
        split = self.profile.split
        found = []
        for front in range(2, elements - 1):
            rear = elements - front
            nose = with_first_size(split, front, min(0.1 * self.profile.nose_slope, split / front))
            tail = with_first_size(1.0 - split, rear, min(0.5 * tail_size, (1.0 - split) / rear))
            sizes = (split * first_size(-nose.a, front), (1.0 - split) * first_size(-tail.a, rear))
            found.append((abs(math.log(sizes[0] / sizes[1])), front, nose, tail))
        _, front, nose, tail = min(found, key=lambda entry: entry[:2])
        return (front, nose), (elements - front, tail)

    def grade_across(self, first_height: float, growth: float) -> None:
        """Distribute elements away from the airfoil and the wake."""
        draft, layer = self.draft, self.layer
        inner, grading = wall_layer(layer, first_height, growth)
        heights = grading.heights(layer, inner)
        beyond = BoundaryLayer(float(min(heights[-1] * growth, 0.5 * self.radius)))
        outer = max(2, layer_elements(beyond.first_height, growth, self.radius - layer))
        steepness = 0.5 * math.log(max(float(heights[-1] / heights[0]), 1.0))
        for side in "ul":
            stations = ("n", f"m{side}", self.tail[side])
            for station in stations:
                name = station if station in ("n", f"m{side}") else f"t{side}"
                draft.grade(grading, (station, f"e{name}"))
                draft.grade(beyond, (f"e{name}", f"f{name}"))
            draft.grade(Exponential(steepness), (self.wake[side], f"ew{side}"))
            draft.grade(beyond, (f"ew{side}", f"fw{side}"))
        draft.count(inner, "n", "en")
        draft.count(outer, "en", "fn")
