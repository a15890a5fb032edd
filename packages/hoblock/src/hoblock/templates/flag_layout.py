"""Where the vertices of a channel with a body and a flag stand: two layouts that work, adapted to other sizes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

__all__ = ["CIRCLE", "COLUMNS", "SQUARE", "FlagLayout", "FlagSizes", "flag_vertices"]

_COSINE, _SINE = math.cos(math.radians(72.0)), math.sin(math.radians(72.0))

COLUMNS = ("a", "d", "m0", "m1", "m2", "m3", "m4", "m5", "r0", "r1", "r2", "r3")
"""Columns of blocks from the inlet to the outlet."""


@dataclass(frozen=True)
class FlagSizes:
    """Sizes of a channel with a body and a flag.

    Attributes
    ----------
    length, height : float
        Of the channel.
    center : (float, float)
        Of the body.
    size : float
        Diameter of the circle or side of the square.
    flag_length, flag_thickness : float
        The flag ends at ``center[0] + size/2 + flag_length``.
    """

    length: float
    height: float
    center: tuple[float, float]
    size: float
    flag_length: float
    flag_thickness: float

    @property
    def face(self) -> float:
        """Where the body ends."""
        return self.center[0] + 0.5 * self.size

    @property
    def tip(self) -> float:
        """Where the flag ends."""
        return self.face + self.flag_length


@dataclass(frozen=True)
class FlagLayout:
    """A layout of blocks for certain sizes.

    Attributes
    ----------
    sizes : FlagSizes
        What the coordinates below belong to.
    columns : tuple of float
        x of the ``COLUMNS``.
    flag : tuple of float
        x of T1 to T5.
    middle : (float, float)
        y of the lower and the upper mid line.
    wake : tuple of (float, float)
        y of the lower and upper rows q0 to q3 behind the flag.
    """

    sizes: FlagSizes
    columns: tuple[float, ...]
    flag: tuple[float, ...]
    middle: tuple[float, float]
    wake: tuple[tuple[float, float], ...]


CIRCLE = FlagLayout(
    FlagSizes(2.5, 0.41, (0.2, 0.2), 0.1, 0.35, 0.02),
    (0.1, 0.195, 0.295, 0.335, 0.39, 0.46, 0.535, 0.612, 0.72, 1.0, 1.5, 2.5),
    (0.3, 0.37, 0.45, 0.53, 0.6),
    (0.1, 0.305),
    ((0.177, 0.223), (0.170, 0.232), (0.168, 0.237), (0.168, 0.237)),
)

SQUARE = FlagLayout(
    FlagSizes(19.5, 12.0, (5.0, 6.0), 1.0, 4.0, 0.06),
    (3.5, 5.95, 6.75, 7.05, 7.45, 8.0, 8.75, 9.65, 10.8, 12.5, 15.0, 19.5),
    (6.1, 6.9, 7.7, 8.6, 9.5),
    (4.4, 7.6),
    ((5.75, 6.25), (5.6, 6.4), (5.5, 6.5), (5.5, 6.5)),
)


def flag_vertices(sizes: FlagSizes, square: bool) -> dict[str, tuple[float, float]]:
    """Vertices by name; the coordinates of the layout itself for its own sizes."""
    layout = SQUARE if square else CIRCLE
    columns, flag = _columns(layout, sizes)
    x = dict(zip(COLUMNS, columns, strict=True))
    center = sizes.center[1]
    half = 0.5 * sizes.flag_thickness
    middle = _middle(layout, sizes)
    vertices = _square(sizes) if square else _circle(sizes)
    for k, place in enumerate(flag, start=1):
        vertices |= {f"T{k}": (place, center + half), f"B{k}": (place, center - half)}
    rows = (0.0, middle[0], middle[1], sizes.height)
    vertices |= {f"i{k}": (0.0, y) for k, y in enumerate(rows)}
    for name, y in zip("BbtT", rows, strict=True):
        vertices |= {f"{column}{name}": (x[column], y) for column in COLUMNS}
    for k, (low, high) in enumerate(_wake(layout, sizes)):
        vertices |= {f"q{k}b": (x[f"r{k}"], low), f"q{k}t": (x[f"r{k}"], high)}
    return vertices


def _columns(layout: FlagLayout, sizes: FlagSizes) -> tuple[list[float], list[float]]:
    """Columns and stations of the flag: proportional between inlet, body, tip and outlet.

    Distances from the body to its two neighbours grow no faster than the body.
    """
    known = layout.sizes
    scale = sizes.size / known.size
    front, known_front = sizes.center[0] - 0.5 * sizes.size, known.center[0] - 0.5 * known.size
    a, d = layout.columns[:2]
    ahead = (known_front - a) * min(front / known_front, 2.0 * scale)
    old = [known_front, known.face, known.tip, known.length]
    new = [front, sizes.face, sizes.tip, sizes.length]
    if d > known.face:  # behind the square: a corner there stays clear of 180 degrees however short the flag is
        behind = (d - known.face) * scale * min(1.0, math.sqrt(sizes.flag_length / known.flag_length / scale))
        old.insert(2, d)
        new.insert(2, sizes.face + behind)
    places = _mapped((*layout.columns[1:], *layout.flag), old, new)
    columns = [front - ahead, *places[: len(layout.columns) - 1]]
    if d < known.face and sizes != known:  # column d stays near the body's vertices at 72 and 288 degrees
        columns[1] = sizes.center[0] + 0.5 * sizes.size * _COSINE - _lean(layout, sizes)
    return columns, places[len(layout.columns) - 1 :]


def _lean(layout: FlagLayout, sizes: FlagSizes) -> float:
    """How far column d lies upstream of these vertices: less where the mid lines are close to the circle."""
    known, scale = layout.sizes, sizes.size / layout.sizes.size
    gaps = [
        min(high - size.center[1], size.center[1] - low) - 0.5 * size.size * _SINE
        for (low, high), size in ((_middle(layout, sizes), sizes), (layout.middle, known))
    ]
    lean = known.center[0] + 0.5 * known.size * _COSINE - layout.columns[1]
    return lean * scale * min(1.0, gaps[0] / (gaps[1] * scale))


def _mapped(places: tuple[float, ...], old: list[float], new: list[float]) -> list[float]:
    """Piecewise linear, and exact where nothing changes."""
    if old == new:
        return list(places)
    return [float(x) for x in np.interp(places, old, new)]


def _middle(layout: FlagLayout, sizes: FlagSizes) -> tuple[float, float]:
    """Mid lines: proportional between body and wall, and within 2 sizes of the body in a wide channel."""
    known, scale = layout.sizes, sizes.size / layout.sizes.size
    if sizes == known:
        return layout.middle
    middle = []
    for y, wall, known_wall, side in (
        (layout.middle[0], 0.0, 0.0, -1),
        (layout.middle[1], sizes.height, known.height, 1),
    ):
        edge, known_edge = sizes.center[1] + side * 0.5 * sizes.size, known.center[1] + side * 0.5 * known.size
        share = (y - known_edge) / (known_wall - known_edge)
        gap = abs(y - known_edge) * scale
        middle.append(edge + side * min(share * abs(wall - edge), max(2.0 * gap, gap)))
    return middle[0], middle[1]


def _wake(layout: FlagLayout, sizes: FlagSizes) -> list[tuple[float, float]]:
    """Rows behind the flag: their distances from its faces grow with the body, but leave room to the mid lines."""
    known, scale = layout.sizes, sizes.size / layout.sizes.size
    if sizes == known:
        return list(layout.wake)
    center, half, known_half = sizes.center[1], 0.5 * sizes.flag_thickness, 0.5 * known.flag_thickness
    low, high = (abs(y - center) - half for y in _middle(layout, sizes))
    rows = []
    for below, above in layout.wake:
        down = min((known.center[1] - below - known_half) * scale, 0.5 * low)
        up = min((above - known.center[1] - known_half) * scale, 0.5 * high)
        rows.append((center - half - down, center + half + up))
    return rows


def _circle(sizes: FlagSizes) -> dict[str, tuple[float, float]]:
    (x, y), r, half = sizes.center, 0.5 * sizes.size, 0.5 * sizes.flag_thickness
    root = math.sqrt(r * r - half * half)
    vertices = {"T0": (x + root, y + half), "B0": (x + root, y - half)}
    for k, angle in enumerate((72, 135, 225, 288), start=1):
        vertices[f"c{k}"] = (x + r * math.cos(math.radians(angle)), y + r * math.sin(math.radians(angle)))
    return vertices


def _square(sizes: FlagSizes) -> dict[str, tuple[float, float]]:
    (x, y), half = sizes.center, 0.5 * sizes.size
    flag = 0.5 * sizes.flag_thickness
    return {
        "T0": (x + half, y + flag),
        "c1": (x + half, y + half),
        "c2": (x - half, y + half),
        "c3": (x - half, y - half),
        "c4": (x + half, y - half),
        "B0": (x + half, y - flag),
    }
