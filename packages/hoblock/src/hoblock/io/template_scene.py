"""A template written as a scene file, every parameter with its default and its meaning."""

from __future__ import annotations

import textwrap
from typing import Any

from hoblock.templates import Parameter, Template

__all__ = ["template_scene"]

_WIDTH = 110


def template_scene(template: Template, order: int = 4) -> str:
    """Text of a scene file that meshes a template.

    Parameters
    ----------
    template : Template
    order : int
        Order of the elements.
    """
    structure = template.function()
    first, second = (structure.topology.vertex_names[v] for v in structure.topology.edges[0])
    lines = [
        *_comment(f"{template.summary}."),
        "#",
        *(line for text in template.details for line in (*_comment(text), "#")),
        '# Values are numbers or expressions of [constants], such as "2*R". Angles are in degrees.',
        "",
        f"title = {_text(template.summary)}",
        "",
        "[mesh]",
        f"order = {order}",
        "",
        "[mesh.template]",
        f"name = {_text(template.name)}",
    ]
    meaning = ""
    for parameter in template.parameters.values():
        if parameter.meaning != meaning:
            meaning = parameter.meaning
            lines += ["", *_comment(_sentence(parameter))]
        lines.append(_assignment(parameter))
    lines += [
        "",
        "# Refine it; one edge stands for its whole chain of opposite edges:",
        "# [[mesh.count]]",
        f'# on = [["{first}", "{second}"]]',
        "# elements = 8",
    ]
    return "\n".join(lines) + "\n"


def _sentence(parameter: Parameter) -> str:
    return f"{parameter.meaning} [{parameter.domain}]"


def _assignment(parameter: Parameter) -> str:
    mark = "# " if parameter.default is None else ""
    return f"{mark}{parameter.name} = {_text(parameter.example)}"


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, tuple):
        return f"[{', '.join(_text(part) for part in value)}]"
    return f"{value:.12g}" if isinstance(value, float) and "." in f"{value:.12g}" else repr(value)


def _comment(text: str) -> list[str]:
    return textwrap.wrap(text, _WIDTH, initial_indent="# ", subsequent_indent="# ", break_on_hyphens=False)
