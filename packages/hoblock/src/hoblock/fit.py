"""How well the elements of a mesh follow the curves of its block edges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import ArcLength, Curve, NodalCurve, Piece, Reversed
from hoblock.curves.curve import breaks_of
from hoblock.errors import CurveError
from hoblock.generate import generate
from hoblock.layout import Layout, layout
from hoblock.mesh import QuadMesh
from hoblock.reference import gauss_lobatto, lagrange

Array = NDArray[np.float64]

__all__ = ["distances_along", "fit_errors"]

_PER_NODE = 8
"""Samples between neighbouring nodes: the largest error is found to 2 %."""
_STEPS = 8
_SAMPLES = 17
_SECTIONS = 50
_GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
_SETTLED = 1e-4
"""Last step along the curve, relative to the distance, whose square is what the distance may still err by."""


def fit_errors(structure: BlockStructure, order: int, mesh: QuadMesh | None = None) -> dict[int, float]:
    """Largest distance of the element sides along every curved edge from the edge's curve.

    The distance is measured normal to the curve, from samples inside the elements to the closest point near the same
    parameter. It is the error of the geometry alone: it falls like h^(p+1) for a smooth curve, and a kink of the curve
    inside an element shows as an error of first order. A curve with a method ``distance`` (points (n, 2) to distances
    (n,)) measures itself: a level set by abs(phi - level)/abs(grad phi), a first-order distance.

    Parameters
    ----------
    structure : BlockStructure
    order : int
        Order p of the elements.
    mesh : QuadMesh, optional
        The structure's mesh of this order, if it has been generated already.

    Returns
    -------
    dict of int to float
        By the number of the edge, ascending; straight edges are left out. Zero for the nodes of a simulation that the
        mesh takes as they are.

    Raises
    ------
    ValueError
        If the order is impossible, or ``mesh`` has another one or other nodes.
    CurveError
        If a curve cannot be evaluated; the error names the edge.
    """
    plan = layout(structure, order)
    if mesh is None:
        mesh = generate(structure, order, check=False)
    if (mesh.order, len(mesh.points)) != (plan.order, plan.node_count):
        raise ValueError(
            f"fit_errors: the mesh has order {mesh.order} and {len(mesh.points)} nodes; expected order {plan.order} "
            f"and {plan.node_count} nodes, as the structure's own mesh has. Leave it out."
        )
    errors: dict[int, float] = {}
    for edge in sorted(structure.curves):
        try:
            errors[edge] = _error(structure.curves[edge], plan, edge, mesh.points)
        except CurveError as error:
            raise CurveError(f"edge {structure.topology.edge_name(edge)}: {error}") from error
    return errors


def _error(curve: Curve, plan: Layout, edge: int, points: Array) -> float:
    """Largest distance along one edge."""
    order = plan.order
    if isinstance(curve, NodalCurve) and curve.order == order:
        return 0.0
    nodes = points[plan.nodes_of_edge(edge)]
    corners = plan.parameters_of_edge(edge)[::order]
    if isinstance(curve, NodalCurve):  # its elements are those of the mesh, whatever the grading
        corners = np.linspace(0.0, 1.0, curve.count + 1)
    xi = _samples(order)
    elements = np.arange(len(corners) - 1)[:, None] * order + np.arange(order + 1)
    samples = lagrange(gauss_lobatto(order), xi) @ nodes[elements]
    widths = np.diff(corners)
    t = corners[:-1, None] + 0.5 * widths[:, None] * (1.0 + xi)
    own = _own_distance(curve)
    if own is not None:
        return float(np.max(own(samples.reshape(-1, 2)), initial=0.0))
    reach = np.repeat(widths, len(xi))
    return float(distances_along(curve, samples.reshape(-1, 2), t.ravel(), reach).max(initial=0.0))


def _samples(order: int) -> Array:
    """Reference coordinates between the nodes, evenly spread from each to the next."""
    nodes = gauss_lobatto(order)
    parts = np.arange(1, _PER_NODE) / _PER_NODE
    return np.asarray((nodes[:-1, None] + np.diff(nodes)[:, None] * parts).ravel())


def _own_distance(curve: Curve) -> Callable[[Array], Array] | None:
    """The curve's own measure; a curve walked otherwise, or a part of one, is as far away as the whole."""
    while isinstance(curve, ArcLength | Piece | Reversed):
        curve = curve.curve
    own = getattr(curve, "distance", None)
    return own if callable(own) else None


