"""Element matrices of the fluid, made for some elements at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.fem.element_matrices import MatrixMaker
from hofsi.fem.geometry import Geometry, physical_gradients
from hofsi.fem.spaces import TaylorHood
from hofsi.kernels import navier_stokes as kernel
from hofsi.kernels import tensor_products

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]

__all__ = ["Coefficients", "ConstantTerms", "KeptBlocks", "MatrixOrigin", "SideTerm", "SkewTerms", "element_matrices"]


@dataclass(frozen=True, eq=False)
class SideTerm:
    """What sides of elements add to the blocks of two velocity components.

    Attributes
    ----------
    row, column : int
        The components.
    elements : ndarray, shape (k,)
        An element may occur several times.
    block : ndarray, shape (k, n, n)
    """

    row: int
    column: int
    elements: Index
    block: Array


@dataclass(frozen=True, eq=False)
class SkewTerms:
    """What the skew-symmetric form of convection has beside half the plain one.

    Attributes
    ----------
    reaction : ndarray, shape (e, q), or None
        Coefficient of N_i N_j in both components.
    transport : tuple of two ndarray, each (2, 2, e, q), or None
        Coefficients of -N_j ∂_ξ N_i and -N_j ∂_η N_i in each pair of components.
    """

    reaction: Array | None
    transport: tuple[Array, Array] | None


@dataclass(frozen=True, eq=False)
class Coefficients:
    """Coefficients of the terms that depend on the velocity, at the quadrature points, with the weights.

    Attributes
    ----------
    along_xi, along_eta : ndarray, shape (e, q)
        Of N_i ∂_ξ N_j and N_i ∂_η N_j.
    reaction : ndarray, shape (2, 2, e, q), or None
        Of N_i N_j in each pair of components.
    sides : sequence of SideTerm
    skew : SkewTerms or None
        With it, the transpose of N_i ∂_ξ N_j and N_i ∂_η N_j is taken off.
    """

    along_xi: Array
    along_eta: Array
    reaction: Array | None
    sides: Sequence[SideTerm]
    skew: SkewTerms | None = None


@dataclass(frozen=True, eq=False)
class MatrixOrigin:
    """All that the element matrices of a case depend on.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
    mesh_velocity : ndarray, shape (n, 2), or None
        None without convection.
    rate : float
        Weight of the new velocity in the time derivative; 0 if steady.
    share : float
        Of the convection.
    velocity : ndarray, shape (n, 2), or None
        What they are linearised about; None without convection.
    newton : bool
        Whether they have Newton's term.
    """

    points: Array
    mesh_velocity: Array | None
    rate: float
    share: float
    velocity: Array | None
    newton: bool


class KeptBlocks:
    """Blocks of elements that stand still, by element.

    Parameters
    ----------
    space : TaylorHood

    Attributes
    ----------
    known : ndarray of bool, shape (e,)
    """

    def __init__(self, space: TaylorHood) -> None:
        e, n = space.velocity_cells.shape
        self.known = np.zeros(e, dtype=np.bool_)
        # Memory that is never written to is never used.
        self._velocity = np.empty((2, 2, e, n, n))
        self._divergence = np.empty((2, e, space.pressure_cells.shape[1], n))

    def blocks(
        self, elements: slice, standing: Mask, make: Callable[[Index], tuple[Array, Array]]
    ) -> tuple[Array, Array]:
        """Blocks of a batch of elements, made where they are not known, and known from then on where they stand."""
        missing = elements.start + np.flatnonzero(~self.known[elements])
        if missing.size:
            self._velocity[:, :, missing], self._divergence[:, missing] = make(missing)
            self.known[missing] = standing[missing]
        return self._velocity[:, :, elements], self._divergence[:, elements]


class ConstantTerms:
    """Viscosity, inertia, pressure and continuity on one mesh.

    Their blocks are made when they are asked for. Those of elements that stand still are kept, and all of them when
    they are asked for the second time: on elements that move in every step it takes less time to make them in the
    processor's cache than to fetch them from memory.

    Parameters
    ----------
    space : TaylorHood
    products : ProductTables
    geometry : Geometry
    viscosity, grad_div : float
    inertia : float
        Density times the weight of the new velocity in the time derivative.
    sides : sequence of SideTerm
    """

    def __init__(
        self,
        space: TaylorHood,
        products: tensor_products.ProductTables,
        geometry: Geometry,
        viscosity: float,
        grad_div: float,
        inertia: float,
        sides: Sequence[SideTerm],
    ) -> None:
        self.space, self.products = space, products
        self._geometry, self._viscosity, self._grad_div, self._inertia = geometry, viscosity, grad_div, inertia
        self._sides = sides
        self._asked = 0
        self._standing: Mask = np.zeros(len(space.velocity_cells), dtype=np.bool_)
        self._kept: KeptBlocks | None = None

    def take_over(self, before: ConstantTerms, standing: Mask) -> None:
        """Keep what other terms, which differ by the mesh alone, have of elements (e,) whose nodes did not move.

        The others have it no more, and make their blocks anew if somebody still asks them.
        """
        if not standing.any():
            return
        self._standing, self._kept, before._kept = standing, before._kept or KeptBlocks(self.space), None
        self._kept.known &= standing

    def ask(self) -> ConstantTerms:
        """Return the terms themselves, which somebody is going to use for all elements."""
        self._asked += 1
        if self._asked == 2:
            self._standing = np.ones(len(self.space.velocity_cells), dtype=np.bool_)
            self._kept = self._kept or KeptBlocks(self.space)
        return self

    def blocks(self, elements: slice) -> tuple[Array, Array]:
        """Blocks of the velocity's components (2, 2, m, n, n) and of continuity (2, m, k, n), not to be written to."""
        if self._kept is None or not self._standing[elements].any():
            return self._made(elements)
        return self._kept.blocks(elements, self._standing, self._made)

    def matrices(self, elements: slice) -> Array:
        """Element matrices (m, k, k)."""
        return self.space.matrices(*self.blocks(elements))

    def _made(self, elements: slice | Index) -> tuple[Array, Array]:
        space, whole = self.space, self._geometry
        geometry = Geometry(whole.x[elements], whole.weights[elements], whole.J_inv[elements])
        dNx, dNy = physical_gradients(geometry, space.velocity)
        m, n = len(geometry.weights), space.velocity_cells.shape[1]
        velocity = np.empty((2, 2, m, n, n))
        blocks = velocity[0, 0], velocity[0, 1], velocity[1, 0], velocity[1, 1]
        for block, made in zip(blocks, kernel.viscous(dNx, dNy, geometry.weights, self._viscosity), strict=True):
            block[:] = made
        if self._grad_div:
            for block, made in zip(blocks, kernel.grad_div(dNx, dNy, geometry.weights, self._grad_div), strict=True):
                block += made
        if self._inertia:
            mass = tensor_products.mass(self.products, self._inertia * geometry.weights)
            velocity[0, 0] += mass
            velocity[1, 1] += mass
        _add(velocity, self._sides, elements, len(whole.weights))
        return velocity, np.stack(kernel.divergence(space.pressure.N, dNx, dNy, geometry.weights))


