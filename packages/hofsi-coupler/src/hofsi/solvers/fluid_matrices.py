"""Element matrices of the fluid, made for some elements at a time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.fem.element_matrices import MatrixMaker, batches
from hofsi.fem.geometry import Geometry, physical_gradients
from hofsi.fem.spaces import TaylorHood
from hofsi.kernels import navier_stokes as kernel
from hofsi.kernels import tensor_products

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Coefficients", "ConstantTerms", "MatrixOrigin", "SideTerm", "element_matrices"]


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
class Coefficients:
    """Coefficients of the terms that depend on the velocity, at the quadrature points, with the weights.

    Attributes
    ----------
    along_xi, along_eta : ndarray, shape (e, q)
        Of N_i ∂_ξ N_j and N_i ∂_η N_j.
    reaction : ndarray, shape (2, 2, e, q), or None
        Of N_i N_j in each pair of components.
    sides : sequence of SideTerm
    """

    along_xi: Array
    along_eta: Array
    reaction: Array | None
    sides: Sequence[SideTerm]


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


class ConstantTerms:
    """Viscosity, inertia, pressure and continuity on one mesh.

    Their blocks are made when they are asked for, and kept when they are for the second time: on a mesh that moves in
    every step it takes less time to make them in the processor's cache than to fetch them from memory.

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
        self._kept: tuple[Array, Array] | None = None

    def ask(self) -> ConstantTerms:
        """Return the terms themselves, which somebody is going to use for all elements."""
        self._asked += 1
        if self._asked == 2:
            self._keep()
        return self

    def _keep(self) -> None:
        e, n = self.space.velocity_cells.shape
        velocity, divergence = np.empty((2, 2, e, n, n)), np.empty((2, e, self.space.pressure_cells.shape[1], n))
        for batch in batches(e, self.space.dofs.shape[1]):
            velocity[:, :, batch], divergence[:, batch] = self._made(batch)
        self._kept = velocity, divergence

    def blocks(self, elements: slice) -> tuple[Array, Array]:
        """Blocks of the velocity's components (2, 2, m, n, n) and of continuity (2, m, k, n), not to be written to."""
        if self._kept is not None:
            return self._kept[0][:, :, elements], self._kept[1][:, elements]
        return self._made(elements)

    def matrices(self, elements: slice) -> Array:
        """Element matrices (m, k, k)."""
        return self.space.matrices(*self.blocks(elements))

    def _made(self, elements: slice) -> tuple[Array, Array]:
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
        _add(velocity, self._sides, elements)
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
        velocity[0, 0] += convection
        velocity[1, 1] += convection
        _add(velocity, changing.sides, elements)
        return space.matrices(velocity, divergence)

    return made


def _add(velocity: Array, sides: Sequence[SideTerm], elements: slice) -> None:
    """Add what the sides of a batch of elements contribute to its blocks (2, 2, m, n, n)."""
    for term in sides:
        here = (term.elements >= elements.start) & (term.elements < elements.stop)
        if here.any():
            np.add.at(velocity[term.row, term.column], term.elements[here] - elements.start, term.block[here])
