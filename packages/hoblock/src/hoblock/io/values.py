"""Single values of a parsed TOML file: checked, or refused in words, with their place."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from hoblock.errors import SceneError
from hoblock.expressions import Expression, compile_expression
from hoblock.spelling import listing, suggestion

__all__ = [
    "Limits",
    "boolean_of",
    "describe",
    "expression_of",
    "expression_pair_of",
    "integer_of",
    "names_of",
    "number_of",
    "number_or_constant_of",
    "pair_of",
    "path_of",
    "paths_of",
    "place_of",
    "text_of",
]

T = TypeVar("T")
_A_PATH = 'a path such as ["a", "b", "c"]'
_PATHS = 'a list of paths such as [["a", "b", "c"]]'


@dataclass(frozen=True)
class Limits:
    """Where a number may lie: ``minimum <= number <= maximum`` and ``above < number < below``; None: no limit."""

    minimum: float | None = None
    maximum: float | None = None
    above: float | None = None
    below: float | None = None

    def hold(self, number: float) -> bool:
        """Whether the number lies within the limits."""
        return (
            (self.minimum is None or number >= self.minimum)
            and (self.maximum is None or number <= self.maximum)
            and (self.above is None or number > self.above)
            and (self.below is None or number < self.below)
        )

    def __str__(self) -> str:
        words = (
            (self.minimum, "of at least"),
            (self.above, "above"),
            (self.maximum, "of at most"),
            (self.below, "below"),
        )
        return " and ".join(f"{word} {limit:g}" for limit, word in words if limit is not None)


def place_of(place: str, key: str) -> str:
    """Place of a key in a table at ``place``; keys that TOML must quote are quoted."""
    name = key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else '"' + key.replace('"', '\\"') + '"'
    return f"{place}.{name}" if place else name


def describe(value: object) -> str:
    """Put a value in words, for "got ..." in messages: ``"the text 'heavy'"``."""
    if isinstance(value, bool):
        return f"the boolean {str(value).lower()}"
    if isinstance(value, str):
        return f"the text {value if len(value) <= 60 else value[:57] + '...'!r}"
    if isinstance(value, int | float):
        return f"the number {value:.17g}"
    if isinstance(value, list):
        return f"a list of {len(value)}" if value else "an empty list"
    if isinstance(value, Mapping):
        return "a table"
    return f"a {type(value).__name__} ({value})"


def number_of(value: object, place: str, limits: Limits | None = None, expected: str = "a number") -> float:
    """Return a finite number within limits; booleans and texts are none."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise SceneError(f"got {describe(value)}; expected {expected}", place)
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise SceneError(f"got {number}; expected {expected} that is finite", place)
    if limits is not None and not limits.hold(number):
        raise SceneError(f"got {value!r}; expected {expected} {limits}", place)
    return number


def integer_of(value: object, place: str, limits: Limits | None = None) -> int:
    """Return an integer within limits; booleans and numbers such as 2.0 are none."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise SceneError(f"got {describe(value)}; expected an integer", place)
    if limits is not None and not limits.hold(value):
        raise SceneError(f"got {value}; expected an integer {limits}", place)
    return value


def boolean_of(value: object, place: str) -> bool:
    """Return true or false."""
    if not isinstance(value, bool):
        raise SceneError(f"got {describe(value)}; expected true or false", place)
    return value


def text_of(value: object, place: str, choices: Sequence[str] | None = None) -> str:
    """Return a text, one of ``choices`` if they are given."""
    expected = "a text" if choices is None else f"one of {listing(choices)}"
    if not isinstance(value, str):
        raise SceneError(f"got {describe(value)}; expected {expected}", place)
    if choices is not None and value not in choices:
        raise SceneError(f"got {value!r}. {suggestion(value, choices)}Expected {expected}", place)
    return value


def names_of(value: object, place: str) -> tuple[str, ...]:
    """Return the names of a list, or a single name; at least one, none twice."""
    expected = "a name or a list of names"
    if isinstance(value, str):
        return (_name(value, place),)
    names = _items(value, place, _name, expected)
    if not names:
        raise SceneError(f"got an empty list; expected {expected}", place)
    for name in names:
        if names.count(name) > 1:
            raise SceneError(f"{name!r} is listed more than once; name it once", place)
    return names


def pair_of(value: object, place: str, constants: Mapping[str, float] | None = None) -> tuple[float, float]:
    """Return ``[x, y]``; with constants, expressions of these may stand for the numbers."""

    def coordinate(part: object, place: str) -> float:
        return number_of(part, place) if constants is None else number_or_constant_of(part, place, constants)

    x, y = _two(value, place, coordinate)
    return x, y


def number_or_constant_of(
    value: object, place: str, constants: Mapping[str, float], limits: Limits | None = None
) -> float:
    """Return a finite number within limits; an expression of the constants may stand for it."""
    expected = "a number or an expression of the constants"
    if isinstance(value, str):
        value = compile_expression(value, (), constants, place).value
    return number_of(value, place, limits, expected)


def expression_of(
    value: object, place: str, variables: Sequence[str], constants: Mapping[str, float] | None = None
) -> Expression:
    """Return an expression of the variables and constants; a number is one."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise SceneError(f"got {describe(value)}; expected a number or an expression", place)
    return compile_expression(value, variables, constants, place)


def expression_pair_of(
    value: object, place: str, variables: Sequence[str], constants: Mapping[str, float] | None = None
) -> tuple[Expression, Expression]:
    """Return ``[x, y]``, two expressions or numbers."""
    x, y = _two(value, place, lambda part, where: expression_of(part, where, variables, constants))
    return x, y


def paths_of(value: object, place: str) -> tuple[tuple[str, ...], ...]:
    """Return a list of paths, each a list of at least two names; neighbours in a path differ."""
    if isinstance(value, list) and value and all(isinstance(part, str) for part in value):
        raise SceneError(f"got a list of names; expected {_PATHS}. Put one more pair of brackets around it", place)
    paths = _items(value, place, path_of, _PATHS)
    if not paths:
        raise SceneError(f"got an empty list; expected {_PATHS}", place)
    return paths


def path_of(value: object, place: str) -> tuple[str, ...]:
    """Return a path, a list of at least two names; neighbours differ."""
    path = _items(value, place, _name, _A_PATH)
    if len(path) < 2:
        raise SceneError(f"got a path of {len(path)} name(s); expected at least two", place)
    for first, second in itertools.pairwise(path):
        if first == second:
            raise SceneError(f"the path goes from {first!r} to itself; name every vertex once in a row", place)
    return path


def _name(value: object, place: str) -> str:
    if not isinstance(value, str):
        raise SceneError(f"got {describe(value)}; expected a name", place)
    if not value.strip():
        raise SceneError("got an empty name; expected a name", place)
    return value


def _items(value: object, place: str, read: Callable[[object, str], T], expected: str) -> tuple[T, ...]:
    if not isinstance(value, list):
        raise SceneError(f"got {describe(value)}; expected {expected}", place)
    return tuple(read(part, f"{place}[{k}]") for k, part in enumerate(value))


def _two(value: object, place: str, read: Callable[[object, str], T]) -> tuple[T, ...]:
    if not isinstance(value, list) or len(value) != 2:
        raise SceneError(f"got {describe(value)}; expected two values [x, y]", place)
    return _items(value, place, read, "two values [x, y]")
