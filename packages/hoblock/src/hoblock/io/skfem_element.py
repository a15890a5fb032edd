"""Lagrange elements on GLL nodes for scikit-fem, of any order."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from skfem.element import ElementH1
from skfem.refdom import RefQuad

from hoblock.node_order import node_order
from hoblock.reference import gauss_lobatto, lagrange, lagrange_derivative

Array = NDArray[np.float64]

__all__ = ["ElementQuadGLL"]


class ElementQuadGLL(ElementH1):  # type: ignore[misc]  # scikit-fem is untyped
    """Lagrange element of order q on the (q + 1)² Gauss–Lobatto–Legendre nodes of scikit-fem's square [0, 1]².

    Degrees of freedom are nodal values, in the order ``node_order(q, "skfem")``. Both elements at a side must walk it
    in the same direction, which the meshes of `hoblock.io.skfem.to_skfem` do; the element is then conforming.

    Parameters
    ----------
    order : int
        Order q ≥ 1.
    """

    nodal_dofs = 1
    refdom = RefQuad

    def __init__(self, order: int) -> None:
        self.order = order
        self.nodes = 0.5 * (gauss_lobatto(order) + 1.0)
        self.facet_dofs = order - 1
        self.interior_dofs = (order - 1) ** 2
        self.maxdeg = 2 * order
        self.dofnames = (1 + self.facet_dofs + self.interior_dofs) * ["u"]
        self._local = node_order(order, "skfem")
        self.doflocs = np.stack([self.nodes[self._local % (order + 1)], self.nodes[self._local // (order + 1)]], axis=1)
        self._points: Array = np.empty(0)
        self._tables: tuple[Array, Array, Array, Array] | None = None

    def __repr__(self) -> str:
        return f"ElementQuadGLL({self.order})"

    def lbasis(self, X: Array, i: int) -> tuple[Array, Array]:
        """Value and gradient of one basis function at reference points.

        Parameters
        ----------
        X : ndarray, shape (2, …)
            Points in [0, 1]².
        i : int
            Number of the basis function.

        Returns
        -------
        value : ndarray, shape (…)
        gradient : ndarray, shape (2, …)
        """
        if not 0 <= i < len(self._local):
            self._index_error()
        a, b, da, db = self._tabulate(X)
        column, row = self._local[i] % (self.order + 1), self._local[i] // (self.order + 1)
        return a[..., column] * b[..., row], np.stack([da[..., column] * b[..., row], a[..., column] * db[..., row]])

    def _tabulate(self, X: Array) -> tuple[Array, Array, Array, Array]:
        """One-dimensional bases and derivatives in both directions, kept for the next basis function."""
        if self._tables is None or self._points.shape != X.shape or not np.array_equal(self._points, X):
            self._points = np.array(X)
            self._tables = tabulate(self.nodes, X)
        return self._tables


def tabulate(nodes: Array, X: Array) -> tuple[Any, Any, Any, Any]:
    """Lagrange bases on ``nodes`` at X[0] and at X[1], then their derivatives; each of shape (…, len(nodes))."""
    shape = (*X.shape[1:], len(nodes))
    x, y = X.reshape(2, -1)
    bases = (lagrange(nodes, x), lagrange(nodes, y), lagrange_derivative(nodes, x), lagrange_derivative(nodes, y))
    a, b, da, db = (table.reshape(shape) for table in bases)
    return a, b, da, db
