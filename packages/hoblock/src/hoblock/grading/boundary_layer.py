"""Boundary layers: a first height that is kept, a growth, a thickness."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError
from hoblock.grading.ends import Ends, check_ends, opposite, steps_from_ends
from hoblock.grading.grading import EdgeShape
from hoblock.grading.layer_heights import (
    capped_heights,
    constant_growth,
    elements_needed,
    grown_heights,
    layer_elements,
)
from hoblock.grading.listed import Listed

Array = NDArray[np.float64]

__all__ = ["BoundaryLayer"]


@dataclass(frozen=True)
class BoundaryLayer:
    """Elements that begin with a given height and grow; the height is kept when the edge changes its length.

    Given the number n of elements and the arc length L of the edge:

    * ``first_height`` alone: all heights grow by one ratio, solved so that n elements fill L (below 1 where the first
      height is more than L/n).
    * with ``growth``: heights h, h g, h g², … until the remaining elements, all of one height, are no larger than the
      next would be. Where h is more than L/n, heights shrink by 1/g in the same way.
    * with ``growth`` and ``thickness``: the layer has the smallest number of elements, growing by g, that reach the
      thickness; the others go on from its last height with a ratio solved so that they fill L.

    Attributes
    ----------
    first_height : float
        Arc length of the first element along the edge, in the units of the coordinates.
    growth : float, optional
        Height of an element over that of its neighbour on the side of the wall, above 1; 1 only with a thickness.
    thickness : float, optional
        Arc length, needs a growth.
    ends : {"first", "second", "both"}
        Where the layer is. Both: the same at both ends.
    """

    first_height: float
    growth: float | None = None
    thickness: float | None = None
    ends: Ends = "first"

    def __post_init__(self) -> None:
        check_ends(self.ends, "boundary layer")
        for name in ("first_height", "growth", "thickness"):
            value = getattr(self, name)
            if not isinstance(value, int | float | np.number) and (value is not None or name == "first_height"):
                raise GradingError(f"boundary layer: {name} is {value!r}; expected a number.")
        if not 0.0 < self.first_height < math.inf:
            raise GradingError(f"boundary layer: first height is {self.first_height:g}; expected a positive length.")
        if self.thickness is not None:
            if self.growth is None:
                raise GradingError(
                    "boundary layer: a thickness without a growth; give the growth inside the layer too, 1 for equal "
                    "heights."
                )
            if not 0.0 < self.thickness < math.inf:
                raise GradingError(f"boundary layer: thickness is {self.thickness:g}; expected a positive length.")
        if self.growth is not None and not (1.0 < self.growth < math.inf or (self.growth == 1.0 and self.thickness)):
            raise GradingError(
                f"boundary layer: growth is {self.growth:g}; expected a number above 1 (or 1 with a thickness). "
                "Heights grow away from the wall; `ends` says where that is."
            )

    def resolved(self, shape: EdgeShape, count: int) -> Listed:
        """Return the grading of an edge of some shape with ``count`` elements.

        Raises
        ------
        GradingError
            If the first height, the growth, the thickness, the number of elements and the length do not fit together.
        """
        length = shape.length
        heights = self.heights(length, count)
        if self.ends == "second":
            inner = length - np.cumsum(heights[::-1][:-1])[::-1]
        else:
            inner = np.cumsum(heights[:-1])
            if self.ends == "both":  # rounding shall not see a difference between the ends
                half = (count - 1) // 2
                inner[count - 1 - half :] = length - inner[:half][::-1]
                if count % 2 == 0:
                    inner[half] = length / 2.0
        return Listed.at_lengths(shape, inner)

    def heights(self, length: float, count: int) -> Array:
        """Heights of the ``count`` elements of an edge of some length from its first vertex to its second, (count,).

        Raises
        ------
        GradingError
            As `resolved`.
        """
        sides = 2 if self.ends == "both" else 1
        if count <= sides:
            return self._only_first(length, count, sides)
        if self.first_height * sides >= length * (1.0 - 1e-12):
            raise GradingError(
                f"boundary layer: the first height {self.first_height:g} does not fit {'twice ' * (sides - 1)}into the "
                f"edge's length {length:.6g}. Take a smaller one."
            )
        steps = steps_from_ends(count, sides)
        if self.growth is None:
            growth = constant_growth(self.first_height, steps, length)
            heights = grown_heights(self.first_height, growth, steps, length)
        elif self.thickness is None:
            heights = self._growing(length, steps, sides, self.growth)
        else:
            heights = self._layered(length, steps, sides, self.growth, self.thickness)
        return heights[::-1] if self.ends == "second" else heights

    def least_count(self, length: float) -> int:
        """Return the smallest number of elements with which the layer fits an edge of some length.

        Without a growth, any number larger than that of its ends does. More elements are always possible as long as
        the first height is not above the even one.
        """
        sides = 2 if self.ends == "both" else 1
        if self.growth is None:
            return sides + 1
        if self.thickness is not None:
            return sides * layer_elements(self.first_height, self.growth, self.thickness) + 1
        return max(sides + 1, elements_needed(self.first_height, self.growth, sides, length))

    def reversed(self) -> BoundaryLayer:
        """Return the grading walked from the other end."""
        return BoundaryLayer(self.first_height, self.growth, self.thickness, opposite(self.ends))

    def _only_first(self, length: float, count: int, sides: int) -> Array:
        first = self.first_height
        if abs(first * count - length) > 1e-12 * length:
            raise GradingError(
                f"boundary layer: {_elements(count)} of first height {first:g} on an edge of length {length:.6g}; take "
                f"at least {sides + 1} elements, or a first height of {length / count:.6g}."
            )
        return np.full(count, first)

    def _growing(self, length: float, steps: NDArray[np.int64], sides: int, growth: float) -> Array:
        first, count = self.first_height, len(steps)
        heights = capped_heights(first, growth, steps, length)
        if heights is not None:
            return heights
        shrinking = first * count > length
        series = grown_heights(first, 1.0 / growth if shrinking else growth, steps, length)
        reach, height = float(series.sum()), length / float(series.sum() / first)
        needed = constant_growth(first, steps, length)
        if shrinking:
            raise GradingError(
                f"boundary layer: {_elements(count)} from {first:g} shrinking by {growth:g} reach {reach:.3g}, beyond "
                f"the edge's {length:.6g}; take fewer elements, a growth of {_upwards(1.0 / needed)} or a first "
                f"height of {_downwards(height)}."
            )
        raise GradingError(
            f"boundary layer: {_elements(count)} from {first:g} growing by {growth:g} reach {reach:.3g} of "
            f"{length:.6g}; take at least {elements_needed(first, growth, sides, length)} elements, a growth of "
            f"{_upwards(needed)} or a first height of {_upwards(height)}."
        )

    def _layered(self, length: float, steps: NDArray[np.int64], sides: int, growth: float, thickness: float) -> Array:
        first, count = self.first_height, len(steps)
        layer = layer_elements(first, growth, thickness)
        if sides * layer >= count:
            raise GradingError(
                f"boundary layer: {_elements(layer)} from {first:g} growing by {growth:g} make a thickness of "
                f"{thickness:g}, the edge has {_elements(count)} in all{' for two such layers' * (sides - 1)}; take at "
                f"least {sides * layer + 1} elements, or leave the thickness out."
            )
        inside = steps < layer
        heights = grown_heights(first, growth, steps, length)
        rest = length - float(heights[inside].sum())
        if rest <= 1e-12 * length:
            where = " at each end" * (sides - 1)
            raise GradingError(
                f"boundary layer: {_elements(layer)} from {first:g} growing by {growth:g}{where} "
                f"take {length - rest:.6g} of the edge's {length:.6g}; take a smaller thickness, or leave it out."
            )
        last = first * growth ** (layer - 1)
        beyond = steps[~inside] - (layer - 1)
        ratio = constant_growth(last, beyond, rest)
        heights[~inside] = grown_heights(last, ratio, beyond, length)
        return heights


def _elements(count: int) -> str:
    return f"{count} element" + "s" * (count != 1)


def _upwards(value: float) -> str:
    """Three digits, rounded up, so that what an error advises works."""
    digit = 10.0 ** (2 - math.floor(math.log10(value)))
    return f"{math.ceil(value * digit) / digit:.6g}"


def _downwards(value: float) -> str:
    digit = 10.0 ** (2 - math.floor(math.log10(value)))
    return f"{math.floor(value * digit) / digit:.6g}"
