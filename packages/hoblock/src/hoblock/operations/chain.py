"""Chains of opposite edges, listed for people who choose numbers of elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.topology import BlockTopology

Index = NDArray[np.int64]

__all__ = ["Chain", "chains"]


@dataclass(frozen=True)
class Chain:
    """Edges that face each other across blocks and so carry one number of elements.

    Attributes
    ----------
    edges : tuple of (str, str)
        First and second vertex of each edge, all parallel, in the order one meets them crossing the blocks.
    count : int
        Elements along each of them.
    closed : bool
        Whether the last edge faces the first again, as round a ring.
    """

    edges: tuple[tuple[str, str], ...]
    count: int
    closed: bool

    def __str__(self) -> str:
        listed = ", ".join(f"{first}–{second}" for first, second in self.edges)
        return f"{self.count} element{'s' * (self.count != 1)} on {listed}{' (closed)' * self.closed}"


def chains(structure: BlockStructure) -> tuple[Chain, ...]:
    """List the chains of opposite edges of a structure.

    Parameters
    ----------
    structure : BlockStructure

    Returns
    -------
    tuple of Chain
        A number given to one edge of a chain (``counts``, `BlockStructure.with_counts`) holds for all of it, and a
        structure needs no more numbers than it has chains.
    """
    topology = structure.topology
    facing: list[list[int]] = [[] for _ in topology.edges]
    for first, second in topology.opposite_edges.tolist():
        facing[first].append(second)
        facing[second].append(first)
    result: list[Chain] = []
    for number in range(int(topology.chains.max()) + 1):
        members = np.flatnonzero(topology.chains == number).tolist()
        start = next((edge for edge in members if len(facing[edge]) == 1), members[0])
        result.append(_chain(topology, _walk(start, facing), closed=len(facing[start]) == 2))
    return tuple(result)


def _walk(start: int, facing: list[list[int]]) -> list[int]:
    """Edges from one across block after block until there is none, or the first again."""
    walked, seen, edge = [start], {start}, start
    while following := [other for other in facing[edge] if other not in seen]:
        edge = following[0]
        seen.add(edge)
        walked.append(edge)
    return walked


def _chain(topology: BlockTopology, walked: list[int], *, closed: bool) -> Chain:
    names = topology.vertex_names
    edges = tuple((names[a], names[b]) for a, b in topology.edges[walked].tolist())
    return Chain(edges, int(topology.counts[walked[0]]), closed)
