"""Typed reading of one table of a scene, with the place of every mistake."""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final, TypeVar

from hoblock.errors import SceneError
from hoblock.expressions import Expression
from hoblock.io.values import (
    Limits,
    boolean_of,
    describe,
    expression_of,
    expression_pair_of,
    integer_of,
    names_of,
    number_of,
    pair_of,
    paths_of,
    place_of,
    text_of,
)
from hoblock.spelling import suggestion

__all__ = ["REQUIRED", "Required", "Table"]

T = TypeVar("T")
V = TypeVar("V")


class Required(enum.Enum):
    """Marks a key without a default value."""

    REQUIRED = "required"


REQUIRED: Final = Required.REQUIRED
"""The default of a key that must be present."""


class Table:
    """One table of a parsed TOML file, read key by key.

    Every method that reads a key also makes it known; `finish` then reports the keys nobody asked for. A missing
    key gives its default as it is, or a `SceneError` if it has none. A boolean never counts as a number, nor does
    a text; NaN and infinities are refused.

    Parameters
    ----------
    data : mapping
        The table as a TOML parser gives it.
    place : str
        Where the table stands, for example ``"fluid.boundary[2]"``; empty for the whole file.

    Raises
    ------
    SceneError
        By all methods, with the place, if a key is missing or its value has the wrong type or is out of range.
    """

    def __init__(self, data: Mapping[str, Any], place: str = "") -> None:
        if not isinstance(data, Mapping):
            raise SceneError(f"got {describe(data)}; expected a table", place)
        self.place = place
        self._data = data
        self._known: dict[str, None] = {}

    def place_of(self, key: str) -> str:
        """Place of a key of this table."""
        return place_of(self.place, key)

    def __iter__(self) -> Iterator[str]:
        """All keys present, in the order of the file. They do not become known."""
        return iter(self._data)

    def has(self, key: str) -> bool:
        """Whether the key is present. It becomes known."""
        self._known[key] = None
        return key in self._data

    def number(
        self,
        key: str,
        default: T | Required = REQUIRED,
        *,
        positive: bool = False,
        minimum: float | None = None,
        maximum: float | None = None,
        above: float | None = None,
        below: float | None = None,
    ) -> float | T:
        """Read a finite number with ``minimum <= number <= maximum`` and ``above < number < below``."""
        limits = Limits(minimum, maximum, 0.0 if positive and above is None else above, below)
        return self._read(key, default, lambda value, place: number_of(value, place, limits))

    def integer(
        self,
        key: str,
        default: T | Required = REQUIRED,
        *,
        minimum: int | None = None,
        maximum: int | None = None,
    ) -> int | T:
        """Read an integer with ``minimum <= integer <= maximum``."""
        limits = Limits(minimum, maximum)
        return self._read(key, default, lambda value, place: integer_of(value, place, limits))

    def boolean(self, key: str, default: T | Required = REQUIRED) -> bool | T:
        """Read ``true`` or ``false``."""
        return self._read(key, default, boolean_of)

    def string(self, key: str, default: T | Required = REQUIRED, *, choices: Sequence[str] | None = None) -> str | T:
        """Read a text, one of ``choices`` if they are given."""
        return self._read(key, default, lambda value, place: text_of(value, place, choices))

    def names(self, key: str, default: T | Required = REQUIRED) -> tuple[str, ...] | T:
        """Read one name or a list of names, at least one, none twice."""
        return self._read(key, default, names_of)

    def pair(
        self, key: str, default: T | Required = REQUIRED, *, constants: Mapping[str, float] | None = None
    ) -> tuple[float, float] | T:
        """Read ``[x, y]``; with ``constants``, expressions of these may stand for the numbers."""
        return self._read(key, default, lambda value, place: pair_of(value, place, constants))

    def expression(
        self,
        key: str,
        variables: Sequence[str],
        constants: Mapping[str, float] | None = None,
        default: T | Required = REQUIRED,
    ) -> Expression | T:
        """Read an expression of the variables and constants, or a number."""
        return self._read(key, default, lambda value, place: expression_of(value, place, variables, constants))

    def expression_pair(
        self,
        key: str,
        variables: Sequence[str],
        constants: Mapping[str, float] | None = None,
        default: T | Required = REQUIRED,
    ) -> tuple[Expression, Expression] | T:
        """Read ``[x, y]``, two expressions or numbers."""
        return self._read(key, default, lambda value, place: expression_pair_of(value, place, variables, constants))

    def paths(self, key: str, default: T | Required = REQUIRED) -> tuple[tuple[str, ...], ...] | T:
        """Read a list of paths, each a list of at least two names; neighbours in a path differ."""
        return self._read(key, default, paths_of)

    def table(self, key: str, *, required: bool = True) -> Table:
        """Read a table. If it is not required and missing, it is empty."""

        def read(value: Any, place: str) -> Table:
            if not isinstance(value, Mapping):
                raise SceneError(f"got {describe(value)}; expected a table [{place}]", place)
            return Table(value, place)

        place = self.place_of(key)
        if required and key not in self._data and not self.misspelt(key):
            raise SceneError(f"the required key is missing. Add a table [{place}]", place)
        return self._read(key, REQUIRED if required else Table({}, place), read)

    def tables(self, key: str, *, required: bool = False) -> tuple[Table, ...]:
        """Read an array of tables. If it is not required and missing, it is empty."""

        def read(value: Any, place: str) -> tuple[Table, ...]:
            if not isinstance(value, list) or not all(isinstance(part, Mapping) for part in value):
                raise SceneError(
                    f"got {describe(value)}; expected an array of tables. Write [[{place}]] with double brackets", place
                )
            if required and not value:
                raise SceneError(f"got an empty list; expected at least one [[{place}]]", place)
            return tuple(Table(part, f"{place}[{k}]") for k, part in enumerate(value))

        return self._read(key, REQUIRED if required else (), read)

    def named_tables(self, key: str) -> dict[str, Table]:
        """Read the tables inside a table, by name. If it is missing, there are none."""
        outer = self.table(key, required=False)
        return {name: outer.table(name) for name in outer}

    def raw(self, key: str) -> Any:
        """Read a required value as the parser gave it."""
        return self._read(key, REQUIRED, lambda value, place: value)

    def misspelt(self, *keys: str) -> str:
        """Return ``". Is it misspelt as 'denisty'?"`` if a key nobody asked for so far is close to one of these."""
        others = [name for name in self._data if name not in self._known]
        found = next(filter(None, (suggestion(key, others) for key in keys)), "")
        return f". {found.replace('Did you mean', 'Is it misspelt as').rstrip()}" if found else ""

    def finish(self) -> None:
        """Check that no keys are left.

        Raises
        ------
        SceneError
            If the table has a key that was never asked for.
        """
        for key in self._data:
            if key not in self._known:
                raise SceneError(
                    f"unknown key. {suggestion(key, self._known)}Known keys: {', '.join(self._known) or 'none'}",
                    self.place_of(key),
                )

    def _read(self, key: str, default: T | Required, read: Callable[[Any, str], V]) -> V | T:
        self._known[key] = None
        if key in self._data:
            return read(self._data[key], self.place_of(key))
        if not isinstance(default, Required):
            return default
        raise SceneError(f"the required key is missing{self.misspelt(key) or '.'}", self.place_of(key))
