"""Checks of what a user gives as a block structure, with messages that name the place and the way out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hoblock.curves import Curve
from hoblock.errors import CurveError, TopologyError
from hoblock.spelling import did_you_mean
from hoblock.topology import BlockTopology

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = [
    "chain_counts",
    "check_counter_clockwise",
    "check_ends",
    "check_geometry",
    "edge_pair",
    "element_count",
    "quad_table",
    "tolerance",
    "vertex_numbers",
    "vertex_table",
]


def vertex_table(vertices: Mapping[str, Sequence[float]] | Array) -> tuple[tuple[str, ...], Array]:
    """Names and positions (n, 2); vertices must be pairs of finite numbers, and distinct."""
    if isinstance(vertices, Mapping):
        names = tuple(str(name) for name in vertices)
        if len(set(names)) < len(names):
            twice = next(name for k, name in enumerate(names) if name in names[:k])
            raise TopologyError(f"vertices: two are named '{twice}' once names are texts. Rename one.")
        positions = np.array([_pair(point, name) for name, point in zip(names, vertices.values(), strict=True)])
        positions = positions.reshape(-1, 2)
    else:
        positions = np.array(vertices, dtype=float)
        if positions.ndim != 2 or positions.shape[1] != 2:
            raise TopologyError(f"vertices: shape {positions.shape}; expected (n, 2).")
        names = tuple(str(k) for k in range(len(positions)))
    if not np.isfinite(positions).all():
        raise TopologyError(f"vertex '{names[int(np.argmin(np.isfinite(positions).all(axis=1)))]}': not finite.")
    _check_distinct(names, positions)
    return names, positions


def vertex_numbers(names: Sequence[str]) -> Callable[[str | int, str], int]:
    """Return the function that tells the number of a vertex by its name, with the place for its error."""
    number = {name: k for k, name in enumerate(names)}

    def vertex(key: str | int, place: str) -> int:
        if str(key) not in number:
            raise TopologyError(f"{place}: no vertex named '{key}'{did_you_mean(str(key), names)}")
        return number[str(key)]

    return vertex


def _pair(point: Sequence[float], name: str) -> tuple[float, float]:
    try:
        x, y = (float(value) for value in point)
    except (TypeError, ValueError):
        raise TopologyError(f"vertex '{name}': {point!r}; expected two numbers (x, y).") from None
    return x, y


def edge_pair(pair: object, place: str) -> tuple[str | int, str | int]:
    """Return an edge given by its two vertices, or raise."""
    if isinstance(pair, str) or not isinstance(pair, Sequence | np.ndarray) or len(pair) != 2:
        raise TopologyError(f"{place}: {pair!r}; expected a pair of vertices. Name each edge of a path by itself.")
    return pair[0], pair[1]


def tolerance(vertices: Array) -> float:
    """How far points that ought to coincide may be apart: 1e-9 of the structure's size, more if far from the origin."""
    size, reach = float(np.ptp(vertices, axis=0).max()), float(np.abs(vertices).max())
    return 1e-9 * size + 16.0 * float(np.finfo(float).eps) * reach


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


def check_counter_clockwise(
    quads: Index,
    groups: Mapping[str, Index],
    names: Sequence[str],
    vertices: Array,
    curves: Mapping[tuple[int, int], Curve],
) -> None:
    """Blocks must have positive area; the first thing to ask, since orientation relies on it."""
    corners = vertices[quads]
    first, second = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]  # differences: safe far from 0
    area = 0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    extent = np.hypot(*first.T) * np.hypot(*second.T)
    for name, members in groups.items():
        for k in np.flatnonzero(area[members] <= 0.0):
            block = members[k]
            if area[block] + _bulge(quads[block], vertices, curves) > 1e-12 * extent[block]:
                continue
            listed = ", ".join(names[v] for v in quads[block])
            if -area[block] <= 1e-12 * extent[block]:
                raise TopologyError(
                    f"blocks.{name}[{k}] ({listed}) has no area between the chords of its edges: its vertices cross "
                    "over or lie on a line. List them one after the other round the block, or split it."
                )
            raise TopologyError(
                f"blocks.{name}[{k}] ({listed}) is clockwise or inverted (signed area {area[block]:.3g}). "
                "List its vertices counter-clockwise."
            )


