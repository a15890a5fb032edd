"""Where places lie in a mesh: the inverse of the element maps."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import LocationError
from hoblock.mesh import QuadMesh
from hoblock.numbering import corner_nodes
from hoblock.reference import differentiation_matrix, gauss_lobatto, lagrange, tensor_basis

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]

__all__ = ["Location", "Locations", "Locator", "find", "interpolation_weights", "locate", "location_of_node"]

_INSIDE = 1e-9  # |ξ|, |η| up to 1 plus this count as inside
_SLACK = 0.01  # places this far outside the mesh, in element sizes, count as on its boundary: curves are approximated
_MISSED = 1e-8  # distance, in element sizes, from which Newton's method did not find the place
_CONVERGED = 1e-12  # of Newton's increment in (ξ, η)
_ITERATIONS = 30
_FAR = 2.0  # |ξ|, |η| beyond which an element map means nothing
_MARGIN = 0.25  # by which the box of an element's nodes is enlarged for curved sides, in element sizes
_BATCH = 4096  # places looked for at a time, to bound the memory


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


@dataclass(frozen=True, eq=False)
class Locations:
    """Places in elements.

    Attributes
    ----------
    elements : ndarray, shape (n,)
        -1 for places outside the mesh.
    xi : ndarray, shape (n, 2)
        (ξ, η) in [-1, 1]²; NaN for places outside the mesh.
    """

    elements: Index
    xi: Array

    def __post_init__(self) -> None:
        self.elements.setflags(write=False)
        self.xi.setflags(write=False)

    @property
    def found(self) -> Mask:
        """Which places lie in the mesh, shape (n,)."""
        return np.asarray(self.elements >= 0)

    def __len__(self) -> int:
        return len(self.elements)

    def __getitem__(self, k: int) -> Location | None:
        """The location of place k, or None outside the mesh."""
        element = int(self.elements[k])
        return Location(element, float(self.xi[k, 0]), float(self.xi[k, 1])) if element >= 0 else None


@dataclass(frozen=True, eq=False)
class Locator:
    """Finds many places in one mesh; the elements are sorted into a grid of boxes once.

    Parameters
    ----------
    mesh : QuadMesh
    """

    mesh: QuadMesh

    def find(self, points: Array) -> Locations:
        """Find the elements that places lie in.

        Parameters
        ----------
        points : ndarray, shape (n, 2)
            On a face that elements share, the lowest element number wins; up to 1 % of an element's size outside the
            mesh, the nearest place on its boundary is taken, because curved boundaries are approximated.

        Returns
        -------
        Locations
        """
        points = np.asarray(points, dtype=float).reshape(-1, 2)
        elements, xi = np.full(len(points), -1), np.full((len(points), 2), np.nan)
        for start in range(0, len(points), _BATCH):
            batch = slice(start, start + _BATCH)
            places, candidates = self._candidates(points[batch])
            solutions = _solve_from_anywhere(self.mesh, candidates, points[batch][places])
            best = _best(places, candidates, solutions, self._sizes[candidates])
            elements[start + places[best]] = candidates[best]
            xi[start + places[best]] = solutions.xi[best]
        return Locations(elements, xi)

    @cached_property
    def _boxes(self) -> tuple[Array, Array]:
        """Lower and upper corners of the elements' boxes of nodes, enlarged for curved sides, each (e, 2)."""
        X = self.mesh.coordinates
        low, high = X.min(axis=1), X.max(axis=1)
        margin = _MARGIN * (high - low).max(axis=1, keepdims=True)
        return low - margin, high + margin

    @cached_property
    def _sizes(self) -> Array:
        low, high = self._boxes
        return np.asarray((high - low).max(axis=1) / (1.0 + 2.0 * _MARGIN))

    @cached_property
    def _grid(self) -> tuple[Array, Array, int]:
        """Origin and box size of the grid, and its boxes in each direction: about one for each element."""
        low, high = self._boxes
        origin, number = low.min(axis=0), max(1, int(np.sqrt(len(low))))
        return origin, np.maximum(high.max(axis=0) - origin, 1e-300) / number, number

    @cached_property
    def _members(self) -> tuple[Index, Index]:
        """Elements of all boxes of the grid, ascending in each, and where each box begins."""
        first, last = (self._box(corners) for corners in self._boxes)
        extent = last - first + 1
        elements, k = _expanded(extent.prod(axis=1))
        column, row = first[elements, 0] + k % extent[elements, 0], first[elements, 1] + k // extent[elements, 0]
        box = column + self._grid[2] * row
        order = np.argsort(box, kind="stable")
        begins = np.searchsorted(box[order], np.arange(self._grid[2] ** 2 + 1))
        return elements[order], begins

    def _box(self, points: Array) -> Index:
        origin, size, number = self._grid
        return np.asarray(np.clip((points - origin) / size, 0, number - 1).astype(np.int64))

    def _candidates(self, points: Array) -> tuple[Index, Index]:
        """Pairs of a place and an element whose enlarged box contains it, ascending."""
        members, begins = self._members
        column, row = self._box(points).T
        box = column + self._grid[2] * row
        places, k = _expanded(begins[box + 1] - begins[box])
        elements = members[begins[box[places]] + k]
        low, high = self._boxes
        inside = ((low[elements] <= points[places]) & (points[places] <= high[elements])).all(axis=1)
        return places[inside], elements[inside]


