"""Checks of what a user gives as a block structure, with messages that name the place and the way out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import CurveError, TopologyError
from hoblock.topology import BlockTopology

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["chain_counts", "check_counter_clockwise", "check_ends", "check_geometry", "quad_table", "vertex_table"]


def vertex_table(vertices: Mapping[str, Sequence[float]] | Array) -> tuple[tuple[str, ...], Array]:
    """Names and positions (n, 2); vertices must be finite and distinct."""
    if isinstance(vertices, Mapping):
        names = tuple(str(name) for name in vertices)
        positions = np.array([tuple(map(float, point)) for point in vertices.values()], dtype=float).reshape(-1, 2)
    else:
        positions = np.array(vertices, dtype=float)
        if positions.ndim != 2 or positions.shape[1] != 2:
            raise TopologyError(f"vertices: shape {positions.shape}; expected (n, 2).")
        names = tuple(str(k) for k in range(len(positions)))
    if not np.isfinite(positions).all():
        raise TopologyError(f"vertex '{names[int(np.argmin(np.isfinite(positions).all(axis=1)))]}': not finite.")
    _check_distinct(names, positions)
    return names, positions


def _check_distinct(names: Sequence[str], positions: Array) -> None:
    """No two vertices may coincide: compares each with those that follow it in x until none is close in x."""
    if len(positions) < 2:
        return
    tolerance = 1e-12 * float(np.ptp(positions, axis=0).max())
    order = np.argsort(positions[:, 0], kind="stable")
    x, y = positions[order].T
    for shift in range(1, len(x)):
        near = np.abs(x[shift:] - x[:-shift]) <= tolerance
        if not near.any():
            return
        close = np.flatnonzero(near & (np.abs(y[shift:] - y[:-shift]) <= tolerance))
        if close.size:
            a, b = sorted((int(order[close[0]]), int(order[close[0] + shift])))
            raise TopologyError(
                f"vertices '{names[a]}' and '{names[b]}' coincide at ({positions[a][0]:g}, {positions[a][1]:g}). "
                "Use one vertex for both."
            )


def quad_table(
    groups: Mapping[str, Iterable[Sequence[str | int]]], vertex: Callable[[str | int, str], int]
) -> tuple[Index, dict[str, Index]]:
    """Quads (b, 4) and the blocks of each group."""
    quads: list[list[int]] = []
    members: dict[str, Index] = {}
    for name, blocks in groups.items():
        first = len(quads)
        for k, block in enumerate(blocks):
            place = f"blocks.{name}[{k}]"
            corners = [vertex(key, place) for key in block]
            if len(corners) != 4 or len(set(corners)) != 4:
                raise TopologyError(f"{place}: {list(block)}; expected four different vertices.")
            quads.append(corners)
        if len(quads) == first:
            raise TopologyError(f"blocks.{name}: there are no blocks; expected at least one quad of four vertices.")
        members[name] = np.arange(first, len(quads))
    if not quads:
        raise TopologyError("there are no blocks; expected at least one quad of four vertices.")
    return np.array(quads, dtype=np.int64), members


def check_counter_clockwise(quads: Index, groups: Mapping[str, Index], names: Sequence[str], vertices: Array) -> None:
    """Blocks must have positive area; the first thing to ask, since orientation relies on it."""
    corners = vertices[quads]
    ahead = np.roll(corners, -1, axis=1)
    area = 0.5 * np.sum(corners[..., 0] * ahead[..., 1] - corners[..., 1] * ahead[..., 0], axis=1)
    for name, members in groups.items():
        for k in np.flatnonzero(area[members] <= 0.0):
            block = members[k]
            listed = ", ".join(names[v] for v in quads[block])
            raise TopologyError(
                f"blocks.{name}[{k}] ({listed}) is clockwise or inverted (signed area {area[block]:.3g}). "
                "List its vertices counter-clockwise."
            )


def check_geometry(topology: BlockTopology, vertices: Array, curved: frozenset[int]) -> None:
    """Blocks must be convex, conforming, and use every vertex.

    Corners between two straight edges must be below 180°; a corner at a curved edge is left to the mesh's own check.
    """
    names, quads = topology.vertex_names, topology.quads
    corners = vertices[quads]
    after, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cross = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
    scale = np.hypot(*np.moveaxis(after, -1, 0)) * np.hypot(*np.moveaxis(before, -1, 0))
    bent = np.isin(topology.block_edges, list(curved))
    straight = ~(bent | np.roll(bent, 1, axis=1))  # corner k lies between sides k - 1 and k
    for block in np.flatnonzero(((cross <= 1e-12 * scale) & straight).any(axis=1)):
        where = topology.block_name(int(block))
        k = int(np.argmin(np.where(straight[block], cross[block] / scale[block], np.inf)))
        x, y = corners[block, k]
        raise TopologyError(
            f"{where}: the angle at vertex '{names[quads[block, k]]}' ({x:g}, {y:g}) is 180° or more. "
            "Move a vertex or split the block."
        )
    unused = np.setdiff1d(np.arange(len(names)), quads)
    if unused.size:
        listed = ", ".join(f"'{names[v]}'" for v in unused[:8])
        raise TopologyError(f"vertices {listed} belong to no block. Remove them or add the block.")
    _check_conforming(topology, vertices, curved)


def _check_conforming(topology: BlockTopology, vertices: Array, curved: frozenset[int]) -> None:
    """No boundary vertex may lie inside a straight boundary edge."""
    outer = np.setdiff1d(np.flatnonzero(topology.blocks_per_edge == 1), list(curved))
    candidates = topology.boundary_vertices
    first, second = vertices[topology.edges[outer, 0]], vertices[topology.edges[outer, 1]]
    chord = second - first
    offset = vertices[candidates][:, None] - first
    squared = np.sum(chord * chord, axis=1)
    along = np.sum(offset * chord, axis=2) / squared
    off = np.abs(offset[..., 0] * chord[:, 1] - offset[..., 1] * chord[:, 0]) / squared
    inside = (along > 1e-9) & (along < 1.0 - 1e-9) & (off < 1e-9)
    if inside.any():
        v, k = (int(index[0]) for index in np.nonzero(inside))
        raise TopologyError(
            f"vertex '{topology.vertex_names[candidates[v]]}' lies on edge {topology.edge_name(int(outer[k]))}: the "
            "blocks do not conform. Split the block at that edge."
        )


def check_ends(ends: Array, vertices: Array, names: Mapping[str, int], place: str) -> None:
    """The ends (2, 2) of a curve must meet its first and second vertex, given as name: index.

    The tolerance is 1e-9 times the size of the structure.
    """
    size = float(np.ptp(vertices, axis=0).max())
    for end, (name, vertex) in zip(ends, names.items(), strict=True):
        gap = float(np.hypot(*(end - vertices[vertex])))
        if not gap <= 1e-9 * size:
            raise CurveError(
                f"{place}: end point ({end[0]:g}, {end[1]:g}) is {gap:.2g} away from vertex '{name}' at "
                f"({vertices[vertex][0]:g}, {vertices[vertex][1]:g}); must coincide within {1e-9 * size:.1g}. "
                "Check the curve's direction."
            )


def chain_counts(topology: BlockTopology, asked: Mapping[tuple[int, int], int], default: int) -> Index:
    """Number of elements of every edge from the counts asked for on some; conflicts in a chain are errors."""
    per_chain: dict[int, tuple[int, int]] = {}
    for (first, second), count in asked.items():
        edge, _ = topology.edge(first, second)
        if count < 1:
            raise TopologyError(f"edge {topology.edge_name(edge)}: {count} elements; expected at least 1.")
        chain = int(topology.chains[edge])
        if per_chain.get(chain, (count, edge))[0] != count:
            other_count, other = per_chain[chain]
            members = [topology.edge_name(int(k)) for k in np.flatnonzero(topology.chains == chain)]
            raise TopologyError(
                f"edges {topology.edge_name(other)} and {topology.edge_name(edge)} ask for {other_count} and {count} "
                f"elements but belong to one chain of opposite edges ({', '.join(members)}), which needs one number. "
                "Change one of them, or remove it."
            )
        per_chain[chain] = (count, edge)
    if default < 1:
        raise TopologyError(f"default number of elements is {default}; expected at least 1.")
    return np.array([per_chain.get(int(chain), (default, 0))[0] for chain in topology.chains], dtype=np.int64)
