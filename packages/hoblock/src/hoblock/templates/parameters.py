"""Parameters of templates: what values they take, in which unit, and what they mean."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from hoblock.curves import Curve
from hoblock.errors import TemplateError

__all__ = [
    "Angle",
    "Bounds",
    "Chords",
    "Count",
    "Example",
    "Fraction",
    "Growth",
    "Length",
    "Parameter",
    "Point",
    "Stretch",
    "parameters_of",
]


Kind = Literal["number", "integer", "boolean", "text", "choice", "point", "curve"]


@dataclass(frozen=True)
class Bounds:
    """Where a number may lie, and its unit in words.

    ``minimum <= number <= maximum`` and ``above < number < below``; None: no limit.
    """

    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    above: float | None = None
    below: float | None = None

    def hold(self, number: float) -> bool:
        """Whether the number lies within."""
        return (
            (self.minimum is None or number >= self.minimum)
            and (self.maximum is None or number <= self.maximum)
            and (self.above is None or number > self.above)
            and (self.below is None or number < self.below)
        )

    def __str__(self) -> str:
        words = ((self.minimum, ">="), (self.above, ">"), (self.maximum, "<="), (self.below, "<"))
        return " and ".join(f"{word} {limit:g}" for limit, word in words if limit is not None)


Length = Annotated[float, Bounds("length", above=0.0)]
"""A positive length, in the unit of the coordinates."""

Point = Annotated[tuple[float, float], Bounds("length")]
"""A point [x, y]."""

Angle = Annotated[float, Bounds("degrees")]
"""An angle in degrees, counter-clockwise."""

Chords = Annotated[float, Bounds("chords", above=0.0)]
"""A positive length, in chords of an airfoil."""

Count = Annotated[int, Bounds("elements", minimum=1)]
"""A number of elements."""

Fraction = Annotated[float, Bounds("", above=0.0, below=1.0)]
"""A number between 0 and 1, both excluded."""

Growth = Annotated[float, Bounds("", above=1.0, maximum=10.0)]
"""Size of an element over that of its neighbour, above 1."""

Stretch = Annotated[float, Bounds("", minimum=-20.0, maximum=20.0)]
"""Parameter a of an exponential grading: the largest element is about exp(|a|) times the smallest; 0: uniform."""


@dataclass(frozen=True)
class Example:
    """A value to show for a parameter that has no single default."""

    value: Any


@dataclass(frozen=True)
class Parameter:
    """A parameter of a template.

    Attributes
    ----------
    name : str
    kind : str
        ``"number"``, ``"integer"``, ``"boolean"``, ``"text"``, ``"choice"``, ``"point"`` or ``"curve"``.
    default : object
        Value when it is not given.
    meaning : str
        What it is, a sentence or more.
    bounds : Bounds
        Limits of a number and its unit.
    choices : tuple of str
        Texts that may be chosen.
    optional : bool
        Whether it may be None.
    example : object
        A value to show, the default if there is one.
    """

    name: str
    kind: Kind
    default: Any
    meaning: str
    bounds: Bounds = Bounds()
    choices: tuple[str, ...] = ()
    optional: bool = False
    example: Any = None

    @property
    def domain(self) -> str:
        """Its values in short, with the unit: ``"number > 0, length"``."""
        noun = {
            "choice": f"one of {', '.join(repr(choice) for choice in self.choices)}",
            "point": "[x, y]",
            "curve": "curve; in a scene [x, y], expressions of s from 0 to 1",
        }.get(self.kind, self.kind)
        limits = f" {self.bounds}" if str(self.bounds) else ""
        unit = f", {self.bounds.unit}" if self.bounds.unit else ""
        return f"{noun}{limits}{unit}"

    @property
    def expected(self) -> str:
        """What values it takes, in words."""
        noun = {
            "number": "a number",
            "integer": "an integer",
            "boolean": "True or False",
            "text": "a text",
            "choice": f"one of {', '.join(repr(choice) for choice in self.choices)}",
            "point": "two numbers (x, y)",
            "curve": "a curve, a function of t in [0, 1]",
        }[self.kind]
        limits = f" {self.bounds}" if str(self.bounds) else ""
        return f"{noun}{limits}{' or None' if self.optional else ''}"

    def checked(self, value: Any) -> Any:
        """Return the value as a plain Python object.

        Raises
        ------
        TemplateError
            If it has the wrong type or is out of range.
        """
        if value is None and self.optional:
            return None
        try:
            return self._converted(value)
        except (TypeError, ValueError):
            raise TemplateError(f"got {value!r}; expected {self.expected}.", self.name) from None

    def _converted(self, value: Any) -> Any:
        match self.kind:
            case "number":
                return self._number(value)
            case "integer":
                if (
                    isinstance(value, bool)
                    or not isinstance(value, int | np.integer)
                    or not self.bounds.hold(int(value))
                ):
                    raise ValueError
                return int(value)
            case "point":
                x, y = value
                return self._number(x), self._number(y)
            case "boolean":
                good = isinstance(value, bool | np.bool_)
            case "choice":
                good = isinstance(value, str) and value in self.choices
            case "text":
                good = isinstance(value, str)
            case "curve":
                good = callable(value)
        if not good:
            raise ValueError
        return value

    def _number(self, value: Any) -> float:
        if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.number):
            raise TypeError
        number = float(value)
        if not math.isfinite(number) or not self.bounds.hold(number):
            raise ValueError
        return number


def parameters_of(function: Callable[..., Any]) -> dict[str, Parameter]:
    """Return the parameters of a template by name, from its annotations and its docstring."""
    hints = get_type_hints(function, include_extras=True)
    meanings = _meanings(inspect.getdoc(function) or "")
    return {
        name: _parameter(name, hints[name], parameter.default, meanings)
        for name, parameter in inspect.signature(function).parameters.items()
    }


def _parameter(name: str, hint: Any, default: Any, meanings: Mapping[str, str]) -> Parameter:
    optional = get_origin(hint) in (Union, UnionType)
    if optional:
        hint = next(part for part in get_args(hint) if part is not type(None))
    notes = getattr(hint, "__metadata__", ())
    bounds = next((note for note in notes if isinstance(note, Bounds)), Bounds())
    example = next((note.value for note in notes if isinstance(note, Example)), default)
    plain = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    choices = get_args(plain) if get_origin(plain) is Literal else ()
    kinds: dict[Any, Kind] = {
        float: "number",
        int: "integer",
        bool: "boolean",
        str: "text",
        tuple[float, float]: "point",
        Curve: "curve",
    }
    kind: Kind = "choice" if choices else kinds[plain]
    return Parameter(name, kind, default, meanings.get(name, ""), bounds, choices, optional, example)


def _meanings(docstring: str) -> dict[str, str]:
    """Descriptions of the parameters of a numpydoc docstring, each on one line; empty without a docstring."""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\S[^\n]*\n-{3,}$|\Z)", docstring, re.MULTILINE | re.DOTALL)
    meanings: dict[str, str] = {}
    for entry in re.finditer(r"^(\w[\w, ]*) : [^\n]*\n((?:[ ]{4}[^\n]*\n?|\n)*)", section[1] if section else "", re.M):
        for name in entry[1].split(", "):
            meanings[name] = " ".join(entry[2].replace("``", "").split())
    return meanings
