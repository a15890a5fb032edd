"""The parts of a block structure, put together from quads and what is said about pairs of vertices, and checked."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hoblock import edge_tables as tables
from hoblock import topology_checks as checks
from hoblock.curves import Curve
from hoblock.edge_tables import Pair
from hoblock.grading import EdgeGrading, Grading, Uniform
from hoblock.orientation import orient
from hoblock.topology import BlockTopology

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Parts = tuple[BlockTopology, Array, dict[int, Curve], tuple[Grading | EdgeGrading, ...]]

__all__ = ["Parts", "assemble"]


def assemble(
    names: Sequence[str],
    vertices: Array,
    quads: Index,
    block_groups: Mapping[str, Index],
    *,
    edge_groups: Mapping[str, Iterable[Pair]],
    counts: Mapping[Pair, int],
    curves: Mapping[Pair, Curve],
    gradings: Mapping[Pair, Grading | EdgeGrading],
    default_count: int = 1,
) -> Parts:
    """Put together and check what a `BlockStructure` is made of.

    Parameters
    ----------
    names : sequence of str
        Names of the vertices, all different.
    vertices : ndarray, shape (n, 2)
    quads : ndarray, shape (b, 4)
        Counter-clockwise.
    block_groups : mapping of str to ndarray
        A block may be in several groups or in none.
    edge_groups, counts, curves, gradings, default_count
        As in `BlockStructure.build`, pairs being numbers of vertices.

    Returns
    -------
    tuple
        Topology, vertices, curves and gradings: the arguments of `BlockStructure`.

    Raises
    ------
    TopologyError, CurveError, GradingError
        As `BlockStructure.build`.
    """
    checks.check_counter_clockwise(quads, block_groups, names, vertices, curves)
    edges, block_edges, chains, rotation = orient(quads, names)
    quads = np.take_along_axis(quads, (np.arange(4) + rotation[:, None]) % 4, axis=1)
    ones = np.ones(len(chains), dtype=np.int64)
    topology = BlockTopology(tuple(names), quads, edges, block_edges, chains, ones, block_groups, {})
    curved = tables.directed_curves(topology, curves)
    graded = tables.directed_gradings(topology, gradings)
    checks.check_geometry(topology, vertices, frozenset(curved))
    named = {name: tables.edges_between(topology, pairs, f"edges.{name}") for name, pairs in edge_groups.items()}
    per_edge = checks.chain_counts(topology, counts, default_count)
    tables.check_curve_ends(topology, vertices, curved)
    topology = replace(topology, counts=per_edge, edge_groups=named)
    return topology, vertices, curved, tuple(graded.get(edge, Uniform()) for edge in range(len(edges)))
