"""A nozzle between given or ready walls."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve, PiecewiseCurve, piece
from hoblock.errors import TemplateError
from hoblock.grading import Cubic, Exponential
from hoblock.templates.draft import Draft, grid_name
from hoblock.templates.parameters import Bounds, Count, Example, Fraction, Length
from hoblock.templates.template import template

Array = NDArray[np.float64]

__all__ = ["nozzle"]


@template
def nozzle(
    *,
    length: Length = 4.0,
    inlet_height: Length = 2.0,
    throat_height: Length = 1.0,
    outlet_height: Length = 1.6,
    throat: Fraction = 0.4,
    upper: Annotated[Curve, Example(("4*s", "1 - 0.4*sin(pi*s)"))] | None = None,
    lower: Annotated[Curve, Example(("4*s", "-1 + 0.2*sin(pi*s)"))] | None = None,
    half: bool = False,
    blocks: Annotated[int, Bounds("blocks", minimum=1, maximum=1000)] = 2,
    elements_along: Count = 6,
    elements_across: Count = 6,
    clustering: Annotated[float, Bounds("", minimum=0.0, below=1.0)] = 0.6,
) -> BlockStructure:
    """Nozzle: a smooth throat by default, or the region between two given walls.

    Vertices ``p0_0``, ``p0_1``, ``p1_0``, … column by column; blocks ``fluid``; edges ``inlet``, ``outlet``, ``upper``,
    ``lower``. Without given walls the nozzle begins at x = 0, its axis is y = 0, and its walls are cosines from inlet
    to throat and from throat to outlet.

    Parameters
    ----------
    length : float
        From inlet to outlet.
    inlet_height : float
        Distance between the walls at the inlet.
    throat_height : float
        Distance between the walls at the throat.
    outlet_height : float
        Distance between the walls at the outlet.
    throat : float
        Place of the throat over the length.
    upper : curve or None
        Upper wall from inlet to outlet, a map of [0, 1] to points; it takes the place of the lengths above.
    lower : curve or None
        Lower wall from inlet to outlet, a map of [0, 1] to points, together with an upper one. Without it the upper
        wall is mirrored at y = 0, or the axis is the lower wall with half.
    half : bool
        Whether the axis y = 0 is the lower wall.
    blocks : int
        Blocks along the nozzle, of equal parameter length; where a wall is not smooth, and in the throat,
        they are cut once more.
    elements_along : int
        Elements along each block.
    elements_across : int
        Elements from wall to wall.
    clustering : float
        Strength of the cubic grading towards both walls; of a half nozzle an exponential one to the upper.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range, or a lower wall is given without an upper one.
    CurveError
        If a wall is not finite somewhere.
    """
    if upper is None and lower is not None:
        raise TemplateError("got a curve without an upper wall; expected both. Give upper as well.", "lower")
    if lower is not None and half:
        raise TemplateError("got True and a lower wall; expected one of them. Remove half or lower.", "half")
    if upper is None:
        upper = _Contour(length, 0.5 * inlet_height, 0.5 * throat_height, 0.5 * outlet_height, throat)
    below = _Mirrored(upper, 0.0 if half else -1.0) if lower is None else lower
    cuts = _cuts(blocks, upper, below)
    blocks = len(cuts) - 1
    draft = Draft()
    for j, wall in enumerate((below, upper)):
        for k, point in enumerate(wall(np.array(cuts))):
            draft.vertex(grid_name(k, j), point)
        for k, (start, stop) in enumerate(pairwise(cuts)):
            draft.curve(grid_name(k, j), grid_name(k + 1, j), piece(wall, start, stop))
        draft.call(("lower", "upper")[j], *(grid_name(k, j) for k in range(blocks + 1)))
    for k in range(blocks):
        draft.block("fluid", grid_name(k, 0), grid_name(k + 1, 0), grid_name(k + 1, 1), grid_name(k, 1))
        draft.count(elements_along, grid_name(k, 0), grid_name(k + 1, 0))
    draft.call("inlet", "p0_0", "p0_1")
    draft.call("outlet", grid_name(blocks, 0), grid_name(blocks, 1))
    draft.count(elements_across, "p0_0", "p0_1")
    grading = Exponential(3.0 * clustering) if half else Cubic(clustering)
    draft.grade(grading, *((grid_name(k, 1), grid_name(k, 0)) for k in range(blocks + 1)))
    return draft.structure()


def _cuts(blocks: int, *walls: Curve) -> list[float]:
    """Parameters of the ends of blocks: equally spaced, and where a wall is not smooth."""
    places = [np.linspace(0.0, 1.0, blocks + 1), *(wall.breaks for wall in walls if isinstance(wall, PiecewiseCurve))]
    cuts = np.unique(np.concatenate(places))
    return [0.0, *(float(t) for t in cuts[1:][np.diff(cuts) > 1e-9])]


@dataclass(frozen=True)
class _Contour:
    """Upper wall of cosines, its throat at t = 1/2."""

    length: float
    inlet: float
    throat: float
    outlet: float
    place: float

    def __call__(self, t: Array) -> Array:
        t = np.asarray(t, dtype=float)
        first = t <= 0.5
        x = self.length * np.where(first, 2.0 * t * self.place, self.place + (2.0 * t - 1.0) * (1.0 - self.place))
        rise = np.where(first, self.inlet, self.outlet) - self.throat
        return np.stack([x, self.throat + rise * np.cos(np.pi * t) ** 2], axis=-1)

    @property
    def breaks(self) -> Array:
        return np.array([0.5])


@dataclass(frozen=True)
class _Mirrored:
    """A curve with its y coordinates multiplied by a factor."""

    curve: Curve
    factor: float

    def __call__(self, t: Array) -> Array:
        return np.asarray(self.curve(t) * np.array([1.0, self.factor]))

    @property
    def breaks(self) -> Array:
        return self.curve.breaks if isinstance(self.curve, PiecewiseCurve) else np.zeros(0)
