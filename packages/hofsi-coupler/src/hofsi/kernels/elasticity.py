"""Element integrals of elastic solids on the undeformed configuration: linear and St. Venant–Kirchhoff.

Functions of arrays only. Derivatives are taken on the reference square and carried to the undeformed body by
``J_inv`` (e, q, c, d) = ∂ξ_c/∂x_d, so that integrals over all elements are single matrix products with tables of the
basis. With the factor m = 1 (St. Venant–Kirchhoff) or m = 0 (linear), for every element its own,

    H = ∇u,   F = I + m H,   E = (H + Hᵀ + m Hᵀ H)/2,   S = λ tr(E) I + 2 μ E,   δW = ∫ F S : ∇δu,

the paper's Eqs. (5)–(7). Symmetric tensors are (xx, yy, xy) on the last axis. Arrays at quadrature points are laid out
with components outermost in memory, whatever the order of their axes, so that component arithmetic runs over contiguous
data.

The Lamé parameters are those of the plane problem: see `plane_lame_parameters`. `neo_hooke` has another law.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PAIRS = ((0, 0), (0, 1), (1, 1))  # of directions on the reference square, where their order does not matter

__all__ = [
    "PAIRS",
    "body_force",
    "components_outermost",
    "deformation_gradient",
    "displacement_gradient",
    "energy_density",
    "geometric_terms",
    "gradient_products",
    "internal_force",
    "mass",
    "plane_lame_parameters",
    "pressure_force",
    "pressure_stiffness",
    "pulled_back",
    "quadratic_stress",
    "stiffness",
    "stiffness_of_terms",
    "stress",
    "traction_force",
]


def plane_lame_parameters(youngs_modulus: float, poissons_ratio: float, *, stress: bool) -> tuple[float, float]:
    """Lamé parameters λ and μ of the plane problem.

    Parameters
    ----------
    youngs_modulus, poissons_ratio : float
        E > 0, -1 < ν < 0.5.
    stress : bool
        Plane stress: λ is replaced by 2 λ μ/(λ + 2 μ), which makes the out-of-plane stress zero for both laws.
    """
    E, nu = youngs_modulus, poissons_ratio
    mu = E / (2.0 * (1.0 + nu))
    lame = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    return (2.0 * lame * mu / (lame + 2.0 * mu) if stress else lame), mu


def components_outermost(tensor: Array) -> Array:
    """Return a copy of a tensor field (e, q, a, b) with the components outermost in memory."""
    return np.moveaxis(np.ascontiguousarray(np.moveaxis(tensor, (2, 3), (0, 1))), (0, 1), (2, 3))


def displacement_gradient(u: Array, dN: Array, J_inv: Array) -> Array:
    """∂u_a/∂x_d at quadrature points, shape (e, q, a, d).

    Parameters
    ----------
    u : ndarray, shape (e, i, 2)
    dN : ndarray, shape (q, i, 2)
        Derivatives along ξ and η.
    J_inv : ndarray, shape (e, q, 2, 2)
    """
    q, i, _ = dN.shape
    e = len(u)
    along = (u.transpose(2, 0, 1).reshape(2 * e, i) @ dN.transpose(1, 2, 0).reshape(i, 2 * q)).reshape(2, e, 2, q)
    H = np.empty((2, 2, e, q))
    for a in range(2):
        for d in range(2):
            H[a, d] = along[a, :, 0] * J_inv[..., 0, d] + along[a, :, 1] * J_inv[..., 1, d]
    return np.moveaxis(H, (0, 1), (2, 3))


def deformation_gradient(H: Array, m: Array) -> Array:
    """F = I + m H, shape (e, q, a, d); m is (e, 1)."""
    F = np.empty((2, 2, *H.shape[:2]))
    for a in range(2):
        for d in range(2):
            F[a, d] = m * H[..., a, d]
        F[a, a] += 1.0
    return np.moveaxis(F, (0, 1), (2, 3))


def _quadratic_strain(H: Array, m: Array) -> tuple[Array, Array, Array]:
    xx, xy, yx, yy = H[..., 0, 0], H[..., 0, 1], H[..., 1, 0], H[..., 1, 1]
    half = 0.5 * m
    return half * (xx * xx + yx * yx), half * (xy * xy + yy * yy), half * (xx * xy + yx * yy)


def _hooke(xx: Array, yy: Array, xy: Array, lame_lambda: Array, lame_mu: Array) -> Array:
    S = np.empty((3, *xx.shape))
    trace = lame_lambda * (xx + yy)
    S[0] = trace + 2.0 * lame_mu * xx
    S[1] = trace + 2.0 * lame_mu * yy
    S[2] = 2.0 * lame_mu * xy
    return np.moveaxis(S, 0, 2)


def stress(H: Array, lame_lambda: Array, lame_mu: Array, m: Array) -> Array:
    """Second Piola–Kirchhoff stress S of a displacement gradient, shape (e, q, 3); the parameters are (e, 1).

    Computed from H, not from FᵀF - I, which would lose digits where strains are small.
    """
    xx, yy, xy = _quadratic_strain(H, m)
    return _hooke(xx + H[..., 0, 0], yy + H[..., 1, 1], xy + 0.5 * (H[..., 0, 1] + H[..., 1, 0]), lame_lambda, lame_mu)


def energy_density(H: Array, S: Array, m: Array) -> Array:
    """Energy per undeformed volume, S:E/2, of a displacement gradient and the stress that belongs to it, (e, q)."""
    xx, yy, xy = _quadratic_strain(H, m)
    xx, yy, xy = xx + H[..., 0, 0], yy + H[..., 1, 1], xy + 0.5 * (H[..., 0, 1] + H[..., 1, 0])
    return np.asarray(0.5 * (S[..., 0] * xx + S[..., 1] * yy) + S[..., 2] * xy)


def quadratic_stress(H: Array, lame_lambda: Array, lame_mu: Array, m: Array) -> Array:
    """Stress of the strain m HᵀH/2 alone, shape (e, q, 3).

    What an increment with gradient H adds to the stress beyond its linearisation: spurious membrane stress if the
    increment turns a thin plate.
    """
    return _hooke(*_quadratic_strain(H, m), lame_lambda, lame_mu)


def internal_force(F: Array, S: Array, dN: Array, J_inv: Array, weights: Array) -> Array:
    """∫ F S : ∇N_i e_a over the undeformed elements, shape (e, i, a).

    Parameters
    ----------
    F : ndarray, shape (e, q, 2, 2)
    S : ndarray, shape (e, q, 3)
    dN : ndarray, shape (q, i, 2)
    J_inv : ndarray, shape (e, q, 2, 2)
    weights : ndarray, shape (e, q)
    """
    e, q = weights.shape
    wx, wy, wxy = (weights * S[..., k] for k in range(3))
    pulled = np.empty((2, e, 2, q))
    for a in range(2):
        P = (F[..., a, 0] * wx + F[..., a, 1] * wxy, F[..., a, 0] * wxy + F[..., a, 1] * wy)
        for c in range(2):
            pulled[a, :, c] = P[0] * J_inv[..., c, 0] + P[1] * J_inv[..., c, 1]
    f = pulled.reshape(2 * e, 2 * q) @ dN.transpose(2, 0, 1).reshape(2 * q, -1)
    return f.reshape(2, e, -1).transpose(1, 2, 0)


def gradient_products(dN: Array) -> tuple[Array, Array]:
    """Tables of ∂_c N_i ∂_c' N_j that turn coefficients into element matrices.

    Parameters
    ----------
    dN : ndarray, shape (q, i, 2)

    Returns
    -------
    symmetric : ndarray, shape (3 q, i²)
        For coefficients that are symmetric in (c, c'): ξξ, ξη + ηξ, ηη.
    full : ndarray, shape (4 q, i²)
        ξξ, ξη, ηξ, ηη.
    """
    q, i, _ = dN.shape
    along = dN.transpose(2, 0, 1)
    products = (along[:, None, :, :, None] * along[None, :, :, None, :]).reshape(2, 2, q, i * i)
    symmetric = np.concatenate([products[0, 0], products[0, 1] + products[1, 0], products[1, 1]])
    return symmetric, products.reshape(4 * q, i * i)


def stiffness(
    F: Array,
    S: Array,
    lame_lambda: Array,
    lame_mu: Array,
    m: Array,
    products: tuple[Array, Array],
    J_inv: Array,
    weights: Array,
) -> Array:
    """Derivative of `internal_force`, shape (e, 2 i, 2 j), with local unknowns 2 i + a.

    With A_{aDbC} = δ_ab m S_DC + λ F_aD F_bC + μ ((FFᵀ)_ab δ_DC + F_aC F_bD). The stress S enters the first,
    geometric, term only: given another stress than that of F, the other terms stay those of F.

    Parameters
    ----------
    F : ndarray, shape (e, q, 2, 2)
    S : ndarray, shape (e, q, 3)
    lame_lambda, lame_mu, m : ndarray, shape (e, 1)
    products : pair of ndarray
        From `gradient_products`.
    J_inv : ndarray, shape (e, q, 2, 2)
    weights : ndarray, shape (e, q)
    """
    wl, wm = lame_lambda * weights, lame_mu * weights
    push = pulled_back(F, J_inv)
    FF = [
        F[..., 0, 0] ** 2 + F[..., 0, 1] ** 2,
        F[..., 1, 0] ** 2 + F[..., 1, 1] ** 2,
        F[..., 0, 0] * F[..., 1, 0] + F[..., 0, 1] * F[..., 1, 1],
    ]
    metric = [J_inv[..., c, 0] * J_inv[..., k, 0] + J_inv[..., c, 1] * J_inv[..., k, 1] for c, k in PAIRS]
    geometric = geometric_terms(S, J_inv, m * weights)
    return stiffness_of_terms(
        push,
        wl,
        wm,
        lambda a, n: wm * FF[a] * metric[n] + geometric[n],
        lambda c, k: wm * (push[0][k] * push[1][c] + FF[2] * metric[c + k]),
        products,
    )


def pulled_back(F: Array, J_inv: Array) -> list[list[Array]]:
    """F J_invᵀ by components a and c, each of shape (e, q)."""
    return [[F[..., a, 0] * J_inv[..., c, 0] + F[..., a, 1] * J_inv[..., c, 1] for c in range(2)] for a in range(2)]


def geometric_terms(S: Array, J_inv: Array, weights: Array) -> list[Array]:
    """Weighted stress on the reference square, J_inv S J_invᵀ, by the pairs (c, c') ξξ, ξη, ηη."""
    J = [[J_inv[..., c, d] for d in range(2)] for c in range(2)]
    return [
        weights
        * (
            S[..., 0] * J[c][0] * J[k][0]
            + S[..., 1] * J[c][1] * J[k][1]
            + S[..., 2] * (J[c][0] * J[k][1] + J[c][1] * J[k][0])
        )
        for c, k in PAIRS
    ]


def stiffness_of_terms(
    push: list[list[Array]],
    wl: Array,
    wm: Array,
    same: Callable[[int, int], Array],
    mixed: Callable[[int, int], Array],
    products: tuple[Array, Array],
) -> Array:
    """Element matrices of what laws have in common, shape (e, 2 i, 2 j).

    ∫ (λ g_ac g_bc' + s_abcc') ∂_c N_i ∂_c' N_j, plus μ g_ac g_ac' where a = b, with the weighted coefficients λ and μ.

    Parameters
    ----------
    push : list of list of ndarray
        g, by a and c.
    wl, wm : ndarray, shape (e, q)
        λ and μ.
    same : callable
        s where a = b, from a and the number of the pair (c, c') in `PAIRS`.
    mixed : callable
        s where a = 0, b = 1, from c and c'.
    products : pair of ndarray
        From `gradient_products`.
    """
    e, q = wl.shape
    i = round(products[0].shape[1] ** 0.5)
    K = np.empty((e, i, 2, i, 2))
    T = np.empty((e, 3, q))
    for a in range(2):
        for n, (c, k) in enumerate(PAIRS):
            T[:, n] = (wl + wm) * push[a][c] * push[a][k] + same(a, n)
        K[:, :, a, :, a] = (T.reshape(e, -1) @ products[0]).reshape(e, i, i)
    T = np.empty((e, 4, q))
    for c in range(2):
        for k in range(2):
            T[:, 2 * c + k] = wl * push[0][c] * push[1][k] + mixed(c, k)
    xy = (T.reshape(e, -1) @ products[1]).reshape(e, i, i)
    K[:, :, 0, :, 1] = xy
    K[:, :, 1, :, 0] = xy.transpose(0, 2, 1)
    return K.reshape(e, 2 * i, 2 * i)


def mass(N: Array, weights: Array, density: Array) -> Array:
    """∫ ρ N_i N_j, shape (e, i, j); the density is (e, 1)."""
    return np.asarray(N.T @ ((density * weights)[:, :, None] * N))


def body_force(N: Array, weights: Array, force: Array) -> Array:
    """∫ f_a N_i of a force (e, q, 2) per unit undeformed volume, shape (e, i, a)."""
    return np.asarray(N.T @ (weights[:, :, None] * force))


def traction_force(N: Array, lengths: Array, traction: Array) -> Array:
    """∫ t_a N_i of a force per unit undeformed length on a batch of sides, shape (k, i, a).

    Parameters
    ----------
    N : ndarray, shape (q, i)
    lengths : ndarray, shape (k, q)
        Arc length times quadrature weight.
    traction : ndarray, shape (k, q, 2)
    """
    return np.asarray(N.T @ (lengths[:, :, None] * traction))


def pressure_force(N: Array, dN: Array, x: Array, pressure: Array) -> Array:
    """-∫ p n_a N_i ds over deformed sides, shape (k, i, a).

    Parameters
    ----------
    N : ndarray, shape (q, i)
    dN : ndarray, shape (q, i)
        Derivatives along the side in counter-clockwise direction, so that the outward normal times arc length is
        (∂y, -∂x).
    x : ndarray, shape (k, i, 2)
        Deformed positions of the nodes.
    pressure : ndarray, shape (k, q)
        Pressure times quadrature weight.
    """
    tangent = dN @ x
    return np.asarray(N.T @ (pressure[:, :, None] * np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)))


def pressure_stiffness(N: Array, dN: Array, pressure: Array) -> Array:
    """Derivative of `pressure_force`, shape (k, 2 i, 2 j), with local unknowns 2 i + a; the same for all x."""
    k, i = len(pressure), N.shape[1]
    along = N.T @ (pressure[:, :, None] * dN)
    K = np.zeros((k, i, 2, i, 2))
    K[:, :, 0, :, 1] = -along
    K[:, :, 1, :, 0] = along
    return K.reshape(k, 2 * i, 2 * i)
