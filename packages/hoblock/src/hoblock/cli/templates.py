"""``hoblock templates``: ready block structures, their parameters, scene files that use them."""

from __future__ import annotations

import argparse
import textwrap
from pathlib import Path

from hoblock.cli.command import Command, UsageError
from hoblock.io.template_scene import template_scene
from hoblock.templates import TEMPLATES, Parameter, Template, find_template

__all__ = ["COMMAND"]

_WIDTH = 100


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", nargs="?", metavar="NAME", help="show the parameters of this template")
    parser.add_argument("-o", "--output", metavar="SCENE", help="write a scene file (.toml) with all its parameters")
    parser.add_argument("--force", action="store_true", help="write over a file that exists")


def _run(arguments: argparse.Namespace) -> None:
    if arguments.name is None:
        if arguments.output is not None:
            raise UsageError("-o needs the name of a template: hoblock templates NAME -o SCENE.toml.")
        print(_overview())
        return
    found = find_template(arguments.name)
    if arguments.output is None:
        print(_description(found))
        return
    _write(Path(arguments.output), found, arguments.force)
    print(f"wrote {arguments.output}; look at it with: hoblock check {arguments.output}")


def _write(path: Path, template: Template, force: bool) -> None:
    if path.suffix.lower() != ".toml":
        raise UsageError(f"{path}: suffix is {path.suffix!r}; a scene file ends in .toml.")
    if path.exists() and not force:
        raise UsageError(f"{path} exists; choose another name, or write over it with --force.")
    path.write_text(template_scene(template), encoding="utf-8")


def _overview() -> str:
    width = max(len(name) for name in TEMPLATES)
    rows = [f"{name:<{width}}  {template.summary}" for name, template in TEMPLATES.items()]
    return "\n".join([*rows, "", "hoblock templates NAME describes one, with -o SCENE.toml it writes a scene."])


def _description(template: Template) -> str:
    lines = [f"{template.name}: {template.summary}.", ""]
    for text in template.details:
        lines += [*textwrap.wrap(text, _WIDTH), ""]
    width = max(len(name) for name in template.parameters) + 2
    for parameter in template.parameters.values():
        lines += textwrap.wrap(
            _row(parameter),
            _WIDTH,
            initial_indent=f"  {parameter.name:<{width}}",
            subsequent_indent=" " * (width + 2),
            break_on_hyphens=False,
        )
    return "\n".join(lines)


def _row(parameter: Parameter) -> str:
    default = "" if parameter.default is None else f"{parameter.default!r}. "
    return f"{default}{parameter.meaning} [{parameter.domain}]"


COMMAND = Command(
    "templates", "list ready block structures, describe one, or write a scene file that uses it", _add_arguments, _run
)
