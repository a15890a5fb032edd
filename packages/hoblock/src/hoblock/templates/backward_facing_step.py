"""A channel that widens suddenly."""

from __future__ import annotations

from hoblock.blocks import BlockStructure
from hoblock.grading import Cubic, Exponential
from hoblock.templates.draft import Draft
from hoblock.templates.parameters import Count, Length, Stretch
from hoblock.templates.template import template

__all__ = ["backward_facing_step"]


@template
def backward_facing_step(
    *,
    step_height: Length = 1.0,
    inlet_height: Length = 1.0,
    inlet_length: Length = 4.0,
    outlet_length: Length = 20.0,
    elements_inlet: Count = 6,
    elements_outlet: Count = 20,
    elements_upper: Count = 6,
    elements_lower: Count = 6,
    stretch_inlet: Stretch = 1.5,
    stretch_outlet: Stretch = 2.0,
) -> BlockStructure:
    """Channel that widens suddenly; the step's foot is at (0, 0), its edge above.

    Vertices ``p0_1`` to ``p2_2`` of a 3 by 3 grid without ``p0_0``; blocks ``fluid``; edges ``inlet``, ``outlet``,
    ``top``, ``floor`` (before the step), ``step`` (its face) and ``bottom``. The elements cluster at all walls.

    Parameters
    ----------
    step_height : float
        Height of the step.
    inlet_height : float
        Height of the channel before it.
    inlet_length : float
        Length of the channel before the step.
    outlet_length : float
        Length of the channel behind the step.
    elements_inlet : int
        Elements along the channel before the step.
    elements_outlet : int
        Elements along the channel behind the step.
    elements_upper : int
        Elements across the inlet's height.
    elements_lower : int
        Elements across the step's height.
    stretch_inlet : float
        Exponential grading along the channel before the step, dense at the step for positive values.
    stretch_outlet : float
        Exponential grading along the channel behind the step, dense at the step for positive values.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range.
    """
    draft = Draft()
    x = (-inlet_length, 0.0, outlet_length)
    y = (0.0, step_height, step_height + inlet_height)
    draft.grid("fluid", x, y, keep=lambda i, j: (i, j) != (0, 0))
    draft.call("inlet", "p0_1", "p0_2")
    draft.call("outlet", "p2_0", "p2_1", "p2_2")
    draft.call("top", "p0_2", "p1_2", "p2_2")
    draft.call("floor", "p0_1", "p1_1")
    draft.call("step", "p1_0", "p1_1")
    draft.call("bottom", "p1_0", "p2_0")
    draft.count(elements_inlet, "p0_1", "p1_1")
    draft.count(elements_outlet, "p1_1", "p2_1")
    draft.count(elements_upper, "p1_1", "p1_2")
    draft.count(elements_lower, "p1_0", "p1_1")
    draft.grade(Exponential(stretch_inlet), ("p1_1", "p0_1"), ("p1_2", "p0_2"))
    draft.grade(Exponential(stretch_outlet), *((f"p1_{j}", f"p2_{j}") for j in range(3)))
    draft.grade(Cubic(0.6), *((f"p{i}_1", f"p{i}_2") for i in range(3)), ("p1_0", "p1_1"), ("p2_0", "p2_1"))
    return draft.structure()
