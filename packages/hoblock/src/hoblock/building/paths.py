"""Places of a scene in errors, and paths walked edge by edge."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise

from hoblock.errors import CurveError, GradingError, TopologyError
from hoblock.scene import Path

__all__ = ["Pair", "at", "edge_pairs", "pairs_of", "take"]

Pair = tuple[str, str]


@contextmanager
def at(place: str) -> Iterator[None]:
    """Put the place before the message of an error of the numerics; errors of expressions have theirs."""
    try:
        yield
    except (CurveError, GradingError, TopologyError) as error:
        raise type(error)(f"{place}: {error}") from error


def pairs_of(path: Path) -> list[Pair]:
    """Single edges of a path."""
    return list(pairwise(path))


def edge_pairs(paths: tuple[Path, ...], sides: set[frozenset[str]], place: str) -> list[Pair]:
    """Single edges of the paths; each step must be a side of a block."""
    pairs = [pair for path in paths for pair in pairs_of(path)]
    for first, second in pairs:
        if frozenset((first, second)) not in sides:
            raise TopologyError(
                f"{place}: no block has a side from '{first}' to '{second}'; a path walks along block "
                "edges, naming every vertex on its way."
            )
    return pairs


def take(places: dict[frozenset[str], str], pair: Pair, place: str, what: str) -> None:
    """Note where an edge gets its curve or grading; it may get only one."""
    edge = frozenset(pair)
    if edge in places:
        other = places[edge]
        where = f"{other} gives one already" if other != place else "the same entry gives it twice"
        raise TopologyError(f"{place}: edge {pair[0]}–{pair[1]} has a second {what}: {where}. Remove one.")
    places[edge] = place
