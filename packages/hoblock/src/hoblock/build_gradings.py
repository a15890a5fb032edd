"""From the gradings of a scene to those of block edges."""

from __future__ import annotations

from collections.abc import Callable

from hoblock.build_paths import at, edge_pairs, take
from hoblock.grading import Cubic, Exponential, Grading, Quadratic, Uniform
from hoblock.scene import GradingScene

Ends = tuple[str | int, str | int]

__all__ = ["build_gradings"]

_GRADINGS: dict[str, Callable[[float], Grading]] = {
    "cubic": Cubic,
    "exponential": Exponential,
    "quadratic": Quadratic,
    "uniform": lambda _: Uniform(),
}


def build_gradings(entries: tuple[GradingScene, ...], sides: set[frozenset[str]]) -> dict[Ends, Grading]:
    """Gradings of single edges; ``sides`` are the block edges there are."""
    places: dict[frozenset[str], str] = {}
    gradings: dict[Ends, Grading] = {}
    for entry in entries:
        with at(entry.place):
            grading = _GRADINGS[entry.kind](entry.parameter)
        for pair in edge_pairs(entry.on, sides, entry.place):
            take(places, pair, entry.place, "grading")
            gradings[pair] = grading
    return gradings
