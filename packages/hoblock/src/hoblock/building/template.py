"""From a template in a scene to its block structure."""

from __future__ import annotations

from typing import Any

from hoblock.blocks import BlockStructure
from hoblock.building.curves import parametric
from hoblock.building.paths import at
from hoblock.errors import SceneError, TemplateError
from hoblock.scene import Formula, TemplateScene
from hoblock.scene.template import TemplateValue
from hoblock.templates import find_template

__all__ = ["build_template"]


def build_template(scene: TemplateScene) -> BlockStructure:
    """Build the block structure of a template.

    Raises
    ------
    SceneError
        If there is no such template, or a parameter does not exist, has the wrong type, is out of range or does not
        fit the others; names the place of the parameter.
    CurveError, GradingError, TopologyError
        If the parameters make a structure that is none.
    """
    values = {name: _value(value) for name, value in scene.values.items()}
    try:
        with at(scene.place):
            return find_template(scene.name).build(values)
    except TemplateError as error:
        place = f"{scene.place}.{error.parameter}" if error.parameter else scene.place
        raise SceneError(error.problem.rstrip("."), place) from error


def _value(value: TemplateValue) -> Any:
    return parametric(value) if isinstance(value, Formula) else value