def element_matrices(constant: ConstantTerms, changing: Coefficients) -> MatrixMaker:
    """Return what makes element matrices of all terms."""
    space, products = constant.space, constant.products

    def made(elements: slice) -> Array:
        kept, divergence = constant.blocks(elements)
        if changing.reaction is None:
            velocity = kept.copy()
        else:
            reaction = changing.reaction[:, :, elements]
            velocity = tensor_products.mass(products, reaction.reshape(-1, reaction.shape[-1])).reshape(kept.shape)
            velocity += kept
        convection = tensor_products.transport(products, changing.along_xi[elements], changing.along_eta[elements])
        if changing.skew is not None:
            convection = convection - convection.transpose(0, 2, 1)
            _add_skew(velocity, convection, products, changing.skew, elements)
        velocity[0, 0] += convection
        velocity[1, 1] += convection
        _add(velocity, changing.sides, elements, len(changing.along_xi))
        return space.matrices(velocity, divergence)

    return made


def _add_skew(
    velocity: Array, convection: Array, products: tensor_products.ProductTables, skew: SkewTerms, elements: slice
) -> None:
    """Add the terms to the blocks of pairs of components (2, 2, m, n, n) and to that of both (m, n, n)."""
    if skew.reaction is not None:
        convection += tensor_products.mass(products, skew.reaction[elements])
    if skew.transport is not None:
        xi, eta = (c[:, :, elements].reshape(-1, c.shape[-1]) for c in skew.transport)
        velocity -= tensor_products.transport(products, xi, eta).reshape(velocity.shape).transpose(0, 1, 2, 4, 3)


def _add(velocity: Array, sides: Sequence[SideTerm], elements: slice | Index, count: int) -> None:
    """Add what the sides of some of ``count`` elements contribute to their blocks (2, 2, m, n, n)."""
    if not sides:
        return
    place = np.full(count, -1)
    place[elements] = np.arange(velocity.shape[2])
    for term in sides:
        of = place[term.elements]
        here = of >= 0
        if here.any():
            np.add.at(velocity[term.row, term.column], of[here], term.block[here])
