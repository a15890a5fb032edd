"""What is said about edges by pairs of vertices, sorted to the directed edges of a topology."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from hoblock.curves import Curve, NodalCurve, reverse
from hoblock.errors import CurveError, GradingError, TopologyError
from hoblock.grading import EdgeGrading, Grading
from hoblock.grading import reverse as reverse_grading
from hoblock.topology import BlockTopology
from hoblock.topology_checks import check_ends, edge_pair, tolerance

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Pair = tuple[int, int]
Ends = tuple[str | int, str | int]
Numbers = Callable[[str | int, str], int]
Thing = TypeVar("Thing")

__all__ = [
    "Ends",
    "Pair",
    "by_number",
    "check_curve_ends",
    "directed_curves",
    "directed_gradings",
    "edges_between",
    "paths_by_number",
]


def by_number(things: Mapping[Ends, Thing], number: Numbers, place: str) -> dict[Pair, Thing]:
    """Return things by the numbers of vertices instead of their names; ``number`` tells them, or raises."""
    return {_numbered(pair, number, place): thing for pair, thing in things.items()}


def paths_by_number(paths: Mapping[str, Iterable[Ends]], number: Numbers) -> dict[str, list[Pair]]:
    """Return named pairs by the numbers of vertices instead of their names."""
    return {name: [_numbered(pair, number, f"edges.{name}") for pair in pairs] for name, pairs in paths.items()}


def _numbered(pair: object, number: Numbers, place: str) -> Pair:
    first, second = edge_pair(pair, place)
    return number(first, place), number(second, place)


def edges_between(topology: BlockTopology, pairs: Iterable[Pair], place: str) -> Index:
    """Edges between pairs of vertices, in their order.

    Raises
    ------
    TopologyError
        If there are none, one is no edge, or one is listed twice.
    """
    edges = np.array([topology.edge(*pair)[0] for pair in pairs], dtype=np.int64)
    if not edges.size:
        raise TopologyError(f"{place}: no edges; expected at least one pair of vertices. Remove the name.")
    found, uses = np.unique(edges, return_counts=True)
    if (uses > 1).any():
        raise TopologyError(f"{place}: edge {topology.edge_name(int(found[uses > 1][0]))} is listed twice. Remove one.")
    return edges


def directed_curves(topology: BlockTopology, curves: Mapping[Pair, Curve]) -> dict[int, Curve]:
    """Curves by edge and in its direction, from curves by pairs of vertices and in theirs.

    Raises
    ------
    CurveError
        If one is no function.
    TopologyError
        If an edge does not exist or is given twice.
    """
    result: dict[int, Curve] = {}
    for edge, forward, curve in _by_edge(topology, curves, "curves"):
        if isinstance(curve, type) or not callable(curve):
            raise CurveError(
                f"curves: edge {topology.edge_name(edge)} has {curve!r}; expected a function of t in [0, 1]."
            )
        result[edge] = curve if forward else reverse(curve)
    return result


def directed_gradings(
    topology: BlockTopology, gradings: Mapping[Pair, Grading | EdgeGrading]
) -> dict[int, Grading | EdgeGrading]:
    """Gradings by edge and in its direction, from gradings by pairs of vertices and in theirs.

    Raises
    ------
    GradingError
        If one is neither a function nor an `EdgeGrading`.
    TopologyError
        If an edge does not exist or is given twice.
    """
    result: dict[int, Grading | EdgeGrading] = {}
    for edge, forward, grading in _by_edge(topology, gradings, "gradings"):
        if isinstance(grading, type) or not (callable(grading) or isinstance(grading, EdgeGrading)):
            raise GradingError(
                f"gradings: edge {topology.edge_name(edge)} has {grading!r}; expected a function of t in [0, 1]."
            )
        if type(grading).__hash__ is None:
            raise GradingError(
                f"gradings: edge {topology.edge_name(edge)} has {grading!r}, which has no hash. Make its class a "
                "frozen dataclass, or wrap a function of it in grading.Function."
            )
        result[edge] = grading if forward else reverse_grading(grading)
    return result


def _by_edge(topology: BlockTopology, things: Mapping[Pair, Thing], place: str) -> Iterable[tuple[int, bool, Thing]]:
    """Edge, whether the pair runs along it, and what is given there; each edge once."""
    seen: set[int] = set()
    for pair, thing in things.items():
        edge, forward = topology.edge(*pair)
        if edge in seen:
            raise TopologyError(f"{place}: edge {topology.edge_name(edge)} is given twice. Remove one.")
        seen.add(edge)
        yield edge, forward, thing


def check_curve_ends(topology: BlockTopology, vertices: Array, curves: Mapping[int, Curve]) -> None:
    """Every curve must meet the vertices of its edge.

    Raises
    ------
    CurveError
        Naming the edge, the vertex and the gap.
    """
    if not curves:
        return
    allowed = tolerance(vertices)
    for edge, curve in curves.items():
        ends = topology.edges[edge]
        found = curve.points[[0, -1]] if isinstance(curve, NodalCurve) else curve(np.array([0.0, 1.0]))
        names = [topology.vertex_names[v] for v in ends]
        check_ends(found, vertices[ends], names, allowed, f"curve on edge {topology.edge_name(edge)}")
