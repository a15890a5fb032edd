"""Templates as a scene states them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hoblock.scene.curves import Formula

__all__ = ["TemplateScene", "TemplateValue"]

TemplateValue = float | bool | str | tuple[float, float] | Formula
"""What a parameter of a template may be: a number, a switch, a text, a point or a curve."""


@dataclass(frozen=True)
class TemplateScene:
    """``[mesh.template]``: a ready block structure in place of vertices and blocks.

    Attributes
    ----------
    name : str
        Name of the template.
    values : mapping of str to TemplateValue
        Parameters that are given; the others have their defaults.
    place : str
        Where it stands in the scene.
    """

    name: str
    values: Mapping[str, TemplateValue]
    place: str
