"""Where a place lies in a mesh: the inverse of the element maps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.numbering import corner_nodes
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_gradient
from hofsi.errors import CaseError

Array = NDArray[np.float64]

__all__ = ["Location", "find", "interpolation_weights", "locate", "location_of_node"]

_INSIDE = 1e-9  # |ξ|, |η| up to 1 plus this count as inside
_SLACK = 0.01  # places this far outside the mesh, in element sizes, count as on its boundary: curves are approximated
_MISSED = 1e-8  # distance, in element sizes, from which Newton's method did not find the place
_CONVERGED = 1e-12  # of Newton's increment in (ξ, η)
_ITERATIONS = 30
_FAR = 2.0  # |ξ|, |η| beyond which an element map means nothing


@dataclass(frozen=True)
class Location:
    """A place in an element.

    Attributes
    ----------
    element : int
    xi, eta : float
        In [-1, 1].
    """

    element: int
    xi: float
    eta: float


@dataclass(frozen=True)
class _Solution:
    """End of Newton's method in one element: clipped to it, and how far the clipped place is from the target."""

    location: Location
    inside: bool
    distance: float


def locate(mesh: QuadMesh, target: tuple[float, float], place: str = "", *, of: str = "the mesh") -> Location:
    """Find the element a place lies in.

    Parameters
    ----------
    mesh : QuadMesh
    target : (float, float)
        (x, y). On a face that elements share, the lowest element number wins; up to 1 % of an element's size outside
        the mesh, the nearest place on its boundary is taken, because curved boundaries are approximated.
    place, of : str
        Where in the scene the point was written, and what the mesh is, for the message.

    Raises
    ------
    CaseError
        If the place is outside the mesh.
    """
    found = find(mesh, target)
    if found is None:
        node = mesh.points[np.argmin(np.hypot(*(mesh.points - target).T))]
        distance = float(np.hypot(*(node - target)))
        raise CaseError(
            f"({target[0]:g}, {target[1]:g}) is outside {of}; expected a place inside. The nearest node is "
            f"({node[0]:.6g}, {node[1]:.6g}), {distance:.3g} away. Correct the coordinates, or the blocks it should be "
            "in",
            place,
        )
    return found


def find(mesh: QuadMesh, target: tuple[float, float], start: Location | None = None) -> Location | None:
    """Find the element a place lies in, or None outside the mesh; see `locate`.

    Parameters
    ----------
    mesh : QuadMesh
    target : (float, float)
    start : Location, optional
        Where the place was before the mesh moved. As long as it stays in that element no other one is looked at.
    """
    x = np.asarray(target, dtype=float)
    if start is not None:
        kept = _solve(mesh, start.element, x, np.array([start.xi, start.eta]))
        if kept is not None and kept.inside:
            return kept.location
    nearest: _Solution | None = None
    for element in _candidates(mesh, x):
        solution = _solve_from_anywhere(mesh, int(element), x)
        if solution is None:
            continue
        if solution.inside:
            return solution.location
        if nearest is None or solution.distance < nearest.distance:
            nearest = solution
    if nearest is None or nearest.distance > _SLACK * _size(mesh, nearest.location.element):
        return None
    return nearest.location


def location_of_node(mesh: QuadMesh, node: int) -> Location:
    """Return the location of a node that is a corner of elements, in the one with the lowest number.

    Raises
    ------
    ValueError
        If the node is not a corner.
    """
    elements, corners = np.nonzero(mesh.corners == node)
    if not elements.size:
        raise ValueError(f"location_of_node: node {node} is not a corner of any element.")
    nodes = gauss_lobatto(mesh.order)
    j, i = divmod(int(corner_nodes(mesh.order)[corners[0]]), mesh.order + 1)
    return Location(int(elements[0]), float(nodes[i]), float(nodes[j]))


def interpolation_weights(location: Location, order: int) -> Array:
    """Weights of the (order + 1)² local nodes, lexicographic, of a field of some order at a location."""
    return np.asarray(tensor_basis(gauss_lobatto(order), np.array([[location.xi, location.eta]]))[0])


def _candidates(mesh: QuadMesh, x: Array) -> NDArray[np.int64]:
    """Elements whose box of nodes, enlarged by a quarter for curved sides, contains the place, ascending."""
    X = mesh.coordinates
    low, high = X.min(axis=1), X.max(axis=1)
    margin = 0.25 * (high - low).max(axis=1, keepdims=True)
    return np.flatnonzero(((low - margin <= x) & (x <= high + margin)).all(axis=1))


def _solve_from_anywhere(mesh: QuadMesh, element: int, x: Array) -> _Solution | None:
    """Newton's method from the nearest node, then from the centre."""
    nodes = gauss_lobatto(mesh.order)
    j, i = divmod(int(np.argmin(np.hypot(*(mesh.points[mesh.cells[element]] - x).T))), mesh.order + 1)
    solution = _solve(mesh, element, x, np.array([nodes[i], nodes[j]]))
    if solution is None or not solution.inside:
        other = _solve(mesh, element, x, np.zeros(2))
        if solution is None or (other is not None and other.distance < solution.distance):
            return other
    return solution


def _solve(mesh: QuadMesh, element: int, x: Array, xi: Array) -> _Solution | None:
    """Solve x(ξ, η) = x by Newton's method; None where the element map cannot be inverted."""
    X, nodes = mesh.points[mesh.cells[element]], gauss_lobatto(mesh.order)
    for _ in range(_ITERATIONS):
        at = xi[None, :]
        missing = x - tensor_basis(nodes, at)[0] @ X
        J = X.T @ tensor_gradient(nodes, at)[0]
        det_J = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
        if not np.abs(det_J) > 1e-14 * np.abs(J).max() ** 2:
            return None
        adjugate = np.array([[J[1, 1], -J[0, 1]], [-J[1, 0], J[0, 0]]])
        step = adjugate @ missing / det_J
        xi = np.clip(xi + step, -_FAR, _FAR)
        if np.abs(step).max() < _CONVERGED:
            break
    clipped = np.clip(xi, -1.0, 1.0)
    distance = float(np.hypot(*(x - tensor_basis(nodes, clipped[None, :])[0] @ X)))
    inside = bool(np.abs(xi).max() <= 1.0 + _INSIDE and distance <= _MISSED * _size(mesh, element))
    return _Solution(Location(element, float(clipped[0]), float(clipped[1])), inside, distance)


def _size(mesh: QuadMesh, element: int) -> float:
    X = mesh.points[mesh.cells[element]]
    return float((X.max(axis=0) - X.min(axis=0)).max())
