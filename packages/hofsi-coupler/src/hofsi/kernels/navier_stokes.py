"""Element integrals of the incompressible Navier–Stokes equations on moving elements.

Functions of arrays only. Test functions are indexed by ``i``, trial functions by ``j``; ``N`` is (q, n), derivatives of
the basis are (e, q, n), integration weights (e, q). Every integral is a batched matrix product.

The weak form of the paper's Eqs. (1)–(4) on the current configuration, with the advective velocity a = u - w:

    ∫ ρ (∂u/∂t + a·∇u)·v + 2 μ ε(u):ε(v) - p ∇·v - q ∇·u  =  ∫ f·v + ∫ t·v ds
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["convection", "divergence", "grad_div", "load", "reaction", "velocity_gradient", "viscous"]


def viscous(dNx: Array, dNy: Array, weights: Array, viscosity: float) -> tuple[Array, Array, Array, Array]:
    """Blocks xx, xy, yx, yy of ∫ 2 μ ε(u):ε(v), each (e, i, j)."""
    w = (viscosity * weights)[:, :, None]
    wx, wy = w * dNx, w * dNy
    tx, ty = dNx.transpose(0, 2, 1), dNy.transpose(0, 2, 1)
    xx, yy, xy = tx @ wx, ty @ wy, tx @ wy  # xy_ij = ∫ μ ∂x N_i ∂y N_j
    yx = xy.transpose(0, 2, 1)
    # Test component a, trial component b: δ_ab ∇N_i·∇N_j + ∂_b N_i ∂_a N_j.
    return 2.0 * xx + yy, yx, xy, xx + 2.0 * yy


def grad_div(dNx: Array, dNy: Array, weights: Array, factor: float) -> tuple[Array, Array, Array, Array]:
    """Blocks xx, xy, yx, yy of ∫ γ (∇·u)(∇·v), each (e, i, j)."""
    w = (factor * weights)[:, :, None]
    tx, ty = dNx.transpose(0, 2, 1), dNy.transpose(0, 2, 1)
    xy = tx @ (w * dNy)
    return tx @ (w * dNx), xy, xy.transpose(0, 2, 1), ty @ (w * dNy)


def convection(weights: Array, J_inv: Array, density: float, advective: Array) -> tuple[Array, Array]:
    """Coefficients c_ξ and c_η of ∫ ρ N_i (a·∇N_j) = ∫ N_i (c_ξ ∂_ξ N_j + c_η ∂_η N_j), each (e, q).

    Parameters
    ----------
    J_inv : ndarray, shape (e, q, 2, 2)
        ∂ξ_c/∂x_d.
    advective : ndarray, shape (e, q, 2)
        a.
    """
    w = density * weights
    c = (J_inv @ advective[..., None])[..., 0]
    return w * c[..., 0], w * c[..., 1]


def reaction(weights: Array, density: float, gradient: Array) -> Array:
    """Coefficients of Newton's term ∫ ρ N_i (∂_b u_a) N_j, shape (a, b, e, q), of gradients ∂_b u_a (e, q, a, b)."""
    return np.asarray((density * weights) * gradient.transpose(2, 3, 0, 1))


def divergence(P: Array, dNx: Array, dNy: Array, weights: Array) -> tuple[Array, Array]:
    """-∫ ψ_k ∂_b N_j for b = x, y, each (e, k, j); P holds the pressure basis (q, k)."""
    w = -weights[:, :, None]
    return np.asarray(P.T @ (w * dNx)), np.asarray(P.T @ (w * dNy))


def velocity_gradient(dNx: Array, dNy: Array, u: Array) -> Array:
    """∂_b u_a at quadrature points, shape (e, q, a, b), of nodal velocities (e, n, 2)."""
    return np.stack([dNx @ u, dNy @ u], axis=-1)


def load(N: Array, weights: Array, density: Array) -> Array:
    """∫ f_a N_i of a force density (e, q, 2), shape (e, i, 2)."""
    return np.asarray(N.T @ (weights[:, :, None] * density))
