"""Curves of a structure whose vertices have moved."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from hoblock.curves import Curve, NodalCurve, with_ends
from hoblock.errors import TopologyError
from hoblock.grading import Grading, node_parameters
from hoblock.topology import BlockTopology

Array = NDArray[np.float64]

__all__ = ["moved_curves"]


def moved_curves(
    topology: BlockTopology,
    curves: Mapping[int, Curve],
    replaced: Mapping[int, Curve],
    vertices: tuple[Array, Array],
    grading: Callable[[int], Grading],
) -> dict[int, Curve]:
    """Return the curves of all edges after a motion.

    Parameters
    ----------
    topology : BlockTopology
    curves, replaced : mapping of int to Curve
        Those before, and those that take the place of some.
    vertices : pair of ndarray, shape (n, 2)
        Before and after.
    grading : callable
        The grading of an edge before.

    Raises
    ------
    TopologyError
        If ``replaced`` names an edge that does not exist.
    """
    for edge in replaced:
        if not isinstance(edge, int | np.integer) or not 0 <= edge < len(topology.edges):
            raise TopologyError(
                f"moved: curves has the key {edge!r}; expected edge numbers from 0 to {len(topology.edges) - 1}. "
                "Use topology.edge(first, second)."
            )
    shift, after = vertices[1] - vertices[0], vertices[1]
    result: dict[int, Curve] = {}
    for edge, curve in curves.items():
        if edge in replaced:
            continue
        first, second = topology.edges[edge]
        if not (shift[first].any() or shift[second].any()):
            result[edge] = curve
        elif isinstance(curve, NodalCurve):
            t = node_parameters(grading(edge), curve.count, curve.order)[:, None]
            result[edge] = NodalCurve(curve.points + (1.0 - t) * shift[first] + t * shift[second], curve.order)
        else:
            result[edge] = with_ends(curve, (shift[first], shift[second]), (after[first], after[second]))
    return {**result, **replaced}
