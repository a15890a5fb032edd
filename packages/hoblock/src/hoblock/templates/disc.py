"""A filled circle."""

from __future__ import annotations

import math

import numpy as np

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc
from hoblock.grading import Exponential
from hoblock.templates.draft import Draft
from hoblock.templates.parameters import Count, Fraction, Length, Point, Stretch
from hoblock.templates.template import template

__all__ = ["disc"]

_BULGE = 0.5 * math.tan(math.radians(7.5))
"""Sagitta of the sides of the inner block over their length: three equal angles meet at each of its corners."""


@template
def disc(
    *,
    radius: Length = 1.0,
    center: Point = (0.0, 0.0),
    core: Fraction = 0.5,
    elements: Count = 4,
    elements_radial: Count = 3,
    stretch: Stretch = 0.0,
) -> BlockStructure:
    """Filled circle: an inner block with bulging sides and a ring of four around it.

    Vertices ``q1`` to ``q4`` (inner block) and ``c1`` to ``c4`` (circle) at 45, 135, 225 and 315 degrees; blocks
    ``domain``; edges ``circle``.

    Parameters
    ----------
    radius : float
        Of the circle.
    center : (float, float)
        Its centre.
    core : float
        Half a diagonal of the inner block over the radius.
    elements : int
        Elements across the inner block, and along each quarter of the circle.
    elements_radial : int
        Elements from the inner block to the circle.
    stretch : float
        Exponential grading of these, dense at the circle for positive values.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range.
    """
    draft = Draft()
    for k in range(4):
        direction = np.array([math.cos(math.radians(45 + 90 * k)), math.sin(math.radians(45 + 90 * k))])
        draft.vertex(f"q{k + 1}", center + core * radius * direction)
        draft.vertex(f"c{k + 1}", center + radius * direction)
    draft.block("domain", "q3", "q4", "q1", "q2")
    for k, j in ((1, 2), (2, 3), (3, 4), (4, 1)):
        draft.block("domain", f"q{k}", f"c{k}", f"c{j}", f"q{j}")
        inner = np.array([draft.vertices[f"q{k}"], draft.vertices[f"q{j}"]])
        outer = [np.array(draft.vertices[f"c{n}"]) for n in (k, j)]
        chord = inner[1] - inner[0]
        middle = inner.mean(axis=0) + _BULGE * np.array([chord[1], -chord[0]])
        draft.curve(f"q{k}", f"q{j}", Arc.through(inner[0], middle, inner[1]))
        draft.curve(f"c{k}", f"c{j}", Arc.from_center(center, outer[0], outer[1]))
    draft.call("circle", "c1", "c2", "c3", "c4", "c1")
    draft.count(elements, "q1", "q2", "q3")
    draft.count(elements_radial, "q1", "c1")
    draft.grade(Exponential(stretch), *((f"c{k}", f"q{k}") for k in range(1, 5)))
    return draft.structure()
