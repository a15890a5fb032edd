"""From the mesh part of a scene to a block structure; every error names its place in the scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, Curve, Parametric
from hoblock.errors import CurveError, GradingError, TopologyError
from hoblock.grading import Cubic, Exponential, Grading, Quadratic, Uniform
from hoblock.scene import ArcAbout, ArcThrough, CountScene, CurveScene, Formula, GradingScene, MeshScene, Path
from hoblock.topology import BlockTopology
from hoblock.topology_checks import check_ends, tolerance

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Pair = tuple[str, str]
Ends = tuple[str | int, str | int]

__all__ = ["build_structure"]

_GRADINGS: dict[str, Callable[[float], Grading]] = {
    "cubic": Cubic,
    "exponential": Exponential,
    "quadratic": Quadratic,
    "uniform": lambda _: Uniform(),
}


def build_structure(scene: MeshScene) -> BlockStructure:
    """Build the block structure that a scene describes.

    Parameters
    ----------
    scene : MeshScene

    Returns
    -------
    BlockStructure
        With the scene's names of vertices, groups of blocks and edges.

    Raises
    ------
    TopologyError
        If the blocks do not form a valid structure, a path leaves the block edges, an edge has two curves or two
        gradings, or a chain of opposite edges two numbers of elements.
    CurveError
        If a curve does not exist or misses its vertices.
    ExpressionError
        If a parametric curve is not finite somewhere.
    GradingError
        If a grading is impossible.
    """
    sides = {frozenset(pair) for quads in scene.blocks.values() for quad in quads for pair in _pairs((*quad, quad[0]))}
    edges = {name: _edge_pairs(paths, sides, f"mesh.edges.{name}") for name, paths in scene.edges.items()}
    curves = _curves(scene, sides)
    gradings = _gradings(scene.gradings, sides)
    for count in scene.counts:
        _edge_pairs(count.on, sides, count.place)
    with _at("mesh"):
        structure = BlockStructure.build(scene.vertices, scene.blocks, edges=edges, curves=curves, gradings=gradings)
    counts = _chain_counts(structure.topology, scene)
    return replace(structure, topology=replace(structure.topology, counts=counts))


@contextmanager
def _at(place: str) -> Iterator[None]:
    """Put the place before the message of an error of the numerics; errors of expressions have theirs."""
    try:
        yield
    except (CurveError, GradingError, TopologyError) as error:
        raise type(error)(f"{place}: {error}") from error


def _pairs(path: Path) -> list[Pair]:
    return list(pairwise(path))


def _edge_pairs(paths: tuple[Path, ...], sides: set[frozenset[str]], place: str) -> list[Pair]:
    """Single edges of the paths; each step must be a side of a block."""
    pairs = [pair for path in paths for pair in _pairs(path)]
    for first, second in pairs:
        if frozenset((first, second)) not in sides:
            raise TopologyError(
                f"{place}: no block has a side from '{first}' to '{second}'; a path walks along block "
                "edges, naming every vertex on its way."
            )
    return pairs


def _curves(scene: MeshScene, sides: set[frozenset[str]]) -> dict[Ends, Curve]:
    places: dict[frozenset[str], str] = {}
    curves: dict[Ends, Curve] = {}
    allowed = tolerance(np.array(list(scene.vertices.values()))) if scene.curves else 0.0
    for entry in scene.curves:
        for pair in _edge_pairs(entry.on, sides, entry.place):
            _take(places, pair, entry.place, "curve")
            curves[pair] = _curve(entry, pair, scene.vertices, allowed)
    return curves


def _curve(entry: CurveScene, pair: Pair, vertices: Mapping[str, tuple[float, float]], allowed: float) -> Curve:
    ends = np.array([vertices[name] for name in pair])
    with _at(f"{entry.place} on {pair[0]}–{pair[1]}"):
        match entry.shape:
            case ArcAbout(center):
                return Arc.from_center(center, ends[0], ends[1])
            case ArcThrough(point):
                return Arc.through(ends[0], np.array(point), ends[1])
            case Formula() as formula:
                curve = _parametric(formula)
                check_ends(curve(np.array([0.0, 1.0])), ends, pair, allowed, "curve")
                return curve


def _parametric(formula: Formula) -> Parametric:
    def points(s: Array) -> Array:
        return np.stack([formula.x.evaluate(s=s), formula.y.evaluate(s=s)], axis=-1)

    return Parametric(points)


def _gradings(entries: tuple[GradingScene, ...], sides: set[frozenset[str]]) -> dict[Ends, Grading]:
    places: dict[frozenset[str], str] = {}
    gradings: dict[Ends, Grading] = {}
    for entry in entries:
        with _at(entry.place):
            grading = _GRADINGS[entry.kind](entry.parameter)
        for pair in _edge_pairs(entry.on, sides, entry.place):
            _take(places, pair, entry.place, "grading")
            gradings[pair] = grading
    return gradings


def _take(places: dict[frozenset[str], str], pair: Pair, place: str, what: str) -> None:
    """Note where an edge gets its curve or grading; it may get only one."""
    edge = frozenset(pair)
    if edge in places:
        other = places[edge]
        where = f"{other} gives one already" if other != place else "the same entry gives it twice"
        raise TopologyError(f"{place}: edge {pair[0]}–{pair[1]} has a second {what}: {where}. Remove one.")
    places[edge] = place


def _chain_counts(topology: BlockTopology, scene: MeshScene) -> Index:
    """Number of elements of every edge; two numbers for one chain are an error that names both places."""
    given: dict[int, tuple[CountScene, Pair]] = {}
    for count in scene.counts:
        for pair in (pair for path in count.on for pair in _pairs(path)):
            edge, _ = topology.edge(topology.vertex(pair[0]), topology.vertex(pair[1]))
            chain = int(topology.chains[edge])
            other, other_pair = given.setdefault(chain, (count, pair))
            if other.elements != count.elements:
                members = ", ".join(topology.edge_name(int(k)) for k in np.flatnonzero(topology.chains == chain))
                raise TopologyError(
                    f"{count.place}: {count.elements} elements on edge {pair[0]}–{pair[1]}, but {other.place} asks for "
                    f"{other.elements} on edge {other_pair[0]}–{other_pair[1]}. Both belong to one chain of opposite "
                    f"edges ({members}), which needs one number. Change or remove one."
                )
    numbers = {chain: count.elements for chain, (count, _) in given.items()}
    return np.array([numbers.get(int(chain), scene.elements) for chain in topology.chains], dtype=np.int64)
