"""Maps of curved elements of any order for scikit-fem."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from skfem.mapping import Mapping

from hoblock.io.skfem_element import tabulate
from hoblock.numbering import side_nodes
from hoblock.reference import gauss_lobatto, lagrange, lagrange_derivative

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["CurvedMapping"]

_STEPS = 60
_SLACK = 1e-6
_OUTSIDE = 0.01  # so far outside, in element sizes, places count as on the boundary: its curve is an approximation


class CurvedMapping(Mapping):  # type: ignore[misc]  # scikit-fem is untyped
    """Maps from the square [0, 1]² to elements whose coordinates are polynomials of order p in each direction.

    Parameters
    ----------
    mesh : skfem.MeshQuad1
        The mesh of the corners.
    coordinates : ndarray, shape (e, (p + 1)², 2)
        Nodes of each element, lexicographic.
    order : int
    """

    def __init__(self, mesh: Any, coordinates: Array, order: int) -> None:
        self.mesh = mesh
        self.dim = 2
        self.order = order
        self.coordinates = coordinates
        self.nodes = 0.5 * (gauss_lobatto(order) + 1.0)
        n = order + 1
        self._grid = np.ascontiguousarray(coordinates.reshape(-1, n, n, 2).transpose(3, 0, 1, 2))  # (d, e, j, i)
        self._sides = side_nodes(order)
        self._last: tuple[Array, Array | None, Array] | None = None

    def _contract(self, along_x: Array, along_y: Array, tind: Any) -> Array:
        """Sum over the nodes of each element: bases (q, n) or (e, q, n) to values (d, e, q)."""
        grid = self._grid if tind is None else self._grid[:, tind]
        if along_x.ndim == 2:
            rows = grid @ along_x.T  # (d, e, j, q)
            return np.asarray(np.einsum("dejq,qj->deq", rows, along_y))
        return np.asarray(np.einsum("dejq,eqj->deq", grid @ along_x.transpose(0, 2, 1), along_y))

    def F(self, X: Array, tind: Any = None) -> Array:
        """Positions (2, e, q) of reference points (2, q), or (2, e, q) if each element has its own."""
        a, b, _, _ = tabulate(self.nodes, X)
        return self._contract(a, b, tind)

    def DF(self, X: Array, tind: Any = None) -> Array:
        """Jacobians ∂x_c/∂X_d at reference points, shape (2, 2, e, q)."""
        if self._last is not None:
            points, elements, known = self._last
            if _same(points, X) and _same(elements, tind):
                return known
        a, b, da, db = tabulate(self.nodes, X)
        result = np.stack([self._contract(da, b, tind), self._contract(a, db, tind)], axis=1)
        self._last = (np.array(X), None if tind is None else np.array(tind), result)
        return result

    def detDF(self, X: Array, tind: Any = None) -> Array:  # noqa: N802  # scikit-fem's name
        """Determinants of the Jacobians, shape (e, q)."""
        J = self.DF(X, tind)
        return np.asarray(J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0])

    def invDF(self, X: Array, tind: Any = None) -> Array:  # noqa: N802  # scikit-fem's name
        """Inverses of the Jacobians, shape (2, 2, e, q)."""
        J = self.DF(X, tind)
        det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
        return np.asarray(np.stack([np.stack([J[1, 1], -J[0, 1]]), np.stack([-J[1, 0], J[0, 0]])]) / det)

    def invF(self, x: Array, tind: Any = None) -> Array:  # noqa: N802  # scikit-fem's name
        """Reference points (2, e, q) of points (2, e, q), by Newton's method from the nearest node of each element.

        Points up to 1 % of an element's size outside it are taken to its boundary.

        Raises
        ------
        ValueError
            If a point does not lie in its element.
        """
        grid = self._grid if tind is None else self._grid[:, tind]
        nodes = grid.reshape(2, grid.shape[1], 1, -1)
        nearest = ((nodes - x[..., None]) ** 2).sum(axis=0).argmin(axis=-1)
        n = self.order + 1
        X = np.stack([self.nodes[nearest % n], self.nodes[nearest // n]])
        best = np.full(x.shape[1:], np.inf)
        for _ in range(_STEPS):
            step = np.einsum("cdeq,deq->ceq", self.invDF(X, tind), x - self.F(X, tind))
            length = np.abs(step).max(axis=0)
            step *= np.minimum(1.0, 0.25 / np.maximum(length, 1e-300))  # no leap across a curved element
            X = np.clip(X + step, -_SLACK, 1.0 + _SLACK)
            if not (length < 0.5 * best).any() and (length < _SLACK).all():
                break
            best = np.minimum(best, length)
        miss = np.hypot(*(x - self.F(X, tind)))
        if (miss > _OUTSIDE * np.ptp(nodes, axis=-1).max(axis=0)).any():
            raise ValueError(f"invF: a point is {miss.max():.3g} away from its element; expected points inside it.")
        return X

    def _facet_nodes(self, find: Any) -> Array:
        """Nodes (f, p + 1, 2) of facets, from the corner of the smaller to that of the larger number."""
        facets = np.arange(self.mesh.facets.shape[1]) if find is None else np.asarray(find)
        element = self.mesh.f2t[0, facets]
        side = (self.mesh.t2f[:, element] == facets).argmax(axis=0)
        nodes = self.coordinates[element[:, None], self._sides[side]]
        first = self.mesh.t[np.array([0, 1, 3, 0])[side], element]
        forward = first == self.mesh.facets[0, facets]
        return np.asarray(np.where(forward[:, None, None], nodes, nodes[:, ::-1]))

    def G(self, X: Array, find: Any = None) -> Array:
        """Positions (2, f, q) of points (1, q) of the reference facet [0, 1] on facets."""
        return np.asarray(np.einsum("qi,fid->dfq", lagrange(self.nodes, X[0]), self._facet_nodes(find)))

    def detDG(self, X: Array, find: Any = None) -> Array:  # noqa: N802  # scikit-fem's name
        """Length of ∂x/∂X on facets, shape (f, q)."""
        tangent = np.einsum("qi,fid->dfq", lagrange_derivative(self.nodes, X[0]), self._facet_nodes(find))
        return np.asarray(np.hypot(*tangent))

    def normals(self, X: Array, tind: Any, find: Any, t2f: Array) -> Array:
        """Unit normals (2, f, q) that point out of the elements ``tind``, at their points X on the facets ``find``."""
        outward = self.mesh.elem.refdom.normals.T  # (d, s)
        side = (np.asarray(t2f)[:, tind] == np.asarray(find)).argmax(axis=0)
        n = np.einsum("cdfq,cf->dfq", self.invDF(X, tind), outward[:, side])
        return np.asarray(n / np.hypot(*n))


def _same(known: Array | None, given: Any) -> bool:
    if known is None or given is None:
        return known is given
    return known.shape == np.shape(given) and np.array_equal(known, given)
