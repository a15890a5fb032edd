"""What a structure's mesh is made from: numbering, nodes along edges, blending weights; kept while it holds."""

from __future__ import annotations

from dataclasses import dataclass, field
from threading import RLock
from typing import cast
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.connectivity import Connectivity, Patch, connectivity
from hoblock.grading import EdgeGrading, Grading, node_parameters
from hoblock.orders import HIGHEST_ORDER
from hoblock.topology import BlockTopology
from hoblock.transfinite import TransfiniteWeights

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Batch", "Layout", "layout"]

_KEPT_FAMILIES = 16
"""Combinations of gradings and order kept of one topology: a study of gradings does not fill the memory."""

_KEPT_POSITIONS = 4
"""Layouts of one structure kept where gradings depend on lengths: the last few positions of a moving mesh."""


@dataclass(frozen=True, eq=False)
class Batch:
    """Blocks of a patch whose nodes are blended in the same way.

    Attributes
    ----------
    patch : Patch
    members : ndarray
        Places of the blocks in the patch, ascending.
    weights : TransfiniteWeights
    """

    patch: Patch
    members: Index
    weights: TransfiniteWeights

    @property
    def blocks(self) -> Index:
        """Numbers of the blocks."""
        return self.patch.blocks[self.members]

    def select(self, some: Index) -> Batch:
        """Return the batch of some of its blocks."""
        return Batch(self.patch, self.members[some], self.weights.select(some))


@dataclass(frozen=True, eq=False)
class Layout:
    """Everything about a mesh that does not depend on where the blocks are, but for gradings that keep lengths.

    Attributes
    ----------
    numbers : Connectivity
    edge_parameters : ndarray
        Parameters in [0, 1] of ``edge_nodes``, gradings included.
    batches : tuple of Batch
    """

    numbers: Connectivity
    edge_parameters: Array
    batches: tuple[Batch, ...]

    @property
    def order(self) -> int:
        """Order p of the elements."""
        return self.numbers.order

    @property
    def cells(self) -> Index:
        """Nodes of the elements, shape (e, (p + 1)²)."""
        return self.numbers.cells

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return self.numbers.node_count

    @property
    def vertex_nodes(self) -> Index:
        """Mesh node of each block vertex."""
        return self.numbers.vertex_nodes

    @property
    def edge_offsets(self) -> Index:
        """Where the nodes of each edge begin in ``edge_nodes``, shape (m + 1,)."""
        return self.numbers.edge_offsets

    @property
    def edge_nodes(self) -> Index:
        """Nodes of all block edges, each from its first to its second vertex."""
        return self.numbers.edge_nodes

    @property
    def block_of_cell(self) -> Index:
        """Block of each element, shape (e,)."""
        return np.repeat(np.arange(len(self.numbers.cell_starts) - 1), np.diff(self.numbers.cell_starts))

    def nodes_of_edge(self, edge: int) -> Index:
        """Nodes of a block edge from its first to its second vertex, shape (n p + 1,)."""
        return self.edge_nodes[self.edge_offsets[edge] : self.edge_offsets[edge + 1]]

    def parameters_of_edge(self, edge: int) -> Array:
        """Their parameters in [0, 1], shape (n p + 1,)."""
        return self.edge_parameters[self.edge_offsets[edge] : self.edge_offsets[edge + 1]]


def layout(structure: BlockStructure, order: int) -> Layout:
    """Numbering, connectivity and blending weights of a structure; computed once and shared by moved structures.

    Parameters
    ----------
    structure : BlockStructure
    order : int
        Order p of the elements, 1 to 32.

    Raises
    ------
    ValueError
        If the order is none of these.
    GradingError
        If a grading is not strictly increasing for the number of elements of its edge, or does not fit its length.
    """
    if isinstance(order, bool) or not isinstance(order, int | np.integer):
        raise ValueError(f"order is {order!r}; expected an integer from 1 to {HIGHEST_ORDER}.")
    if not 1 <= order <= HIGHEST_ORDER:
        raise ValueError(f"order is {order}; expected an integer >= 1 and <= {HIGHEST_ORDER}.")
    with _LOCK:
        known = _FAMILIES.setdefault(structure.topology, {})
        key = (structure.gradings, int(order))
        family = known.pop(key, None)
        if family is None:
            family = _family(structure.topology, structure.gradings, int(order), tuple(known.values()))
        known[key] = family  # the latest comes last
        while len(known) > _KEPT_FAMILIES:
            del known[next(iter(known))]
    gradings = _resolved(structure, family.to_resolve)
    with _LOCK:
        return family.layout(structure.topology, gradings)


