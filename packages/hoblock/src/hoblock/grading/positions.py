"""Corners of elements and nodes along an edge, distributed by its grading."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError
from hoblock.grading.derived import Reversed
from hoblock.grading.grading import Grading
from hoblock.grading.listed import Listed
from hoblock.reference import gauss_lobatto

Array = NDArray[np.float64]

__all__ = ["element_corners", "node_parameters"]


def element_corners(grading: Grading, count: int, place: str = "grading") -> Array:
    """Positions of the ``count + 1`` element corners along an edge, from exactly 0 to exactly 1.

    Raises
    ------
    GradingError
        If the positions are not strictly increasing, the ends are not 0 and 1, or a grading lists the corners of
        another number of elements.
    """
    _check_count(grading, count, place)
    try:
        corners = np.array(grading(np.linspace(0.0, 1.0, count + 1)), dtype=float)
    except (TypeError, ValueError) as error:
        raise GradingError(
            f"{place}: {grading} fails on an array of parameters: {error}. Use NumPy's functions."
        ) from error
    if corners.shape != (count + 1,):
        raise GradingError(
            f"{place}: {grading} returned shape {corners.shape} for {count + 1} parameters; expected the same shape."
        )
    if abs(corners[0]) > 1e-12 or abs(corners[-1] - 1.0) > 1e-12:
        raise GradingError(f"{place}: {grading} maps 0 and 1 to {corners[0]:g} and {corners[-1]:g}; must keep both.")
    corners[0], corners[-1] = 0.0, 1.0
    if not np.all(np.diff(corners) > 0.0):
        k = int(np.argmin(np.diff(corners)))
        raise GradingError(
            f"{place}: {grading} is not strictly increasing: corner {k} of {count} at {corners[k]:g}, "
            f"the next at {corners[k + 1]:g}. Weaken the grading."
        )
    return corners


def node_parameters(grading: Grading, count: int, order: int, place: str = "grading") -> Array:
    """Parameters of an edge's nodes, shape (count order + 1,).

    Element corners by the grading, the GLL nodes inside an element scaled to it.

    Raises
    ------
    GradingError
        As `element_corners`.
    """
    corners = element_corners(grading, count, place)
    inner = (gauss_lobatto(order)[:-1] + 1.0) / 2.0
    nodes = corners[:-1, None] + np.diff(corners)[:, None] * inner
    return np.append(nodes.ravel(), 1.0)


def _check_count(grading: Grading, count: int, place: str) -> None:
    listed = grading.grading if isinstance(grading, Reversed) else grading
    if isinstance(listed, Listed) and listed.count != count:
        raise GradingError(
            f"{place}: the grading lists {listed.count} elements, the edge has {count}. List {count + 1} positions or "
            f"{count} sizes, or give the edge's chain {listed.count} elements."
        )
