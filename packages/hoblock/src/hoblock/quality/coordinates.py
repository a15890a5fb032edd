"""Coordinates of elements, chunk by chunk: relative to one of their nodes and scaled to [-1, 1].

Far from the origin, and for very small or large meshes, det J then neither drowns in round-off nor leaves the range of
the numbers. Both steps are harmless: a difference of two numbers has one rounding error, a power of two none.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["ElementCoordinates", "chunks", "element_coordinates"]

_CHUNK_NODES = 16384
"""Nodes of a chunk: its arrays fit into a cache of 2 MB and the overhead of NumPy calls is small (measured)."""
_HUGE_EXPONENT = 64
"""Power of two by which coordinates are divided whose differences overflow."""


@dataclass(frozen=True, eq=False)
class ElementCoordinates:
    """Scaled coordinates of some elements.

    Attributes
    ----------
    x : ndarray, shape (2, (p + 1)², k)
        In [-1, 1]; the element is the last axis. Zero for elements that are not finite.
    exponents : ndarray, shape (2, k)
        x and y of element k are ``2**exponents[:, k]`` times the scaled ones, and det J ``2**exponents.sum(axis=0)``.
    finite : ndarray of bool, shape (k,)
        False if a coordinate is NaN or infinite.
    flat : ndarray of bool, shape (k,)
        True if all x or all y of the element are equal, so that det J = 0 exactly.
    """

    x: Array
    exponents: Index
    finite: NDArray[np.bool_]
    flat: NDArray[np.bool_]

    @property
    def isotropic(self) -> Array:
        """The coordinates with one scale for x and y, the larger one, as angles and lengths need it."""
        with np.errstate(under="ignore"):
            return np.asarray(np.ldexp(self.x, (self.exponents - self.exponents.max(axis=0))[:, None]))

    def unscaled(self, det_J: Array) -> Array:
        """Return values (…, k) of det J of the scaled elements in units of the mesh."""
        with np.errstate(over="ignore", under="ignore"):
            return np.asarray(np.ldexp(det_J, self.exponents.sum(axis=0)))


def chunks(order: int, count: int) -> Iterator[slice]:
    """Consecutive elements, so many at a time that the work on them stays in the cache."""
    size = max(64, _CHUNK_NODES // (order + 1) ** 2)
    for start in range(0, count, size):
        yield slice(start, min(start + size, count))


def element_coordinates(mesh: QuadMesh, elements: slice | Index) -> ElementCoordinates:
    """Gather the nodes of some elements, relative to a node in their middle, scaled by powers of two."""
    cells = mesh.cells[elements]
    middle = cells.shape[1] // 2
    z = _gathered(mesh.points, cells)
    exponents = np.zeros((2, len(cells)), dtype=np.int64)
    finite = np.ones(len(cells), dtype=bool)
    with np.errstate(all="ignore"):
        x = _relative(z, middle)
        size = _size(x)
        strange = np.flatnonzero(~np.isfinite(size).all(axis=0))
        if strange.size:
            finite[strange] = np.isfinite(z[strange]).all(axis=1)
            x[:, :, strange] = np.where(finite[strange], _relative(z[strange] * 0.5**_HUGE_EXPONENT, middle), 0.0)
            exponents[:, strange] = _HUGE_EXPONENT
            size = _size(x)
        power = np.frexp(size)[1].astype(np.int64)
        _scale(x, power)
    return ElementCoordinates(x, exponents + power, finite, np.asarray((size == 0.0).any(axis=0) & finite))


def _gathered(points: Array, cells: Index) -> NDArray[np.complex128]:
    """Positions of nodes as complex numbers: one gather for x and y where the array allows."""
    if points.flags.c_contiguous and points.dtype == np.float64:
        return np.asarray(points.view(np.complex128)[:, 0][cells])
    return np.asarray(np.ascontiguousarray(points[cells], dtype=np.float64).view(np.complex128)[..., 0])


def _size(x: Array) -> Array:
    return np.asarray(np.maximum(x.max(axis=1), -x.min(axis=1)))


def _relative(z: NDArray[np.complex128], middle: int) -> Array:
    z = z - z[:, middle, None]
    x = np.empty((2, z.shape[1], z.shape[0]))
    x[0], x[1] = z.real.T, z.imag.T
    return x


def _scale(x: Array, power: Index) -> None:
    """Multiply by 2**-power in place; in two steps where a single factor would overflow."""
    first = np.clip(power, -1000, 1000)
    x *= np.ldexp(1.0, -first)[:, None]
    if (first != power).any():
        x *= np.ldexp(1.0, first - power)[:, None]
