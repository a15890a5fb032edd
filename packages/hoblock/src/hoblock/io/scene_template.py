"""`[mesh.template]`, read into plain data, and the names that its structure brings into the scene."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from hoblock.blocks import BlockStructure
from hoblock.errors import SceneError, TemplateError
from hoblock.io.table import Table
from hoblock.io.values import boolean_of, describe, expression_of, expression_pair_of, pair_of, text_of
from hoblock.scene import Formula, Path, Quad, TemplateScene
from hoblock.scene.template import TemplateValue
from hoblock.templates import TEMPLATES, Parameter

Names = tuple[dict[str, tuple[float, float]], dict[str, tuple[Quad, ...]], dict[str, tuple[Path, ...]]]

__all__ = ["names_of", "read_template"]


def read_template(table: Table, constants: Mapping[str, float]) -> TemplateScene:
    """Read a template; every parameter is checked by itself.

    Parameters
    ----------
    table : Table
    constants : mapping of str to float
        May be used in expressions that stand for numbers.

    Raises
    ------
    SceneError
        If the template or a parameter does not exist, or a value has the wrong type or is out of range.
    """
    found = TEMPLATES[table.string("name", choices=tuple(TEMPLATES))]
    values = {
        name: _read(parameter, table.raw(name), table.place_of(name), constants)
        for name, parameter in found.parameters.items()
        if table.has(name)
    }
    table.finish()
    return TemplateScene(found.name, MappingProxyType(values), table.place)


def _read(parameter: Parameter, value: object, place: str, constants: Mapping[str, float]) -> TemplateValue:
    match parameter.kind:
        case "curve":
            x, y = expression_pair_of(value, place, ("s",), constants)
            return Formula(x, y)
        case "point":
            found: TemplateValue = pair_of(value, place, constants)
        case "boolean":
            found = boolean_of(value, place)
        case "choice":
            found = text_of(value, place, parameter.choices)
        case "text":
            found = text_of(value, place)
        case _:
            found = _number(parameter, value, place, constants)
    try:
        checked: TemplateValue = parameter.checked(found)
    except TemplateError as error:
        raise SceneError(error.problem.rstrip(".").removesuffix(" or None"), place) from error
    return checked


def _number(parameter: Parameter, value: object, place: str, constants: Mapping[str, float]) -> float:
    """Return a number; an expression that gives a whole number counts as an integer."""
    number = expression_of(value, place, (), constants).value
    if parameter.kind == "number":
        return number
    if isinstance(value, float) or not float(number).is_integer():
        raise SceneError(f"got {describe(value)}; expected {parameter.expected}", place)
    return int(number)


def names_of(structure: BlockStructure) -> Names:
    """Vertices, groups of blocks and named edges of a structure, as a scene would state them."""
    topology = structure.topology
    called = topology.vertex_names
    vertices = {name: (float(x), float(y)) for name, (x, y) in zip(called, structure.vertices, strict=True)}
    blocks: dict[str, tuple[Quad, ...]] = {}
    for group, members in topology.block_groups.items():
        corners = [tuple(called[v] for v in topology.quads[block]) for block in members]
        blocks[group] = tuple((a, b, c, d) for a, b, c, d in corners)
    edges: dict[str, tuple[Path, ...]] = {
        name: tuple((called[first], called[second]) for first, second in topology.edges[members])
        for name, members in topology.edge_groups.items()
    }
    return vertices, blocks, edges
