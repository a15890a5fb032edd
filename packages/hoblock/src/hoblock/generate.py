"""From a block structure to a mesh, and again after the structure has moved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve, NodalCurve
from hoblock.errors import CurveError, InvalidMeshError
from hoblock.grading import Grading, node_parameters
from hoblock.mesh import QuadMesh
from hoblock.numbering import number_nodes
from hoblock.quality import invalid_elements
from hoblock.reference import gauss_lobatto
from hoblock.scene import HIGHEST_ORDER
from hoblock.topology import BlockTopology
from hoblock.transfinite import TransfiniteWeights, interior_points

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Layout", "changed_blocks", "generate", "layout", "raise_if_invalid", "regenerate"]


@dataclass(frozen=True, eq=False)
class _Batch:
    """Blocks of equal size: numbers, nodes of bottom, top, left, right, inner nodes (b, n, m), weights."""

    blocks: Index
    sides: tuple[Index, ...]
    inner: Index
    weights: TransfiniteWeights

    def select(self, some: Index) -> _Batch:
        """Return the batch of some of its blocks."""
        sides = tuple(nodes[some] for nodes in self.sides)
        return _Batch(self.blocks[some], sides, self.inner[some], self.weights.select(some))


@dataclass(frozen=True, eq=False)
class Layout:
    """Everything about a mesh that does not depend on where the blocks are.

    Attributes
    ----------
    order : int
    cells : ndarray, shape (e, (p + 1)²)
    node_count : int
    block_of_cell : ndarray, shape (e,)
    vertex_nodes : ndarray
        Mesh node of each block vertex.
    edge_offsets : ndarray, shape (m + 1,)
    edge_nodes : ndarray
        Nodes of block edge k, first to second vertex: ``edge_nodes[edge_offsets[k]:edge_offsets[k + 1]]``.
    edge_parameters : ndarray
        Their parameters in [0, 1], gradings included.
    cell_groups, edge_groups : mapping
        As in `QuadMesh`.
    """

    order: int
    cells: Index
    node_count: int
    block_of_cell: Index
    vertex_nodes: Index
    edge_offsets: Index
    edge_nodes: Index
    edge_parameters: Array
    edge_of_entry: Index
    batches: tuple[_Batch, ...]
    cell_groups: Mapping[str, Index]
    edge_groups: Mapping[str, Index]

    def nodes_of_edge(self, edge: int) -> Index:
        """Nodes of a block edge from its first to its second vertex, shape (n p + 1,)."""
        return self.edge_nodes[self.edge_offsets[edge] : self.edge_offsets[edge + 1]]


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
        If a grading is not strictly increasing for the number of elements of its edge.
    """
    if isinstance(order, bool) or not isinstance(order, int | np.integer):
        raise ValueError(f"order is {order!r}; expected an integer from 1 to {HIGHEST_ORDER}.")
    if not 1 <= order <= HIGHEST_ORDER:
        raise ValueError(f"order is {order}; expected an integer >= 1 and <= {HIGHEST_ORDER}.")
    known = _LAYOUTS.setdefault(structure.topology, {})
    key = (structure.gradings, int(order))
    if key not in known:
        known[key] = _layout(structure.topology, structure.gradings, int(order))
    return known[key]


# A layout lives as long as its topology: long studies over many structures keep none of them.
_LAYOUTS: WeakKeyDictionary[BlockTopology, dict[tuple[tuple[Grading, ...], int], Layout]] = WeakKeyDictionary()


def _layout(topology: BlockTopology, gradings: tuple[Grading, ...], order: int) -> Layout:
    columns = topology.counts[topology.block_edges[:, 0]]
    rows = topology.counts[topology.block_edges[:, 3]]
    cell_starts = np.concatenate(([0], np.cumsum(columns * rows)))
    corners = _element_corners(topology, columns, rows)
    cells, node_count = number_nodes(corners, order)
    block_nodes = [
        _block_grid(cells[cell_starts[b] : cell_starts[b + 1]], int(columns[b]), int(rows[b]), order)
        for b in range(len(columns))
    ]
    edges = _edge_nodes(topology, block_nodes)
    parameters = _edge_parameters(topology, gradings, order)
    vertex_nodes = np.empty(len(topology.vertex_names), dtype=np.int64)
    vertex_nodes[topology.edges] = [(nodes[0], nodes[-1]) for nodes in edges]
    lengths = np.array([len(nodes) for nodes in edges])
    return Layout(
        order,
        cells,
        node_count,
        np.repeat(np.arange(len(columns)), columns * rows),
        vertex_nodes,
        np.concatenate(([0], np.cumsum(lengths))),
        np.concatenate(edges),
        np.concatenate(parameters),
        np.repeat(np.arange(len(edges)), lengths),
        _batches(topology, block_nodes, parameters),
        {
            name: np.concatenate([np.arange(cell_starts[b], cell_starts[b + 1]) for b in blocks])
            for name, blocks in topology.block_groups.items()
        },
        _edge_groups(topology, columns, rows, cell_starts),
    )


