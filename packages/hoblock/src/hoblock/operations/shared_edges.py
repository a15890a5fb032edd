"""Whether two structures agree where they touch: on shared edges, and beside curved ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import NodalCurve
from hoblock.errors import TopologyError
from hoblock.grading import element_corners
from hoblock.operations.isolines import side_nodes

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["check_no_vertex_on_curve", "check_shared_edge"]

_SAMPLES = np.linspace(0.0, 1.0, 65)


def check_shared_edge(
    first: BlockStructure, second: BlockStructure, edges: tuple[int, int], forward: bool, allowed: float, place: str
) -> None:
    """An edge that two structures share must have one number of elements, one geometry and one grading in both.

    Parameters
    ----------
    first, second : BlockStructure
    edges : (int, int)
        The edge in the first and in the second.
    forward : bool
        Whether both run in one direction.
    allowed : float
        Greatest distance of points that count as one.
    place : str
        For messages.

    Raises
    ------
    TopologyError
        Naming both edges and what differs.
    """
    names = [s.topology.edge_name(edge) for s, edge in ((first, edges[0]), (second, edges[1]))]
    both = f"{place}: edge {names[1]} is edge {names[0]} of those before"
    counts = [int(s.topology.counts[edge]) for s, edge in ((first, edges[0]), (second, edges[1]))]
    if counts[0] != counts[1]:
        raise TopologyError(
            f"{both}, but has {counts[1]} elements instead of {counts[0]}. Its chain: {_chain(second, edges[1])}; the "
            f"other's: {_chain(first, edges[0])}. Make them equal by with_counts."
        )
    gap = _largest_gap(first, second, edges, forward)
    if gap > allowed:
        raise TopologyError(
            f"{both}, but their curves are up to {gap:.2g} apart (allowed: {allowed:.2g}), at equal parameters. Give "
            "both the same curve by with_curves."
        )
    corners = [_corners(s, edge) for s, edge in ((first, edges[0]), (second, edges[1]))]
    gap = float(np.hypot(*(corners[0] - (corners[1] if forward else corners[1][::-1])).T).max())
    if gap > allowed:
        raise TopologyError(
            f"{both}, but their gradings place element corners up to {gap:.2g} apart (allowed: {allowed:.2g}): "
            f"{second.gradings[edges[1]]} and {first.gradings[edges[0]]}{'' if forward else ', the other way round'}. "
            "Give both the same by with_gradings."
        )


def _chain(structure: BlockStructure, edge: int) -> str:
    topology = structure.topology
    members = np.flatnonzero(topology.chains == topology.chains[edge])
    listed = ", ".join(topology.edge_name(int(k)) for k in members[:8])
    return listed + ", …" * (len(members) > 8)


def _largest_gap(first: BlockStructure, second: BlockStructure, edges: tuple[int, int], forward: bool) -> float:
    """Largest distance of two edges at equal parameters, or of the nodes of one that is given by nodes."""
    curves = first.curves.get(edges[0]), second.curves.get(edges[1])
    nodal = [curve for curve in curves if isinstance(curve, NodalCurve)]
    pair = ((first, edges[0]), (second, edges[1]))
    if nodal:
        points = [side_nodes(structure, edge, nodal[0].order) for structure, edge in pair]
    else:
        points = [structure.edge_points(edge, _SAMPLES) for structure, edge in pair]
    return float(np.hypot(*(points[0] - (points[1] if forward else points[1][::-1])).T).max())


def _corners(structure: BlockStructure, edge: int) -> Array:
    if isinstance(structure.curves.get(edge), NodalCurve):
        return side_nodes(structure, edge, 1)
    count = int(structure.topology.counts[edge])
    return structure.edge_points(edge, element_corners(structure.resolved_grading(edge), count))


def check_no_vertex_on_curve(
    structure: BlockStructure,
    other: BlockStructure,
    vertices: Index | NDArray[np.bool_],
    allowed: float,
    owners: tuple[str, str],
) -> None:
    """No vertex of another structure may lie inside a curved edge on the boundary; straight ones are checked later.

    Parameters
    ----------
    structure : BlockStructure
        Whose edges.
    other : BlockStructure
        Whose vertices.
    vertices : ndarray
        Which of them.
    allowed : float
        Greatest distance from the curve that counts as on it.
    owners : (str, str)
        What to call the two, for messages.

    Raises
    ------
    TopologyError
        Naming vertex and edge.
    """
    topology = structure.topology
    chosen = np.intersect1d(np.arange(len(other.vertices))[vertices], other.topology.boundary_vertices)
    points = other.vertices[chosen]
    for edge in structure.curves:
        if topology.blocks_per_edge[edge] > 1 or not len(points):
            continue
        samples = structure.edge_points(edge, _SAMPLES)
        reach = float(np.hypot(*np.diff(samples, axis=0).T).max())
        offsets = np.hypot(*np.moveaxis(points[:, None, :] - samples, -1, 0))
        for k in np.flatnonzero(offsets.min(axis=1) <= reach):
            if _distance(structure, edge, points[k], float(_SAMPLES[np.argmin(offsets[k])])) <= allowed:
                name = other.topology.vertex_names[chosen[k]]
                raise TopologyError(
                    f"merge: vertex '{name}' of {owners[1]} lies on edge {topology.edge_name(edge)} of {owners[0]}: "
                    "the blocks do not conform. Split that edge's chain there (split), or move the vertex."
                )


def _distance(structure: BlockStructure, edge: int, point: Array, near: float) -> float:
    """Distance of a point from an edge near a parameter, by nested intervals."""
    low, high = max(near - 1.0 / 64.0, 0.0), min(near + 1.0 / 64.0, 1.0)
    best = np.inf
    for _ in range(12):
        t = np.linspace(low, high, 17)
        distance = np.hypot(*(structure.edge_points(edge, t) - point).T)
        k = int(np.argmin(distance))
        best = min(best, float(distance[k]))
        low, high = float(t[max(k - 1, 0)]), float(t[min(k + 1, 16)])
    return best
