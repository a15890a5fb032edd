"""Basis functions of one order at the points of a quadrature rule."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hoblock.numbering import side_nodes
from hoblock.reference import gauss_legendre, gauss_lobatto, tensor_basis, tensor_gradient, tensor_quadrature

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["ElementTable", "boundary_first", "element_table", "side_table"]


@dataclass(frozen=True)
class ElementTable:
    """Values and reference gradients of a tensor-product basis at quadrature points.

    Attributes
    ----------
    order : int
    points : ndarray, shape (q, 2)
    weights : ndarray, shape (q,)
    N : ndarray, shape (q, i)
    dN : ndarray, shape (q, i, 2)
    """

    order: int
    points: Array
    weights: Array
    N: Array
    dN: Array


@lru_cache(maxsize=64)
def element_table(order: int, count: int) -> ElementTable:
    """Basis of one order at count × count Gauss points of the square."""
    points, weights = tensor_quadrature(count)
    nodes = gauss_lobatto(order)
    return ElementTable(order, points, weights, tensor_basis(nodes, points), tensor_gradient(nodes, points))


@lru_cache(maxsize=64)
def side_table(order: int, count: int) -> tuple[ElementTable, ...]:
    """Basis of one order at Gauss points of the four sides, in the direction of each side."""
    s, weights = gauss_legendre(count)
    ones = np.ones_like(s)
    nodes = gauss_lobatto(order)
    sides = []
    for points in (
        np.stack([s, -ones], -1),
        np.stack([ones, s], -1),
        np.stack([s, ones], -1),
        np.stack([-ones, s], -1),
    ):
        sides.append(ElementTable(order, points, weights, tensor_basis(nodes, points), tensor_gradient(nodes, points)))
    return tuple(sides)


@lru_cache(maxsize=64)
def boundary_first(order: int) -> tuple[Index, int]:
    """Local nodes with those on the element's boundary first, and how many these are."""
    boundary = np.unique(side_nodes(order))
    inside = np.setdiff1d(np.arange((order + 1) ** 2), boundary)
    return np.concatenate([boundary, inside]), len(boundary)