def _element_corners(topology: BlockTopology, columns: Index, rows: Index) -> Index:
    """Corner identities (e, 4) of all elements, block by block."""
    count = len(topology.vertex_names)
    starts = count + np.concatenate(([0], np.cumsum(topology.counts - 1)))
    total = int(starts[-1])
    corners = []
    for block, (vertices, sides) in enumerate(zip(topology.quads, topology.block_edges, strict=True)):
        m, n = int(columns[block]), int(rows[block])
        grid = np.empty((n + 1, m + 1), dtype=np.int64)
        grid[0, 0], grid[0, -1], grid[-1, -1], grid[-1, 0] = vertices
        inner = [np.arange(starts[s], starts[s + 1]) for s in sides]
        grid[0, 1:-1], grid[1:-1, -1], grid[-1, 1:-1], grid[1:-1, 0] = inner
        grid[1:-1, 1:-1] = total + np.arange((n - 1) * (m - 1)).reshape(n - 1, m - 1)
        total += (n - 1) * (m - 1)
        corners.append(np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=-1).reshape(-1, 4))
    return np.concatenate(corners)


def _block_grid(cells: Index, columns: int, rows: int, order: int) -> Index:
    """Node numbers of a block as a grid, shape (rows p + 1, columns p + 1)."""
    i, j = np.arange(columns * order + 1), np.arange(rows * order + 1)
    ci, cj = np.minimum(i // order, columns - 1), np.minimum(j // order, rows - 1)
    local = (j - cj * order)[:, None] * (order + 1) + (i - ci * order)
    return np.asarray(cells[cj[:, None] * columns + ci, local])


def _edge_nodes(topology: BlockTopology, block_nodes: list[Index]) -> list[Index]:
    edges: list[Index] = [np.zeros(0, dtype=np.int64)] * len(topology.edges)
    for grid, sides in zip(block_nodes, topology.block_edges, strict=True):
        for side, nodes in zip(sides, (grid[0], grid[:, -1], grid[-1], grid[:, 0]), strict=True):
            edges[side] = nodes
    return edges


def _edge_parameters(topology: BlockTopology, gradings: tuple[Grading, ...], order: int) -> list[Array]:
    """Parameters of the nodes of every edge; edges of equal grading and count share them."""
    known: dict[tuple[Grading, int], Array] = {}
    for edge, key in enumerate(zip(gradings, topology.counts.tolist(), strict=True)):
        if key not in known:
            known[key] = node_parameters(*key, order, f"edge {topology.edge_name(edge)}")
    return [known[key] for key in zip(gradings, topology.counts.tolist(), strict=True)]


def _batches(topology: BlockTopology, block_nodes: list[Index], parameters: list[Array]) -> tuple[_Batch, ...]:
    groups: dict[tuple[int, int, bool], list[int]] = {}
    for block, sides in enumerate(topology.block_edges):
        bottom, right, top, left = (parameters[s] for s in sides)
        equal = _same(bottom, top) and _same(left, right)
        groups.setdefault((*block_nodes[block].shape, equal), []).append(block)
    batches = []
    for blocks in groups.values():
        sides = topology.block_edges[blocks]
        bottom, right, top, left = (np.stack([parameters[s] for s in sides[:, k]]) for k in range(4))
        weights = TransfiniteWeights.from_parameters(bottom, top, left, right)
        nodes = np.stack([block_nodes[b] for b in blocks])
        outer = tuple(side.copy() for side in (nodes[:, 0], nodes[:, -1], nodes[:, :, 0], nodes[:, :, -1]))
        inner = np.ascontiguousarray(nodes[:, 1:-1, 1:-1])
        batches.append(_Batch(np.array(blocks), outer, inner, weights))
    return tuple(batches)


def _same(first: Array, second: Array) -> bool:
    return first is second or np.array_equal(first, second)


def _edge_groups(topology: BlockTopology, columns: Index, rows: Index, cell_starts: Index) -> dict[str, Index]:
    flat = topology.block_edges.ravel()
    place = np.empty(len(topology.edges), dtype=np.int64)  # first of the block sides on each edge
    place[flat[::-1]] = np.arange(len(flat))[::-1]

    def sides_of(edge: int) -> Index:
        block, side = divmod(int(place[edge]), 4)
        cells = np.arange(cell_starts[block], cell_starts[block + 1]).reshape(rows[block], columns[block])
        along = (cells[0], cells[:, -1], cells[-1], cells[:, 0])[side]
        return np.stack([along, np.full(len(along), side)], axis=-1)

    return {
        name: np.concatenate([sides_of(int(edge)) for edge in edges]) for name, edges in topology.edge_groups.items()
    }


def generate(structure: BlockStructure, order: int, *, check: bool = True) -> QuadMesh:
    """Generate the mesh of a block structure.

    Parameters
    ----------
    structure : BlockStructure
    order : int
        Order p of the elements.
    check : bool
        Refuse a mesh whose det J is not certainly positive everywhere.

    Returns
    -------
    QuadMesh

    Raises
    ------
    InvalidMeshError
        Naming the worst element, its block and place.
    """
    plan = layout(structure, order)
    points = np.empty((plan.node_count, 2))
    _fill(plan, structure, points, None)
    mesh = QuadMesh(points, plan.cells, order, plan.cell_groups, plan.edge_groups)
    if check:
        raise_if_invalid(mesh, structure)
    return mesh


def regenerate(
    mesh: QuadMesh, structure: BlockStructure, *, out: Array | None = None, previous: BlockStructure | None = None
) -> QuadMesh:
    """Generate the points of a moved structure on the connectivity of a mesh of the same structure.

    Parameters
    ----------
    mesh : QuadMesh
        Made by `generate` or `regenerate` from a structure that shares ``structure``'s topology.
    structure : BlockStructure
        The moved structure.
    out : ndarray, shape (n, 2), optional
        Buffer for the points; owned by the caller, who must not write to it while the returned mesh is in use.
    previous : BlockStructure, optional
        The structure ``mesh`` was made from. If given, only the blocks that differ are generated, the rest is copied.

    Returns
    -------
    QuadMesh
        Not checked; see `raise_if_invalid`.

    Raises
    ------
    ValueError
        If the mesh or ``previous`` belongs to another structure, or ``out`` cannot take the points.
    """
    plan = layout(structure, mesh.order)
    if plan.cells is not mesh.cells and not np.array_equal(plan.cells, mesh.cells):
        raise ValueError("regenerate: the mesh was made from another block structure; use generate.")
    points = np.empty((plan.node_count, 2)) if out is None else out
    if not isinstance(points, np.ndarray):
        raise ValueError(f"regenerate: out is a {type(points).__name__}; expected an array.")
    if points.shape != (plan.node_count, 2) or points.dtype != np.float64:
        raise ValueError(
            f"regenerate: out has shape {points.shape}, type {points.dtype}; expected {(plan.node_count, 2)}, float64."
        )
    if not points.flags.writeable:
        raise ValueError("regenerate: out is read-only, as the points of meshes are; use np.empty_like(mesh.points).")
    changed = None
    if previous is not None:
        same = layout(previous, mesh.order)
        if same is not plan and not (
            np.array_equal(same.cells, plan.cells) and np.array_equal(same.edge_parameters, plan.edge_parameters)
        ):
            raise ValueError(
                "regenerate: previous has other blocks, counts or gradings than the structure; expected the one that "
                "the mesh was made from. Leave it out."
            )
        if np.may_share_memory(points, mesh.points):
            raise ValueError("regenerate: out is the buffer of the mesh that is to be kept; use another.")
        points[:] = mesh.points
        changed = changed_blocks(previous, structure)
        if not changed.any():
            return mesh.with_points(points)
    _fill(plan, structure, points, changed)
    return mesh.with_points(points)


def changed_blocks(previous: BlockStructure, structure: BlockStructure) -> NDArray[np.bool_]:
    """Blocks with a moved vertex or an edge of another geometry, shape (b,)."""
    topology = structure.topology
    moved = (previous.vertices != structure.vertices).any(axis=1)
    changed = np.asarray(moved[topology.quads].any(axis=1))
    edges = [
        edge
        for edge in previous.curves.keys() | structure.curves.keys()
        if previous.curves.get(edge) is not structure.curves.get(edge)
    ]
    if edges:
        changed |= np.isin(topology.block_edges, edges).any(axis=1)
    return changed


def _fill(plan: Layout, structure: BlockStructure, points: Array, changed: NDArray[np.bool_] | None) -> None:
    """Write the nodes of all edges and of the changed blocks into ``points``."""
    first, second = (structure.vertices[structure.topology.edges[:, k]][plan.edge_of_entry] for k in range(2))
    t = plan.edge_parameters[:, None]
    on_edges = (1.0 - t) * first + t * second
    for edge, curve in structure.curves.items():
        start, stop = plan.edge_offsets[edge], plan.edge_offsets[edge + 1]
        if isinstance(curve, NodalCurve):
            on_edges[start:stop] = _nodal_points(curve, plan, structure.topology, edge)
        else:
            on_edges[start:stop] = _curve_points(curve, plan.edge_parameters[start:stop], structure.topology, edge)
            on_edges[start], on_edges[stop - 1] = structure.vertices[structure.topology.edges[edge]]
    points[plan.edge_nodes] = on_edges
    for batch in plan.batches:
        part = batch
        if changed is not None:
            some = np.flatnonzero(changed[batch.blocks])
            part = batch if len(some) == len(batch.blocks) else batch.select(some)
        if part.inner.size:
            bottom, top, left, right = (points[nodes] for nodes in part.sides)
            _scatter(points, part.inner, interior_points(part.weights, bottom, top, left, right))


def _scatter(points: Array, nodes: Index, values: Array) -> None:
    """Set ``points[nodes] = values``; points as complex numbers are written ten times faster than as pairs."""
    if points.flags.c_contiguous:
        points.view(np.complex128)[:, 0][nodes.ravel()] = values.view(np.complex128).ravel()
    else:
        points[nodes] = values


def _curve_points(curve: Curve, t: Array, topology: BlockTopology, edge: int) -> Array:
    """Nodes of a curved edge, or an error that names the edge."""
    try:
        points = np.asarray(curve(t), dtype=float)
    except CurveError as error:
        raise CurveError(f"edge {topology.edge_name(edge)}: {error}") from error
    if points.shape != (len(t), 2):
        raise CurveError(
            f"edge {topology.edge_name(edge)}: the curve returned shape {points.shape} for {len(t)} parameters; "
            f"expected {(len(t), 2)}."
        )
    return points


def _nodal_points(curve: NodalCurve, plan: Layout, topology: BlockTopology, edge: int) -> Array:
    """Nodes of an interface edge: taken as they are for the same order, evaluated element by element for another."""
    count = int(topology.counts[edge])
    if curve.count != count:
        raise CurveError(
            f"edge {topology.edge_name(edge)}: the nodal curve has {curve.count} elements; the edge has {count}."
        )
    if curve.order == plan.order:
        return curve.points
    inner = (gauss_lobatto(plan.order)[:-1] + 1.0) / 2.0
    uniform = np.append(((np.arange(count)[:, None] + inner) / count).ravel(), 1.0)
    return curve(uniform)


def raise_if_invalid(mesh: QuadMesh, structure: BlockStructure) -> None:
    """Raise if det J of an element is not certainly positive.

    Raises
    ------
    InvalidMeshError
        Names how many elements are bad, the worst one, its block, (ξ, η) and (x, y).
    """
    bad = invalid_elements(mesh)
    if not len(bad):
        return
    plan = layout(structure, mesh.order)
    worst = bad[0]
    block = structure.topology.block_name(int(plan.block_of_cell[worst.element]))
    raise InvalidMeshError(
        f"{len(bad)} of {len(mesh.cells)} elements have det J <= 0 somewhere. Worst: element {worst.element} in "
        f"{block}, det J = {worst.det_J:.3g} at (xi, eta) = ({worst.xi:.3g}, {worst.eta:.3g}), "
        f"(x, y) = ({worst.x:.6g}, {worst.y:.6g}). {worst.reason}"
    )
