"""Templates: ready block structures with parameters."""

from collections.abc import Mapping
from types import MappingProxyType

from hoblock.errors import TemplateError
from hoblock.spelling import listing, suggestion
from hoblock.templates.annulus import annulus
from hoblock.templates.backward_facing_step import backward_facing_step
from hoblock.templates.bifurcation import bifurcation
from hoblock.templates.cavity_with_flexible_bottom import cavity_with_flexible_bottom
from hoblock.templates.cylinder_in_channel import cylinder_in_channel
from hoblock.templates.disc import disc
from hoblock.templates.flag_in_channel import flag_in_channel
from hoblock.templates.l_shape import l_shape
from hoblock.templates.naca_c_grid import naca_c_grid
from hoblock.templates.naca_profile import NacaProfile, NacaSurface
from hoblock.templates.nozzle import nozzle
from hoblock.templates.o_grid_cylinder import o_grid_cylinder
from hoblock.templates.parameters import Bounds, Parameter
from hoblock.templates.rectangle import rectangle
from hoblock.templates.template import Template

__all__ = [
    "TEMPLATES",
    "Bounds",
    "NacaProfile",
    "NacaSurface",
    "Parameter",
    "Template",
    "annulus",
    "backward_facing_step",
    "bifurcation",
    "cavity_with_flexible_bottom",
    "cylinder_in_channel",
    "disc",
    "find_template",
    "flag_in_channel",
    "l_shape",
    "naca_c_grid",
    "nozzle",
    "o_grid_cylinder",
    "rectangle",
]

TEMPLATES: Mapping[str, Template] = MappingProxyType(
    {
        function.__name__: Template.of(function)
        for function in (
            annulus,
            backward_facing_step,
            bifurcation,
            cavity_with_flexible_bottom,
            cylinder_in_channel,
            disc,
            flag_in_channel,
            l_shape,
            naca_c_grid,
            nozzle,
            o_grid_cylinder,
            rectangle,
        )
    }
)
"""All templates by name, in alphabetical order."""


def find_template(name: str) -> Template:
    """Return a template by name.

    Raises
    ------
    TemplateError
        If there is none of that name.
    """
    if name not in TEMPLATES:
        raise TemplateError(
            f"there is no template {name!r}. {suggestion(name, TEMPLATES)}Templates: {listing(TEMPLATES)}."
        )
    return TEMPLATES[name]
