"""Block structures joined where their vertices coincide."""

from __future__ import annotations

from itertools import count

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import TopologyError
from hoblock.operations.shared_edges import check_no_vertex_on_curve, check_shared_edge
from hoblock.operations.structure_tables import StructureTables
from hoblock.topology_checks import tolerance as default_tolerance

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["merge"]


def merge(
    first: BlockStructure,
    second: BlockStructure,
    *others: BlockStructure,
    tolerance: float | None = None,
    keep_shared_names: bool = True,
) -> BlockStructure:
    """Join structures: vertices at one place become one, edges between such vertices are shared.

    Parameters
    ----------
    first, second, *others : BlockStructure
        Joined one after the other; each must share a vertex with those before it.
    tolerance : float, optional
        Greatest distance of vertices that become one, 1e-9 of the whole's size if missing. The later structure is
        fitted to the earlier one, its curves displaced with its vertices.
    keep_shared_names : bool
        Whether edges that were on the boundary of both and are now inside stay in the groups they are in.

    Returns
    -------
    BlockStructure
        Groups of equal name are united. A vertex keeps its name, that of the earlier structure where two become one; if
        another vertex has the name already, ``:2`` (or ``:3`` …) is added to it.

    Raises
    ------
    TopologyError
        If nothing coincides, a shared edge has two numbers of elements, curves or gradings (the error names both), or
        the blocks overlap or do not conform.
    """
    whole = first
    for number, other in enumerate((second, *others), start=2):
        whole = _Merger(whole, other, number, tolerance, keep_shared_names).made()
    return whole


class _Merger:
    """Two structures being joined; ``number`` counts the second one for messages."""

    def __init__(
        self, first: BlockStructure, second: BlockStructure, number: int, tolerance: float | None, keep: bool
    ) -> None:
        both = np.concatenate([first.vertices, second.vertices])
        self._allowed = default_tolerance(both) if tolerance is None else float(tolerance)
        if not self._allowed > 0.0:
            raise TopologyError(f"merge: tolerance is {tolerance!r}; expected a positive length.")
        self._number = number
        self._place = f"merge, structure {number}"
        self._keep = keep
        self._first = first
        self._match = _coinciding(first, second, self._allowed, self._place)
        joined = self._match >= 0
        vertices = np.array(second.vertices)
        vertices[joined] = first.vertices[self._match[joined]]
        self._second = second if np.array_equal(vertices, second.vertices) else second.moved(vertices)

    def made(self) -> BlockStructure:
        """Check what is shared and put the structure together."""
        first, second = self._first, self._second
        shared = self._shared_edges()
        for mine, theirs, forward in shared:
            check_shared_edge(first, second, (mine, theirs), forward, self._allowed, self._place)
        before, after = "those before", f"structure {self._number}"
        check_no_vertex_on_curve(first, second, self._match < 0, self._allowed, (before, after))
        unmatched = np.setdiff1d(np.arange(len(first.vertices)), self._match)
        check_no_vertex_on_curve(second, first, unmatched, self._allowed, (after, before))
        tables, added = StructureTables.of(first), StructureTables.of(second)
        vertex_of = self._vertices(tables)
        start = len(tables.pieces)
        tables.pieces += [[_renumbered(quad, vertex_of) for quad in pieces] for pieces in added.pieces]
        for name, blocks in added.block_groups.items():
            tables.block_groups.setdefault(name, []).extend(start + block for block in blocks)
        both = {theirs for _, theirs, _ in shared}
        for edge, (a, b) in enumerate(second.topology.edges.tolist()):
            if edge not in both:
                pair = (vertex_of[a], vertex_of[b])
                tables.add_edge(pair, added.counts[a, b], added.curves.get((a, b)), added.gradings[a, b])
        self._unite_names(tables, added, vertex_of, {mine for mine, _, _ in shared})
        return tables.structure()

    def _shared_edges(self) -> list[tuple[int, int, bool]]:
        """Edges of the first and the second that are one, and whether they have one direction."""
        shared = []
        for theirs, (a, b) in enumerate(self._match[self._second.topology.edges].tolist()):
            if a >= 0 and b >= 0 and self._first.topology.find_edge(a, b) is not None:
                mine, forward = self._first.topology.edge(a, b)
                shared.append((mine, theirs, forward))
        return shared

    def _vertices(self, tables: StructureTables) -> list[int]:
        """Add the vertices that are new; returns the number in ``tables`` of each vertex of the second structure."""
        names, numbers = set(tables.names) | set(self._second.topology.vertex_names), []
        taken = set(tables.names)
        for vertex, name in enumerate(self._second.topology.vertex_names):
            if self._match[vertex] >= 0:
                numbers.append(int(self._match[vertex]))
                continue
            if name in taken:
                name = next(other for other in (f"{name}:{k}" for k in count(2)) if other not in names)
                names.add(name)
            numbers.append(tables.add_vertex(name, self._second.vertices[vertex]))
        return numbers

    def _unite_names(
        self, tables: StructureTables, added: StructureTables, vertex_of: list[int], shared: set[int]
    ) -> None:
        for name, pairs in added.edge_groups.items():
            group = tables.edge_groups.setdefault(name, [])
            known = {frozenset(pair) for pair in group}
            group += [p for p in ((vertex_of[a], vertex_of[b]) for a, b in pairs) if frozenset(p) not in known]
        if self._keep:
            return
        topology = self._first.topology
        inside = {frozenset(topology.edges[edge].tolist()) for edge in shared}
        kept = {name: [p for p in pairs if frozenset(p) not in inside] for name, pairs in tables.edge_groups.items()}
        tables.edge_groups = {name: pairs for name, pairs in kept.items() if pairs}


def _renumbered(quad: tuple[int, int, int, int], vertex_of: list[int]) -> tuple[int, int, int, int]:
    a, b, c, d = quad
    return vertex_of[a], vertex_of[b], vertex_of[c], vertex_of[d]


def _coinciding(first: BlockStructure, second: BlockStructure, allowed: float, place: str) -> Index:
    """For each vertex of the second structure the one of the first at its place, or -1."""
    from scipy.spatial import cKDTree

    tree = cKDTree(first.vertices)
    distance, nearest = tree.query(second.vertices, k=min(2, len(first.vertices)))
    distance, nearest = distance.reshape(len(second.vertices), -1), nearest.reshape(len(second.vertices), -1)
    names, others = second.topology.vertex_names, first.topology.vertex_names
    close = np.flatnonzero(distance[:, 0] <= allowed)
    if not close.size:
        k = int(np.argmin(distance[:, 0]))
        raise TopologyError(
            f"{place}: no vertex coincides with one of those before within {allowed:.2g}; the nearest, '{names[k]}', "
            f"is {distance[k, 0]:.3g} away from '{others[nearest[k, 0]]}'. Move it, or give a larger tolerance."
        )
    matched = nearest[close, 0]
    twice = close[(distance[close, -1] <= allowed) | (np.bincount(matched)[matched] > 1)]
    if distance.shape[1] > 1 and twice.size:
        raise TopologyError(
            f"{place}: within {allowed:.2g} of vertex '{names[twice[0]]}' there are several vertices, among them "
            f"'{others[nearest[twice[0], 0]]}'. Give a smaller tolerance."
        )
    match = np.full(len(second.vertices), -1, dtype=np.int64)
    match[close] = matched
    return match
