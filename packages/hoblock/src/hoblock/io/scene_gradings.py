"""``[[mesh.grading]]`` of a scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from hoblock.errors import SceneError
from hoblock.expressions import compile_expression
from hoblock.io.scene_paths import paths_on_or_leaving
from hoblock.io.table import Table
from hoblock.io.values import Limits, describe, integer_of, number_of
from hoblock.scene import GradingScene, Path, Quad
from hoblock.scene.gradings import GradingKind, GradingValue

__all__ = ["read_grading"]

_ENDS = ("first", "second", "both")
_POSITIVE = Limits(above=0.0)


def read_grading(
    table: Table,
    vertices: Mapping[str, Any],
    edges: Mapping[str, tuple[Path, ...]],
    blocks: Mapping[str, tuple[Quad, ...]],
    constants: Mapping[str, float],
) -> GradingScene:
    """Read one table."""
    on = paths_on_or_leaving(table, vertices, edges, blocks)
    asked = table.string("kind", choices=tuple(_READERS))
    kind: GradingKind = next(kind for kind in _READERS if kind == asked)
    values = _READERS[kind](_Keys(table, constants))
    table.finish()
    return GradingScene(on, kind, values, table.place)


class _Keys:
    """The keys of one grading, read if they are there; numbers may be expressions of the constants."""

    def __init__(self, table: Table, constants: Mapping[str, float]) -> None:
        self.table = table
        self.constants = constants

    def number(self, key: str, limits: Limits) -> dict[str, GradingValue]:
        return {key: self._number(self.table.raw(key), self.table.place_of(key), limits)}

    def optional_number(self, key: str, limits: Limits) -> dict[str, GradingValue]:
        return self.number(key, limits) if self.table.has(key) else {}

    def numbers(self, key: str, limits: Limits) -> dict[str, GradingValue]:
        place = self.table.place_of(key)
        return {key: tuple(self._number(part, f"{place}[{k}]", limits) for k, part in enumerate(self._list(key)))}

    def integers(self, key: str) -> dict[str, GradingValue]:
        place = self.table.place_of(key)
        return {key: tuple(integer_of(part, f"{place}[{k}]", Limits(1)) for k, part in enumerate(self._list(key)))}

    def choice(self, key: str, choices: tuple[str, ...]) -> dict[str, GradingValue]:
        return {key: self.table.string(key, choices=choices)} if self.table.has(key) else {}

    def formula(self, key: str) -> dict[str, GradingValue]:
        return {key: self.table.expression(key, ("s",), self.constants)}

    def exactly_one(self, *keys: str) -> str:
        present = [key for key in keys if self.table.has(key)]
        if len(present) == 1:
            return present[0]
        names = " and ".join(f"'{key}'" for key in present) if present else f"none of {', '.join(map(repr, keys))}"
        misspelt = "" if present else self.table.misspelt(*keys)
        raise SceneError(
            f"a grading with {names}; expected exactly one of {', '.join(map(repr, keys))}{misspelt}", self.table.place
        )

    def _number(self, value: object, place: str, limits: Limits) -> float:
        if isinstance(value, str):
            value = compile_expression(value, (), self.constants, place).value
        return number_of(value, place, limits)

    def _list(self, key: str) -> list[Any]:
        values = self.table.raw(key)
        if not isinstance(values, list) or not values:
            raise SceneError(
                f"got {describe(values)}; expected a list of numbers, at least one", self.table.place_of(key)
            )
        return values


def _geometric(keys: _Keys) -> dict[str, GradingValue]:
    return keys.number(keys.exactly_one("total", "growth"), _POSITIVE)


def _tanh(keys: _Keys) -> dict[str, GradingValue]:
    sizes = [key for key in ("first", "second") if keys.table.has(key)]
    if keys.table.has("strength") == bool(sizes):
        got = f"both 'strength' and '{sizes[0]}'" if sizes else "neither 'strength' nor 'first' or 'second'"
        raise SceneError(
            f"a tanh grading with {got}; expected its strength, or the sizes of its first or second end",
            keys.table.place,
        )
    if not sizes:
        return keys.number("strength", Limits(0.0, 30.0)) | keys.choice("ends", _ENDS)
    unit = keys.choice("unit", ("length", "fraction"))
    limits = Limits(above=0.0, below=1.0) if unit.get("unit") == "fraction" else _POSITIVE
    return unit | keys.optional_number("first", limits) | keys.optional_number("second", limits)


def _boundary_layer(keys: _Keys) -> dict[str, GradingValue]:
    return (
        keys.number("first_height", _POSITIVE)
        | keys.optional_number("growth", Limits(minimum=1.0))
        | keys.optional_number("thickness", _POSITIVE)
        | keys.choice("ends", _ENDS)
    )


def _list(keys: _Keys) -> dict[str, GradingValue]:
    key = keys.exactly_one("positions", "sizes")
    return keys.numbers(key, _POSITIVE if key == "sizes" else Limits(0.0, 1.0))


_READERS: dict[GradingKind, Callable[[_Keys], dict[str, GradingValue]]] = {
    "uniform": lambda keys: {},
    "quadratic": lambda keys: keys.number("m", Limits(above=-1.0, below=1.0)),
    "cubic": lambda keys: keys.number("m", Limits(minimum=0.0, below=1.0)),
    "exponential": lambda keys: keys.number("a", Limits(-50.0, 50.0)),
    "geometric": _geometric,
    "tanh": _tanh,
    "cosine": lambda keys: keys.choice("ends", _ENDS),
    "boundary-layer": _boundary_layer,
    "list": _list,
    "function": lambda keys: keys.formula("value"),
    "pieces": lambda keys: keys.integers("counts") if keys.table.has("counts") else {},
}