def _bulge(quad: Index, vertices: Array, curves: Mapping[tuple[int, int], Curve]) -> float:
    """Area that curves add to that between the chords of a block's edges."""
    area, t = 0.0, np.linspace(0.0, 1.0, 65)
    for first, second in zip(quad.tolist(), np.roll(quad, -1).tolist(), strict=True):
        for pair, sign in (((first, second), 1.0), ((second, first), -1.0)):
            curve = curves.get(pair)
            if callable(curve):
                x, y = (np.asarray(curve(t), dtype=float) - vertices[pair[0]]).T
                area += 0.5 * sign * float(x[:-1] @ y[1:] - x[1:] @ y[:-1])
    return area


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
    edges, candidates = _near(topology.boundary_vertices, topology.edges[outer], vertices)
    first, second = vertices[topology.edges[outer[edges], 0]], vertices[topology.edges[outer[edges], 1]]
    chord, offset = second - first, vertices[candidates] - first
    squared = np.sum(chord * chord, axis=1)
    along = np.sum(offset * chord, axis=1) / squared
    off = np.abs(offset[:, 0] * chord[:, 1] - offset[:, 1] * chord[:, 0]) / squared
    close = 1e-9 + 4.0 * np.finfo(float).eps * np.abs(vertices).max(initial=0.0) / np.sqrt(squared)
    inside = (along > close) & (along < 1.0 - close) & (off < close)
    if inside.any():
        k = int(np.argmax(inside))
        name, edge = topology.vertex_names[candidates[k]], topology.edge_name(int(outer[edges[k]]))
        raise TopologyError(
            f"vertex '{name}' lies on edge {edge}: the blocks do not conform. Split the block at that edge."
        )


def _near(candidates: Index, edges: Index, vertices: Array) -> tuple[Index, Index]:
    """Pairs (edge, vertex) of edges and candidates between their ends along the longer axis of the structure.

    Sorting keeps the number of pairs near that of the edges, where all pairs of a long channel would fill the memory.
    """
    axis = int(np.argmax(np.ptp(vertices, axis=0)))
    ordered = candidates[np.argsort(vertices[candidates, axis], kind="stable")]
    place = vertices[ordered, axis]
    low, high = np.sort(vertices[edges, axis], axis=1).T
    margin = 1e-9 * (np.ptp(place) if len(place) else 0.0)
    start, stop = np.searchsorted(place, low - margin), np.searchsorted(place, high + margin, side="right")
    count = stop - start
    pair = np.repeat(np.arange(len(edges)), count)
    within = np.arange(len(pair)) - np.repeat(np.cumsum(count) - count, count)
    return pair, ordered[start[pair] + within]


def check_ends(ends: Array, corners: Array, names: Sequence[str], allowed: float, place: str) -> None:
    """The ends (2, 2) of a curve must be within ``allowed`` of its first and second vertex (2, 2)."""
    if np.shape(ends) != (2, 2):
        raise CurveError(f"{place}: returned shape {np.shape(ends)} for 2 parameters; expected (2, 2), a point a row.")
    remedy = "Check the curve's direction."
    if (np.abs(np.transpose(ends) - corners) <= allowed).all():
        remedy = "The curve seems to return a row of x and a row of y: return np.stack([x, y], axis=-1), a point a row."
    for end, corner, name in zip(ends, corners, names, strict=True):
        gap = float(np.hypot(*(end - corner)))
        if not gap <= allowed:
            raise CurveError(
                f"{place}: end point ({end[0]:g}, {end[1]:g}) is {gap:.2g} away from vertex '{name}' at "
                f"({corner[0]:g}, {corner[1]:g}); must coincide within {allowed:.1g}. {remedy}"
            )


def element_count(count: object, place: str) -> int:
    """Return a number of elements as an int, or raise."""
    if isinstance(count, bool) or not isinstance(count, int | np.integer):
        raise TopologyError(f"{place}: {count!r} elements; expected an integer >= 1.")
    if count < 1:
        raise TopologyError(f"{place}: {count} elements; expected at least 1.")
    return int(count)


def chain_counts(topology: BlockTopology, asked: Mapping[tuple[int, int], int], default: int | None) -> Index:
    """Number of elements of every edge from the counts asked for on some; conflicts in a chain are errors.

    Chains without a count get the default, or 0 if there is none.
    """
    per_chain: dict[int, tuple[int, int]] = {}
    for (first, second), count in asked.items():
        edge, _ = topology.edge(first, second)
        count = element_count(count, f"edge {topology.edge_name(edge)}")
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
    rest = 0 if default is None else element_count(default, "default number of elements")
    return np.array([per_chain.get(int(chain), (rest, 0))[0] for chain in topology.chains], dtype=np.int64)
