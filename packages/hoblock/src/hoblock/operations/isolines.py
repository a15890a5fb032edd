"""Lines across a block between its other two sides, as the transfinite map has them: curve and grading."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Between, Curve, NodalCurve
from hoblock.grading import EdgeGrading, Grading, Listed, Reversed, Uniform, element_corners, node_parameters

Array = NDArray[np.float64]

__all__ = ["isoline_curve", "isoline_grading", "resolved_isoline_grading", "side_nodes"]


@dataclass(frozen=True)
class _Blended:
    """The grading of a line across a block whose opposite sides are graded differently.

    Its corners lie where it meets the straight lines between equal indices on the two sides (`reference_positions`).
    """

    first: Grading
    second: Grading
    start: float
    stop: float

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        low, high = self.first(s), self.second(s)
        return np.asarray((low + (high - low) * self.start) / (1.0 - (self.stop - self.start) * (high - low)))


def isoline_grading(
    structure: BlockStructure, sides: tuple[int, int], fractions: tuple[float, float]
) -> Grading | EdgeGrading:
    """Grading of the line between two opposite edges.

    Parameters
    ----------
    structure : BlockStructure
    sides : (int, int)
        The two edges, on which the fraction is 0 and 1.
    fractions : (float, float)
        Where the line begins and ends between them.

    Returns
    -------
    Grading or EdgeGrading
        That of the edges if they have the same one, so that prescribed lengths hold on the line too.
    """
    first, second = (structure.gradings[side] for side in sides)
    if first == second:
        return first
    return resolved_isoline_grading(structure, sides, fractions)


def resolved_isoline_grading(
    structure: BlockStructure, sides: tuple[int, int], fractions: tuple[float, float]
) -> Grading:
    """Grading of the line between two opposite edges, as these are graded at present."""
    first, second = (structure.resolved_grading(side) for side in sides)
    if first == second:
        return first
    blended = _Blended(first, second, *fractions)
    if not any(_is_listed(grading) for grading in (first, second)):
        return blended
    corners = element_corners(blended, int(structure.topology.counts[sides[0]]))
    return Listed(tuple(corners.tolist()))


def _is_listed(grading: Grading) -> bool:
    return isinstance(grading.grading if isinstance(grading, Reversed) else grading, Listed)


def isoline_curve(
    structure: BlockStructure, sides: tuple[int, int], fractions: tuple[float, float], ends: tuple[Array, Array]
) -> Curve | None:
    """Geometry of the line between two opposite edges; None if it is straight.

    Beside a curve given by nodes it is one too.

    Parameters
    ----------
    structure, sides, fractions
        As in `isoline_grading`.
    ends : pair of ndarray, shape (2,)
    """
    first, second = (structure.curves.get(side) for side in sides)
    if first is None and second is None:
        return None
    nodal = [curve for curve in (first, second) if isinstance(curve, NodalCurve)]
    if nodal:
        return NodalCurve(_isoline_nodes(structure, sides, fractions, ends, nodal[0].order), nodal[0].order)
    fraction = 0.5 * (fractions[0] + fractions[1])
    (ax, ay), (bx, by) = (end.tolist() for end in ends)
    return Between(first, second, fraction, ((ax, ay), (bx, by)))


def _isoline_nodes(
    structure: BlockStructure,
    sides: tuple[int, int],
    fractions: tuple[float, float],
    ends: tuple[Array, Array],
    order: int,
) -> Array:
    """Nodes of elements of some order on the line between two opposite edges, shape (n p + 1, 2).

    They are the nodes the mesh of the block has there, so that a cut along the line keeps it.
    """
    count = int(structure.topology.counts[sides[0]])
    t = node_parameters(resolved_isoline_grading(structure, sides, fractions), count, order)[:, None]
    points = (1.0 - t) * ends[0] + t * ends[1]
    f = fractions[0] + (fractions[1] - fractions[0]) * t
    for side, weight in zip(sides, (1.0 - f, f), strict=True):
        along = node_parameters(structure.resolved_grading(side), count, order)
        nodes = side_nodes(structure, side, order)
        chord = along[:, None]
        points += weight * (nodes - (1.0 - chord) * nodes[0] - chord * nodes[-1])
    return points


def side_nodes(structure: BlockStructure, edge: int, order: int) -> Array:
    """Nodes of elements of some order on an edge, shape (n p + 1, 2); those of a nodal curve as they are."""
    curve = structure.curves.get(edge)
    if not isinstance(curve, NodalCurve):
        count = int(structure.topology.counts[edge])
        return structure.edge_points(edge, node_parameters(structure.resolved_grading(edge), count, order))
    if curve.order == order:
        return curve.points
    return curve(node_parameters(Uniform(), curve.count, order))
