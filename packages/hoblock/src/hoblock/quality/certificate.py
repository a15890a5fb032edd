"""The certificate of a mesh: every element is valid, invalid or undecided, with bounds of its det J."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.quality.bounds import in_mesh_units, scaled_bounds
from hoblock.quality.coordinates import ElementCoordinates, chunks, element_coordinates
from hoblock.quality.subdivision import search

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Certificate", "INVALID", "STATUS_NAMES", "UNDECIDED", "VALID", "certify", "det_jacobian_bounds"]

VALID, UNDECIDED, INVALID = 0, 1, 2
STATUS_NAMES = ("valid", "undecided", "invalid")
"""Name of each status; the worse, the higher."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """What is proven about det J of every element of a mesh.

    An element is *valid* if det J is proven positive everywhere in it, rounding errors included, *invalid* if it is
    proven not to be positive somewhere, or a node is NaN or infinite, and *undecided* else: det J comes so close to
    zero that double precision cannot tell, as at a corner of exactly 180°.

    Attributes
    ----------
    status : ndarray of int8, shape (e,)
        `VALID` (0), `UNDECIDED` (1) or `INVALID` (2); names in `STATUS_NAMES`.
    lower, upper : ndarray, shape (e,)
        Certified bounds of det J; -∞ and ∞ where a node is not finite. Below about 1e-308 (elements of a size of
        1e-154) they are rounded, perhaps to zero; the status is not affected.
    """

    status: NDArray[np.int8]
    lower: Array
    upper: Array

    def __post_init__(self) -> None:
        for array in (self.status, self.lower, self.upper):
            array.setflags(write=False)

    @property
    def verdict(self) -> str:
        """The worst status of an element: "valid", "undecided" or "invalid"."""
        return STATUS_NAMES[int(self.status.max(initial=VALID))]

    @property
    def valid(self) -> bool:
        """Whether all elements are proven valid."""
        return not self.status.any()

    @property
    def min_det_J(self) -> float:
        """Certified lower bound of det J of the whole mesh."""
        return float(self.lower.min(initial=np.inf))

    @property
    def counts(self) -> dict[str, int]:
        """Number of elements of each status."""
        found = np.bincount(self.status, minlength=len(STATUS_NAMES))
        return {name: int(number) for name, number in zip(STATUS_NAMES, found, strict=True)}

    @property
    def doubtful(self) -> Index:
        """Elements that are not proven valid, invalid ones first, each kind by ascending lower bound."""
        elements = np.flatnonzero(self.status)
        return elements[np.lexsort((self.lower[elements], -self.status[elements].astype(int)))]


def certify(mesh: QuadMesh, *, subdivisions: int = 8) -> Certificate:
    """Prove det J > 0 for each element of a mesh, or prove the contrary, or say that neither can be proven.

    Parameters
    ----------
    mesh : QuadMesh
    subdivisions : int
        How often an element whose first bound is not positive is cut in four at most, only where it is open.

    Returns
    -------
    Certificate

    Raises
    ------
    ValueError
        If ``subdivisions`` is not an integer from 0 to 12.

    References
    ----------
    Johnen, Remacle, Geuzaine, J. Comput. Phys. 233 (2013) 359–372, doi:10.1016/j.jcp.2012.08.051.
    """
    _check(subdivisions, "certify")
    count, order = len(mesh.cells), mesh.order
    status = np.zeros(count, dtype=np.int8)
    lower, upper = np.empty(count), np.empty(count)
    for some in chunks(order, count):
        coordinates = element_coordinates(mesh, some)
        low, high = scaled_bounds(coordinates.x, order)
        if not (low > 0.0).all():
            status[some] = _decided(coordinates, order, low, high, subdivisions)
        lower[some], upper[some] = in_mesh_units(coordinates, low, high)
    return Certificate(status, lower, upper)


def _decided(
    coordinates: ElementCoordinates, order: int, low: Array, high: Array, subdivisions: int
) -> NDArray[np.int8]:
    """Status of the elements of a chunk; sharpens the bounds of those that were open."""
    status = np.zeros(len(low), dtype=np.int8)
    status[~coordinates.finite | coordinates.flat] = INVALID
    unsure = np.flatnonzero((low <= 0.0) & (status == VALID))
    found = search(coordinates.x[:, :, unsure], order, subdivisions)
    low[unsure] = np.maximum(low[unsure], found.lower)
    high[unsure] = np.maximum(high[unsure], low[unsure])
    positive = low[unsure] > 0.0
    status[unsure] = np.where(positive, VALID, np.where(found.reached <= 0.0, INVALID, UNDECIDED))
    return status


def det_jacobian_bounds(mesh: QuadMesh, subdivisions: int = 0) -> tuple[Array, Array]:
    """Certified lower and upper bounds of det J of each element, rounding errors included.

    Parameters
    ----------
    mesh : QuadMesh
    subdivisions : int
        How often an element whose lower bound is not positive is cut in four at most to sharpen that bound.

    Returns
    -------
    lower, upper : ndarray, shape (e,)
        -∞ and ∞ where a node is NaN or infinite.

    Raises
    ------
    ValueError
        If ``subdivisions`` is not an integer from 0 to 12.

    References
    ----------
    Johnen, Remacle, Geuzaine, J. Comput. Phys. 233 (2013) 359–372, doi:10.1016/j.jcp.2012.08.051.
    """
    _check(subdivisions, "det_jacobian_bounds")
    count, order = len(mesh.cells), mesh.order
    lower, upper = np.empty(count), np.empty(count)
    for some in chunks(order, count):
        coordinates = element_coordinates(mesh, some)
        low, high = scaled_bounds(coordinates.x, order)
        unsure = np.flatnonzero(low <= 0.0)
        if subdivisions and unsure.size:
            finer = search(coordinates.x[:, :, unsure], order, subdivisions, until_negative=False)
            low[unsure] = np.maximum(low[unsure], finer.lower)
        lower[some], upper[some] = in_mesh_units(coordinates, low, high)
    return lower, upper


def _check(subdivisions: int, place: str) -> None:
    whole = isinstance(subdivisions, int | np.integer) and not isinstance(subdivisions, bool)
    if not whole or not 0 <= subdivisions <= 12:
        raise ValueError(f"{place}: subdivisions is {subdivisions!r}; expected an integer from 0 to 12.")
