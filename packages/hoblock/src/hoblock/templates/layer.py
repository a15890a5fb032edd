"""Layers of elements on a wall."""

from __future__ import annotations

from hoblock.grading import BoundaryLayer
from hoblock.grading.layer_heights import layer_elements

__all__ = ["wall_layer"]


def wall_layer(thickness: float, first_height: float, growth: float) -> tuple[int, BoundaryLayer]:
    """Number of elements across a layer, and their grading with the wall at the first vertex.

    Parameters
    ----------
    thickness : float
        Of the whole layer.
    first_height : float
        Height of the elements at the wall, less than the thickness.
    growth : float
        Largest height of an element over that of the one below it.

    Returns
    -------
    count : int
        The smallest number of elements, at least 2.
    grading : BoundaryLayer
        Its growth is constant and follows from the count and the edge's length.
    """
    return max(2, layer_elements(first_height, growth, thickness)), BoundaryLayer(first_height)
