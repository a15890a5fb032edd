"""Element integrals of the incompressible Navier–Stokes equations on moving elements.

Functions of arrays only. Test functions are indexed by ``i``, trial functions by ``j``; ``N`` is (q, n), derivatives of
the basis are (e, q, n), integration weights (e, q). Every integral is a batched matrix product. Fields are evaluated on
the reference square, with ``dN`` (q, n, 2) and the inverse Jacobians ``J_inv`` (e, q, 2, 2), ∂ξ_c/∂x_d: one product for
all elements.

The weak form of the paper's Eqs. (1)–(4) on the current configuration, with the advective velocity a = u - w:

    ∫ ρ (∂u/∂t + a·∇u)·v + 2 μ ε(u):ε(v) - p ∇·v - q ∇·u  =  ∫ f·v + ∫ t·v ds

The skew-symmetric form of convection takes half of (a·∇u)·v and half of -(a·∇v)·u, integrated by parts (Temam, Bull.
Soc. Math. France 96 (1968) 115–152, doi:10.24033/bsmf.1662): its energy vanishes whatever the quadrature.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = [
    "advected_stress",
    "advected_transport",
    "advection",
    "convection",
    "divergence",
    "grad_div",
    "load",
    "reaction",
    "stress_work",
    "velocity_gradient",
    "viscous",
]


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
    """Coefficients of Newton's term ∫ ρ N_i (∂_b u_a) N_j, shape (a, b, e, q), of gradients ∂_b u_a (a, b, e, q)."""
    return np.asarray((density * weights) * gradient)


def advection(gradient: Array, advective: Array) -> Array:
    """(a·∇) u, shape (e, q, 2), of gradients ∂_b u_a (a, b, e, q) and advective velocities a (e, q, 2)."""
    x, y = advective[..., 0], advective[..., 1]
    return np.stack([row[0] * x + row[1] * y for row in gradient], axis=-1)


def advected_transport(weights: Array, J_inv: Array, density: float, u: Array) -> tuple[Array, Array]:
    """Coefficients c_ξ and c_η of ∫ ρ u_a N_i ∂_b N_j, of velocities u (e, q, 2), each (a, b, e, q)."""
    w = (density * weights) * np.moveaxis(u, -1, 0)
    along_xi, along_eta = (np.moveaxis(J_inv[:, :, c], -1, 0) for c in range(2))
    return w[:, None] * along_xi, w[:, None] * along_eta


def advected_stress(u: Array, advective: Array) -> Array:
    """-u_a a_b, shape (a, b, e, q), of velocities u and advective velocities a (e, q, 2): (a·∇v)·u is its work."""
    components, along = np.moveaxis(u, -1, 0), np.moveaxis(advective, -1, 0)
    return np.asarray(-components[:, None] * along)


def divergence(P: Array, dNx: Array, dNy: Array, weights: Array) -> tuple[Array, Array]:
    """-∫ ψ_k ∂_b N_j for b = x, y, each (e, k, j); P holds the pressure basis (q, k)."""
    w = -weights[:, :, None]
    return np.asarray(P.T @ (w * dNx)), np.asarray(P.T @ (w * dNy))


def velocity_gradient(dN: Array, J_inv: Array, u: Array) -> Array:
    """∂_b u_a at quadrature points, shape (a, b, e, q), of nodal velocities (e, n, 2)."""
    e, n, _ = u.shape
    # Rows (e, a), columns (c, q): derivatives along ξ and η.
    along = (u.transpose(0, 2, 1).reshape(2 * e, n) @ _columns(dN)).reshape(e, 2, 2, len(dN))
    result = np.empty((2, 2, e, len(dN)))
    for a in range(2):
        for b in range(2):
            np.multiply(along[:, a, 0], J_inv[:, :, 0, b], out=result[a, b])
            result[a, b] += along[:, a, 1] * J_inv[:, :, 1, b]
    return result


def stress_work(dN: Array, J_inv: Array, weights: Array, stress: Array) -> Array:
    """∫ σ_ab ∂_b N_i, shape (e, i, 2), of stresses (a, b, e, q)."""
    e, q = weights.shape
    along = np.empty((e, 2, 2, q))
    for a in range(2):
        for c in range(2):
            np.multiply(stress[a, 0], J_inv[:, :, c, 0], out=along[:, a, c])
            along[:, a, c] += stress[a, 1] * J_inv[:, :, c, 1]
            along[:, a, c] *= weights
    nodal = along.reshape(2 * e, 2 * q) @ _columns(dN).T
    return np.asarray(nodal.reshape(e, 2, -1).transpose(0, 2, 1))


def _columns(dN: Array) -> Array:
    """Reference gradients (q, n, 2) as a matrix of n rows, with the derivatives along ξ at all points first."""
    return np.asarray(dN.transpose(1, 2, 0).reshape(dN.shape[1], -1))


def load(N: Array, weights: Array, density: Array) -> Array:
    """∫ f_a N_i of a force density (e, q, 2), shape (e, i, 2)."""
    return np.asarray(N.T @ (weights[:, :, None] * density))
