"""Directions in which block edges leave their vertices: a corner of a block has the angle between these."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import NodalCurve
from hoblock.reference import differentiation_matrix, gauss_lobatto

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["curve_end_tangents", "nodal_end_tangents", "structure_end_tangents"]

_STEP = 1e-3
"""Step of one-sided difference formulas of order four, in the parameter of a curve."""
_FORMULA = np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0


def nodal_end_tangents(nodes: Array, order: int) -> Array:
    """Unit tangents at both ends of a curve given by its element nodes, in its direction.

    Parameters
    ----------
    nodes : ndarray, shape (..., n p + 1, 2)
        GLL nodes of n elements of order p.
    order : int
        The order p.

    Returns
    -------
    ndarray, shape (..., 2, 2)
    """
    D = differentiation_matrix(gauss_lobatto(order))
    ends = np.stack([D[0] @ nodes[..., : order + 1, :], D[-1] @ nodes[..., -order - 1 :, :]], axis=-2)
    return _unit(ends)


def curve_end_tangents(structure: BlockStructure, edge: int) -> Array:
    """Unit tangents (2, 2) at both ends of a block edge, in the edge's direction.

    Those of a curve come from one-sided differences of order four.
    """
    curve = structure.curves.get(edge)
    if isinstance(curve, NodalCurve):
        return nodal_end_tangents(curve.points, curve.order)
    if curve is None:
        first, second = structure.vertices[structure.topology.edges[edge]]
        chord = _unit((second - first)[None])
        return np.concatenate([chord, chord])
    t = _STEP * np.arange(5)
    points = np.asarray(curve(np.concatenate([t, 1.0 - t])), dtype=float)
    return _unit(np.stack([_FORMULA @ points[:5], -_FORMULA @ points[5:]]))


def structure_end_tangents(structure: BlockStructure, edges: Sequence[int] | Index) -> Array:
    """Unit tangents (m, 2, 2) at both ends of some block edges."""
    return np.array([curve_end_tangents(structure, int(edge)) for edge in edges]).reshape(-1, 2, 2)


def _unit(vectors: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(vectors / np.hypot(vectors[..., 0], vectors[..., 1])[..., None])
