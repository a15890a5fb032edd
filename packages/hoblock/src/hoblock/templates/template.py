"""A template: a function with named parameters that returns a block structure."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ParamSpec

from hoblock.blocks import BlockStructure
from hoblock.errors import TemplateError
from hoblock.spelling import suggestion
from hoblock.templates.parameters import Parameter, parameters_of

P = ParamSpec("P")

__all__ = ["Template", "template"]


@dataclass(frozen=True)
class Template:
    """A ready block structure with parameters.

    Attributes
    ----------
    name : str
    summary : str
        One line, without a full stop.
    details : tuple of str
        Paragraphs: names of vertices, groups of blocks and edges.
    parameters : mapping of str to Parameter
        In the order of the signature.
    function : callable
        Takes the parameters by keyword, each checked.
    """

    name: str
    summary: str
    details: tuple[str, ...]
    parameters: Mapping[str, Parameter]
    function: Callable[..., BlockStructure]

    @staticmethod
    def of(function: Callable[..., BlockStructure]) -> Template:
        """Describe a function decorated by `template`."""
        described: Template = function.__template__  # type: ignore[attr-defined]
        return described

    def build(self, values: Mapping[str, Any]) -> BlockStructure:
        """Build the block structure for values by name; parameters that are not given have their defaults.

        Raises
        ------
        TemplateError
            If a parameter does not exist, has the wrong type or is out of range, or does not fit the others.
        """
        for name in values:
            if name not in self.parameters:
                known = ", ".join(self.parameters)
                raise TemplateError(
                    f"template {self.name} has no such parameter. {suggestion(name, self.parameters)}"
                    f"Parameters: {known}.",
                    name,
                )
        return self.function(**values)


def template(function: Callable[P, BlockStructure]) -> Callable[P, BlockStructure]:
    """Make a function of keyword parameters a template: its arguments are checked against its annotations."""
    parameters = parameters_of(function)
    signature = inspect.signature(function)

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> BlockStructure:
        for name in kwargs:
            if name not in parameters:
                raise TypeError(
                    f"{function.__name__}() got an unexpected keyword argument {name!r}. "
                    f"{suggestion(name, parameters)}Parameters: {', '.join(parameters)}."
                )
        given = signature.bind(*args, **kwargs).arguments
        values = {name: parameters[name].checked(value) for name, value in given.items()}
        return function(**values)  # type: ignore[call-arg]

    summary, *details = [" ".join(text.split()) for text in _head(function).split("\n\n")]
    described = Template(function.__name__, summary.rstrip("."), tuple(details), parameters, checked)
    checked.__template__ = described  # type: ignore[attr-defined]
    return checked


def _head(function: Callable[..., Any]) -> str:
    """The docstring before its first section, without literal marks; empty if Python has dropped it."""
    return (inspect.getdoc(function) or "").split("\n\nParameters\n", 1)[0].replace("``", "")