@dataclass(frozen=True, eq=False)
class _Family:
    """Layouts of one numbering that differ by gradings which depend on lengths.

    Attributes
    ----------
    numbers : Connectivity
    to_resolve : tuple of int
        Edges with such a grading.
    known : dict
        The last layouts by their gradings; a single one if there is nothing to resolve.
    """

    numbers: Connectivity
    to_resolve: tuple[int, ...]
    known: dict[tuple[Grading, ...], Layout] = field(default_factory=dict)

    def layout(self, topology: BlockTopology, gradings: tuple[Grading, ...]) -> Layout:
        """Return the layout for gradings in which nothing depends on the edge any more."""
        if not self.to_resolve and self.known:
            return next(iter(self.known.values()))
        found = self.known.pop(gradings, None)
        if found is None:
            last = next(reversed(self.known.items()), None)
            found = _layout(self.numbers, topology, gradings, last)
        self.known[gradings] = found  # the latest comes last
        while len(self.known) > _KEPT_POSITIONS:
            del self.known[next(iter(self.known))]
        return found


_LOCK = RLock()  # threads may mesh structures of one topology

# A layout lives as long as its topology: long studies over many structures keep none of them.
_FAMILIES: WeakKeyDictionary[BlockTopology, dict[tuple[tuple[Grading | EdgeGrading, ...], int], _Family]] = (
    WeakKeyDictionary()
)


def _family(
    topology: BlockTopology, gradings: tuple[Grading | EdgeGrading, ...], order: int, others: tuple[_Family, ...]
) -> _Family:
    """Begin the layouts of some gradings; those of other gradings and the same order share their numbering."""
    numbers = next((other.numbers for other in others if other.numbers.order == order), None)
    to_resolve = tuple(edge for edge, grading in enumerate(gradings) if isinstance(grading, EdgeGrading))
    return _Family(numbers or connectivity(topology, order), to_resolve)


def _resolved(structure: BlockStructure, edges: tuple[int, ...]) -> tuple[Grading, ...]:
    """Gradings of all edges, those that depend on their edge made for its present shape."""
    gradings = list(structure.gradings)
    for edge in edges:
        gradings[edge] = structure.resolved_grading(edge)
    return cast("tuple[Grading, ...]", tuple(gradings) if edges else structure.gradings)


def _layout(
    numbers: Connectivity,
    topology: BlockTopology,
    gradings: tuple[Grading, ...],
    last: tuple[tuple[Grading, ...], Layout] | None,
) -> Layout:
    """Make a layout; what has the gradings of the last one is taken from there."""
    batches: list[Batch] = []
    if last is None:
        parameters = _edge_parameters(topology, gradings, numbers.order)
        for patch in numbers.patches:
            batches.extend(_batches(patch, topology, parameters))
        return Layout(numbers, np.concatenate(parameters), tuple(batches))
    before, known = last
    changed = np.array([bool(new != old) for new, old in zip(gradings, before, strict=True)], dtype=np.bool_)
    parameters = [known.parameters_of_edge(edge) for edge in range(len(gradings))]
    for edge in np.flatnonzero(changed):
        count, place = int(topology.counts[edge]), f"edge {topology.edge_name(int(edge))}"
        parameters[edge] = node_parameters(gradings[edge], count, numbers.order, place)
    touched = np.asarray(changed[topology.block_edges].any(axis=1))
    for patch in numbers.patches:
        if touched[patch.blocks].any():
            batches.extend(_batches(patch, topology, parameters))
        else:
            batches.extend(batch for batch in known.batches if batch.patch is patch)
    return Layout(numbers, np.concatenate(parameters), tuple(batches))


def _edge_parameters(topology: BlockTopology, gradings: tuple[Grading, ...], order: int) -> list[Array]:
    """Parameters of the nodes of every edge; edges of equal grading and count share them."""
    known: dict[tuple[Grading, int], Array] = {}
    keys = list(zip(gradings, topology.counts.tolist(), strict=True))
    for edge, key in enumerate(keys):
        if key not in known:
            known[key] = node_parameters(*key, order, f"edge {topology.edge_name(edge)}")
    return [known[key] for key in keys]


def _batches(patch: Patch, topology: BlockTopology, parameters: list[Array]) -> list[Batch]:
    """Split a patch by which pairs of opposite edges share their parameters."""
    sides = topology.block_edges[patch.blocks]
    bottom, right, top, left = (np.stack([parameters[s] for s in sides[:, k]]) for k in range(4))
    kind = 2 * (bottom != top).any(axis=1) + (left != right).any(axis=1)
    batches = []
    for k in np.unique(kind):
        some = np.flatnonzero(kind == k)
        weights = TransfiniteWeights.from_parameters(bottom[some], top[some], left[some], right[some])
        batches.append(Batch(patch, some, weights))
    return batches