def locate(mesh: QuadMesh, target: tuple[float, float], *, of: str = "the mesh") -> Location:
    """Find the element a place lies in.

    Parameters
    ----------
    mesh : QuadMesh
    target : (float, float)
        (x, y). On a face that elements share, the lowest element number wins; up to 1 % of an element's size outside
        the mesh, the nearest place on its boundary is taken, because curved boundaries are approximated.
    of : str
        What the mesh is, for the message.

    Raises
    ------
    LocationError
        If the place is outside the mesh.
    """
    found = find(mesh, target)
    if found is None:
        node = mesh.points[np.argmin(np.hypot(*(mesh.points - target).T))]
        distance = float(np.hypot(*(node - target)))
        raise LocationError(
            f"({target[0]:g}, {target[1]:g}) is outside {of}; expected a place inside. The nearest node is "
            f"({node[0]:.6g}, {node[1]:.6g}), {distance:.3g} away. Correct the coordinates, or the blocks it should be "
            "in."
        )
    return found


def find(mesh: QuadMesh, target: tuple[float, float], start: Location | None = None) -> Location | None:
    """Find the element a place lies in, or None outside the mesh; see `locate`. For many places use `Locator`.

    Parameters
    ----------
    mesh : QuadMesh
    target : (float, float)
    start : Location, optional
        Where the place was before the mesh moved. As long as it stays inside that element no other one is looked at;
        the answer does not depend on it.
    """
    x = np.asarray(target, dtype=float)[None, :]
    if start is not None:
        kept = _solve(mesh, np.array([start.element]), x, np.array([[start.xi, start.eta]]))
        if kept.inside[0] and np.abs(kept.xi).max() < 1.0 - _INSIDE:  # on a face another element may come first
            return Location(start.element, float(kept.xi[0, 0]), float(kept.xi[0, 1]))
    return Locator(mesh).find(x)[0]


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


@dataclass(frozen=True, eq=False)
class _Solutions:
    """Ends of Newton's method in pairs of place and element: clipped to it, and how far that is from the place."""

    xi: Array
    inside: Mask
    distance: Array


