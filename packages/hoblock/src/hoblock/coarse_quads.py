"""Block structures from coarse quad meshes: every element becomes a block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hoblock.assembly import assemble
from hoblock.blocks import BlockStructure
from hoblock.curves import Curve, LagrangeEdge
from hoblock.edge_tables import Ends, Pair
from hoblock.errors import TopologyError
from hoblock.mesh import QuadMesh
from hoblock.numbering import side_nodes
from hoblock.reference import equispaced, gauss_lobatto
from hoblock.scene import NodeOrder, Spacing
from hoblock.topology import connected
from hoblock.topology_checks import tolerance as default_tolerance

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["structure_from_mesh", "structure_from_quads"]

_STRAIGHT = 1e-9
"""Greatest distance, in chord lengths, of the nodes of a side from those of a straight one that count as rounding."""


def structure_from_mesh(mesh: QuadMesh, *, counts: Mapping[Ends, int] | int = 1) -> BlockStructure:
    """Return the block structure whose blocks are the elements of a mesh.

    Curved sides become `hoblock.curves.LagrangeEdge`; vertices are named by the numbers of the corner nodes.

    Parameters
    ----------
    mesh : QuadMesh
        Of any order.
    counts : mapping of (vertex, vertex) to int, or int
        Elements along edges, as in `BlockStructure.build`.

    Raises
    ------
    TopologyError
        If the counts do not fit, or the elements form no block structure.
    """
    corners = mesh.cells[:, side_nodes(mesh.order)[:, [0, -1]]]
    sides = {name: corners[members[:, 0], members[:, 1]] for name, members in mesh.edge_groups.items()}
    return structure_from_quads(
        mesh.points,
        mesh.cells,
        node_order="lexicographic",
        spacing="gll",
        block_groups=mesh.cell_groups,
        edge_groups=sides,
        counts=counts,
    )


def structure_from_quads(
    points: ArrayLike,
    quads: ArrayLike,
    *,
    order: int | None = None,
    node_order: NodeOrder = "gmsh",
    spacing: Spacing = "equispaced",
    names: Sequence[str] | None = None,
    block_groups: Mapping[str, ArrayLike] | None = None,
    edge_groups: Mapping[str, ArrayLike] | None = None,
    counts: Mapping[Ends, int] | int = 1,
    tolerance: float | None = None,
) -> BlockStructure:
    """Return the block structure whose blocks are given quads, straight or of higher order.

    Points at one place become one, points that are no corner of a quad are left out, clockwise quads are turned.

    Parameters
    ----------
    points : array_like, shape (n, 2)
    quads : array_like of int, shape (b, m)
        Points of each quad of order p: m is 4, (p + 1)², or 4p if there are none inside.
    order : int, optional
        The order p; if missing, the one for which m fits (3 for 16 points, which might also be 4 without inner ones).
    node_order : {"gmsh", "vtk", "lexicographic"}
        The corners one after the other, then the inner points of the sides: all sides walked round the quad ("gmsh",
        also Abaqus and many others), or the third and fourth parallel to the first two ("vtk"); or row by row.
        For four corners the first two mean the same.
    spacing : {"equispaced", "gll"}
        Where the points lie along a side.
    names : sequence of str, optional
        Names of the points, for the vertices; their numbers if missing.
    block_groups : mapping of str to array_like, optional
        Named quads. Quads without a name belong to the group "blocks".
    edge_groups : mapping of str to array_like of int, shape (k, 2), optional
        Named edges, each by the points at its ends.
    counts : mapping of (vertex, vertex) to int, or int
        Elements along edges, as in `BlockStructure.build`.
    tolerance : float, optional
        Distance of points that become one; 1e-9 of the whole's size if missing.

    Returns
    -------
    BlockStructure
        Sides that are not straight are `hoblock.curves.LagrangeEdge`.

    Raises
    ------
    TopologyError
        If an array has the wrong shape or names a point that does not exist, two quads disagree about the side they
        share, a named edge is none, or the quads form no block structure.
    """
    positions, nodes = _points(points), _sides(_integers(quads, "quads"), order, node_order)
    if nodes.size and not 0 <= nodes.min() <= nodes.max() < len(positions):
        raise TopologyError(
            f"quads: points {nodes.min()} to {nodes.max()}; expected numbers from 0 to {len(positions) - 1}."
        )
    allowed = default_tolerance(positions[nodes].reshape(-1, 2)) if tolerance is None else tolerance
    same = _first_at_place(positions, nodes[:, :, 0], allowed)
    nodes = _counter_clockwise(nodes, positions)
    vertices, corners = np.unique(same[nodes[:, :, 0]], return_inverse=True)
    corners = corners.reshape(-1, 4).astype(np.int64)
    _check_four(corners, nodes[:, :, 0])
    called = [str(v) for v in vertices] if names is None else [names[v] for v in vertices]
    if len(set(called)) < len(called):
        twice = next(name for k, name in enumerate(called) if name in called[:k])
        raise TopologyError(f"names: two vertices are called '{twice}'; expected different names.")
    number = np.full(len(positions), -1)
    number[vertices] = np.arange(len(vertices))
    parts = assemble(
        called,
        positions[vertices],
        corners,
        _block_groups(block_groups or {}, len(corners)),
        edge_groups={name: _pairs(pairs, number, same, name) for name, pairs in (edge_groups or {}).items()},
        counts={},
        curves=_curves(positions[nodes], corners, positions[vertices][corners], spacing, called, allowed),
        gradings={},
        default_count=counts if not isinstance(counts, Mapping) else 1,
    )
    structure = BlockStructure(*parts)
    return structure.with_counts(counts) if isinstance(counts, Mapping) else structure


def _points(points: ArrayLike) -> Array:
    positions = np.array(points, dtype=float)
    if positions.ndim != 2 or positions.shape[1] != 2 or not np.isfinite(positions).all():
        raise TopologyError(f"points: shape {positions.shape}; expected (n, 2), all finite.")
    return positions


def _integers(values: ArrayLike, place: str) -> Index:
    numbers = np.array(values)
    if numbers.size and not np.issubdtype(numbers.dtype, np.integer):
        raise TopologyError(f"{place}: the type is {numbers.dtype}; expected integers, the numbers of points.")
    return numbers.astype(np.int64)


def _sides(quads: Index, order: int | None, node_order: NodeOrder) -> Index:
    """Points of the four sides of each quad, walked counter-clockwise where the quad is, shape (b, 4, p + 1)."""
    width = quads.shape[1] if quads.ndim == 2 else 0
    root = round(width**0.5)
    if order is None:
        order = root - 1 if root * root == width else width // 4
    if quads.ndim != 2 or not len(quads) or order < 1 or width not in ((order + 1) ** 2, 4 * order):
        raise TopologyError(f"quads: shape {quads.shape}; expected (b, 4), (b, 8), (b, 9), (b, 12), (b, 16) …, b >= 1.")
    if node_order == "lexicographic":
        if width != (order + 1) ** 2:
            raise TopologyError(f"quads: {width} points row by row; expected 4, 9, 16, 25 ….")
        along = side_nodes(order)
        return quads[:, np.stack([along[0], along[1], along[2][::-1], along[3][::-1]])]
    if node_order not in ("gmsh", "vtk"):
        raise TopologyError(f"node_order is {node_order!r}; expected 'gmsh', 'vtk' or 'lexicographic'.")
    inner = 4 + np.arange(4 * (order - 1)).reshape(4, order - 1)
    if node_order == "vtk":
        inner[2:] = inner[2:, ::-1]
    first = np.arange(4)[:, None]
    return quads[:, np.concatenate([first, inner, np.roll(first, -1)], axis=1)]


def _first_at_place(positions: Array, corners: Index, allowed: float) -> Index:
    """For each point the first corner of a quad at its place, shape (n,)."""
    from scipy.spatial import cKDTree

    used = np.unique(corners)
    pairs = cKDTree(positions[used]).query_pairs(allowed, output_type="ndarray")
    label = connected(len(used), pairs.astype(np.int64))
    first = np.unique(label, return_index=True)[1]
    same = np.arange(len(positions))
    same[used] = used[first][label]
    return same


def _counter_clockwise(nodes: Index, positions: Array) -> Index:
    """Turn clockwise quads; the area is that of the polygon of all points on the sides."""
    polygon = positions[nodes[:, :, :-1].reshape(len(nodes), -1)]
    offset = polygon - polygon[:, :1]
    following = np.roll(offset, -1, axis=1)
    area = np.sum(offset[..., 0] * following[..., 1] - following[..., 0] * offset[..., 1], axis=1)
    turned = nodes[:, ::-1, ::-1]
    return np.where((area < 0.0)[:, None, None], turned, nodes)


def _check_four(corners: Index, points: Index) -> None:
    ordered = np.sort(corners, axis=1)
    flat = (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)
    if flat.any():
        k = int(np.argmax(flat))
        raise TopologyError(
            f"quads[{k}]: corners {points[k].tolist()}; expected four points further apart than the tolerance."
        )


def _block_groups(groups: Mapping[str, ArrayLike], count: int) -> dict[str, Index]:
    members = {name: _integers(blocks, f"block_groups.{name}").ravel() for name, blocks in groups.items()}
    named = np.zeros(count, dtype=bool)
    for name, blocks in members.items():
        if blocks.size and not 0 <= blocks.min() <= blocks.max() < count:
            raise TopologyError(f"block_groups.{name}: {blocks.min()} to {blocks.max()}; expected 0 to {count - 1}.")
        named[blocks] = True
    members = {name: np.unique(blocks) for name, blocks in members.items() if blocks.size}
    if not named.all():
        rest = np.flatnonzero(~named)
        members["blocks"] = np.union1d(members["blocks"], rest) if "blocks" in members else rest
    return members


def _pairs(pairs: ArrayLike, number: Index, same: Index, name: str) -> list[Pair]:
    """Vertices of named edges, each edge once."""
    listed = _integers(pairs, f"edge_groups.{name}")
    if listed.ndim != 2 or listed.shape[1] != 2 or (listed.size and not 0 <= listed.min() <= listed.max() < len(same)):
        raise TopologyError(f"edge_groups.{name}: shape {listed.shape}; expected (k, 2), numbers of points.")
    ends = number[same[listed]]
    if (ends < 0).any():
        k = int(np.argmax((ends < 0).any(axis=1)))
        raise TopologyError(
            f"edge_groups.{name}: {listed[k].tolist()} are not both corners of quads; expected whole sides of quads."
        )
    _, first = np.unique(np.sort(ends, axis=1), axis=0, return_index=True)
    return [(a, b) for a, b in ends[np.sort(first)].tolist()]


def _curves(
    sides: Array, corners: Index, vertices: Array, spacing: Spacing, names: Sequence[str], allowed: float
) -> dict[Pair, Curve]:
    """Geometry of the sides that are not straight; ``sides`` has shape (b, 4, p + 1, 2)."""
    order = sides.shape[2] - 1
    curves: dict[Pair, Curve] = {}
    if order == 1:
        return curves
    if spacing not in ("equispaced", "gll"):
        raise TopologyError(f"spacing is {spacing!r}; expected 'equispaced' or 'gll'.")
    s = (((equispaced if spacing == "equispaced" else gauss_lobatto)(order) + 1.0) / 2.0)[:, None]
    first, last = vertices[:, :, None], np.roll(vertices, -1, axis=1)[:, :, None]
    fitted = sides + (1.0 - s) * (first - sides[:, :, :1]) + s * (last - sides[:, :, -1:])  # to vertices that are one
    bend = fitted - (1.0 - s) * first - s * last
    curved = np.abs(bend).max(axis=(2, 3)) > _STRAIGHT * np.hypot(*np.moveaxis(last - first, -1, 0))[:, :, 0]
    known: dict[Pair, Array] = {}
    for block, side in np.ndindex(curved.shape):
        a, b = int(corners[block, side]), int(corners[block, (side + 1) % 4])
        other = known.get((b, a))
        if other is None:
            known[a, b] = fitted[block, side]
            if curved[block, side]:
                curves[a, b] = LagrangeEdge(fitted[block, side], spacing)
        elif np.abs(other[::-1] - fitted[block, side]).max() > 10.0 * allowed:
            gap = float(np.hypot(*(other[::-1] - fitted[block, side]).T).max())
            raise TopologyError(
                f"quads: two of them have the side {names[a]}–{names[b]}, with points up to {gap:.2g} apart; expected "
                "the same points. Check the node order, or raise the tolerance."
            )
    return curves