def distances_along(curve: Curve, points: Array, t: Array, reach: Array) -> Array:
    """Distances of points from the parts of a curve near given parameters.

    Parameters
    ----------
    curve : Curve
    points : ndarray, shape (n, 2)
    t : ndarray, shape (n,)
        First guesses of the closest places.
    reach : ndarray, shape (n,)
        How far from ``t`` the closest place is looked for, in the curve's parameter.

    Returns
    -------
    ndarray, shape (n,)

    Notes
    -----
    Gauss–Newton steps with difference quotients along the curve. Near kinks, and where the steps do not settle, samples
    and golden sections.
    """
    best, found, current = t, np.full(len(t), np.inf), t
    lowest, highest = np.maximum(t - reach, 0.0), np.minimum(t + reach, 1.0)
    rounding = 16.0 * np.finfo(float).eps * float(np.abs(points).max(initial=0.0))
    kinks = _kinks(curve)
    near_kink = np.searchsorted(kinks, lowest) < np.searchsorted(kinks, highest, side="right")
    for _ in range(_STEPS):
        low, high = np.maximum(current - 1e-5 * reach, 0.0), np.minimum(current + 1e-5 * reach, 1.0)
        here, before, after = np.asarray(curve(np.concatenate([current, low, high])), dtype=float).reshape(3, -1, 2)
        offset, tangent = points - here, (after - before) / (high - low)[:, None]
        distance, speed = np.hypot(offset[:, 0], offset[:, 1]), np.hypot(tangent[:, 0], tangent[:, 1])
        along = np.einsum("nd,nd->n", offset, tangent) / np.where(speed > 0.0, speed, np.inf)
        best, found = np.where(distance < found, current, best), np.minimum(distance, found)
        current = np.clip(current + along / np.where(speed > 0.0, speed, np.inf), lowest, highest)
        open_ = (np.abs(along) > _SETTLED * found + rounding) & ~(
            (current == best) & ((current == 0.0) | (current == 1.0))
        )
        open_ = (open_ | near_kink) & (found > rounding)
        if not (open_ & ~near_kink).any():
            break
    if open_.any():
        found[open_] = np.minimum(found[open_], _by_sections(curve, points[open_], lowest[open_], highest[open_]))
    return np.asarray(found)


def _kinks(curve: Curve) -> Array:
    """Breaks of a curve where its direction jumps."""
    breaks = breaks_of(curve)
    if not len(breaks):
        return breaks
    step = 1e-5 * np.diff(np.concatenate(([0.0], breaks, [1.0]))).min()
    before, here, after = (np.asarray(curve(breaks + shift), dtype=float) for shift in (-step, 0.0, step))
    bend = np.hypot(*(before - 2.0 * here + after).T)
    return np.asarray(breaks[bend > 1e-3 * np.hypot(*(after - before).T)])


def _by_sections(curve: Curve, points: Array, low: Array, high: Array) -> Array:
    """Distances from parts of the curve, by samples and golden sections about the best of them."""
    grid = low + (high - low) * np.linspace(0.0, 1.0, _SAMPLES)[:, None]
    offsets = np.asarray(curve(grid.ravel()), dtype=float).reshape(*grid.shape, 2) - points
    best = np.hypot(offsets[..., 0], offsets[..., 1]).argmin(axis=0)
    low, high = (grid[np.clip(best + k, 0, _SAMPLES - 1), np.arange(len(points))] for k in (-1, 1))

    def distance(s: Array) -> Array:
        return np.asarray(np.hypot(*(np.asarray(curve(s), dtype=float) - points).T))

    for _ in range(_SECTIONS):
        first, second = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        nearer = distance(first) < distance(second)
        low, high = np.where(nearer, low, first), np.where(nearer, second, high)
    return distance(0.5 * (low + high))