def _expanded(counts: Index) -> tuple[Index, Index]:
    """Numbers 0, 0, 1, 1, 1, … repeated ``counts`` times, and the running number within each."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)


def _best(places: Index, elements: Index, solutions: _Solutions, sizes: Array) -> Index:
    """One pair for each place that is in the mesh: inside with the lowest number, else the nearest within the slack."""
    usable = np.flatnonzero(solutions.inside | (solutions.distance <= _SLACK * sizes))
    rank = np.where(solutions.inside[usable], -1.0, solutions.distance[usable])
    order = np.lexsort((elements[usable], rank, places[usable]))
    return np.asarray(usable[order][np.unique(places[usable][order], return_index=True)[1]])


def _solve_from_anywhere(mesh: QuadMesh, elements: Index, x: Array) -> _Solutions:
    """Newton's method from the nearest node, then from the centre where that fails."""
    nodes = gauss_lobatto(mesh.order)
    nearest = np.argmin(((mesh.points[mesh.cells[elements]] - x[:, None, :]) ** 2).sum(axis=-1), axis=1)
    j, i = np.divmod(nearest, mesh.order + 1)
    first = _solve(mesh, elements, x, np.stack([nodes[i], nodes[j]], axis=-1))
    again = np.flatnonzero(~first.inside)
    second = _solve(mesh, elements[again], x[again], np.zeros((len(again), 2)))
    better = second.inside | (second.distance < first.distance[again])
    for kept, other in ((first.xi, second.xi), (first.inside, second.inside), (first.distance, second.distance)):
        kept[again[better]] = other[better]
    return first


def _solve(mesh: QuadMesh, elements: Index, x: Array, xi: Array) -> _Solutions:
    """Solve x(ξ, η) = x by Newton's method; where the element map cannot be inverted the distance is infinite.

    What is sent beyond the limits of an element's map twice in a row will not come back.
    """
    if not len(x):
        return _Solutions(xi.copy(), np.zeros(0, dtype=bool), np.zeros(0))
    X, nodes = mesh.points[mesh.cells[elements]], gauss_lobatto(mesh.order)
    D = differentiation_matrix(nodes)
    xi, singular, away = xi.copy(), np.zeros(len(x), dtype=bool), np.zeros(len(x), dtype=bool)
    active = np.arange(len(x))
    for _ in range(_ITERATIONS):
        if not active.size:
            break
        position, J = _map(nodes, D, xi[active], X[active])
        missing = x[active] - position
        det_J = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
        flat = ~(np.abs(det_J) > 1e-14 * np.abs(J).max(axis=(1, 2)) ** 2)
        singular[active[flat]] = True
        adjugate = np.stack([J[:, 1, 1], -J[:, 0, 1], -J[:, 1, 0], J[:, 0, 0]], axis=-1).reshape(-1, 2, 2)
        step = (adjugate @ missing[:, :, None])[:, :, 0] / np.where(flat, 1.0, det_J)[:, None]
        step[flat] = 0.0
        target = xi[active] + step
        far = np.abs(target).max(axis=1) > _FAR
        xi[active] = np.clip(target, -_FAR, _FAR)
        done = (np.abs(step).max(axis=1) < _CONVERGED) | (far & away[active])
        away[active] = far
        active = active[~done]
    clipped = np.clip(xi, -1.0, 1.0)
    distance = np.hypot(*(x - _map(nodes, D, clipped, X)[0]).T)
    size = np.ptp(X, axis=1).max(axis=1)
    inside = (np.abs(xi).max(axis=1) <= 1.0 + _INSIDE) & (distance <= _MISSED * size) & ~singular
    return _Solutions(clipped, inside, np.where(singular, np.inf, distance))


def _map(nodes: Array, D: Array, xi: Array, X: Array) -> tuple[Array, Array]:
    """Positions (k, 2) and Jacobians ∂x_d/∂ξ_c, shape (k, d, c), of element maps X (k, n, 2), each at its (ξ, η)."""
    count = len(nodes)
    both = lagrange(nodes, xi.ravel()).reshape(len(xi), 2, count)
    slopes = both @ D
    along_eta = np.stack([both[:, 1], slopes[:, 1]], axis=1)  # of the value and its derivative
    along_xi = np.stack([both[:, 0], slopes[:, 0]], axis=1)
    rows = (along_eta @ X.reshape(len(X), count, 2 * count)).reshape(len(X), 2, count, 2)
    x = along_xi[:, None] @ rows  # (k, η: value or slope, ξ: value or slope, d)
    return x[:, 0, 0], np.stack([x[:, 0, 1], x[:, 1, 0]], axis=-1)
