"""Elements that are not proven valid: where each is worst."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.quality.certificate import STATUS_NAMES, UNDECIDED, Certificate, certify
from hoblock.quality.coordinates import element_coordinates
from hoblock.quality.jacobian import determinant, jacobian_rows, sample_points
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_gradient

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["BadElement", "bad_elements", "invalid_elements"]


@dataclass(frozen=True)
class BadElement:
    """An element whose det J is not proven positive: where it is worst, and the likely reason.

    Attributes
    ----------
    element : int
    det_J : float
        Smallest det J found; NaN if a node is not finite.
    xi, eta : float
        Where, in the element.
    x, y : float
        Where, in the plane.
    reason : str
        A sentence on what is wrong with the element, and what to do.
    status : str
        "invalid" or "undecided".
    block : str
        Name of its block, if the block structure is known.
    """

    element: int
    det_J: float
    xi: float
    eta: float
    x: float
    y: float
    reason: str
    status: str = "invalid"
    block: str = ""


def invalid_elements(mesh: QuadMesh, subdivisions: int = 8) -> list[BadElement]:
    """Elements that are not proven valid, invalid ones first, each kind by ascending det J.

    Parameters
    ----------
    mesh : QuadMesh
    subdivisions : int
        As in `certify`.
    """
    proof = certify(mesh, subdivisions=subdivisions)
    found = bad_elements(mesh, proof, proof.doubtful)
    return sorted(found, key=lambda bad: (bad.status != "invalid", not np.isnan(bad.det_J), bad.det_J))


def bad_elements(mesh: QuadMesh, certificate: Certificate, elements: Index) -> list[BadElement]:
    """Find where some elements are worst."""
    grid = sample_points(mesh.order)
    gradient, basis = tensor_gradient(gauss_lobatto(mesh.order), grid), tensor_basis(gauss_lobatto(mesh.order), grid)
    found = []
    for start in range(0, len(elements), 256):
        some = elements[start : start + 256]
        coordinates = element_coordinates(mesh, some)
        sampled = determinant(jacobian_rows(coordinates.x.transpose(2, 1, 0), gradient))
        sampled[~coordinates.finite] = np.nan
        at = sampled.argmin(axis=1)
        smallest = coordinates.unscaled(sampled[np.arange(len(some)), at])
        with np.errstate(invalid="ignore", over="ignore"):
            places = (basis[at][:, None, :] @ mesh.points[mesh.cells[some]])[:, 0]
        for k, element in enumerate(some):
            status = int(certificate.status[element])
            (xi, eta), (x, y) = grid[at[k]].tolist(), places[k].tolist()
            reason = _reason(sampled[k], grid[at[k]], status)
            found.append(BadElement(int(element), float(smallest[k]), xi, eta, x, y, reason, STATUS_NAMES[status]))
    return found


def _reason(det_J: Array, xi: Array, status: int) -> str:
    if not np.isfinite(det_J).all():
        return "Its nodes are not finite."
    if (det_J < 0.0).all():
        return "The element is inverted: check the order of the block's vertices and the positions of its neighbours."
    if status == UNDECIDED:
        return (
            "det J comes too close to zero to tell its sign, as at a corner of 180° or a side without length: move a "
            "vertex or soften the curve."
        )
    if np.abs(xi).max() == 1.0 and np.abs(xi).min() == 1.0:
        return "The angle at that corner is 180° or more: move a vertex of its block or soften its curves."
    return (
        "Edges of its block cross or bend too far: move a vertex, split the block or soften the curve or the grading."
    )
