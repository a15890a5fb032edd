"""Stress and stiffness of compressible neo-Hookean solids in plane strain and plane stress.

Functions of arrays only, laid out as in `elasticity`. Per unit undeformed volume

    W = μ/2 (tr C - 3) - μ ln J + λ/2 (ln J)²,   S = 2 ∂W/∂C = μ (I - C⁻¹) + p C⁻¹,   p = λ ln J,

with the Lamé parameters of the three-dimensional body, (e, 1), in both plane cases. In plane strain C_zz = 1. In plane
stress S_zz = 0 determines the thickness ratio eʸ, C_zz = e²ʸ, at every point: μ (e²ʸ - 1) + λ (ln J₂ + y) = 0 with
J₂ = det F in the plane.

Everything is computed from the displacement gradient and C - I, whose small values keep their digits, not from numbers
near 1. Where J is not positive the stress is not finite.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi.kernels.elasticity import PAIRS, geometric_terms, pulled_back, stiffness_of_terms

Array = NDArray[np.float64]
Symmetric = tuple[Array, Array, Array]  # xx, yy, xy

__all__ = [
    "energy_density",
    "linearised_stress",
    "log_thickness",
    "mean_stress",
    "out_of_plane",
    "stiffness",
    "stress",
]

_ITERATIONS = 100
_CONVERGED = 1e-8  # relative; the next error is its square
_SMALL = 0.1  # below it series instead of differences


def _det(xx: Array, yy: Array, xy: Array) -> Array:
    return xx * yy - xy * xy


def _metric_change(H: Array) -> Symmetric:
    """C - I = H + Hᵀ + HᵀH."""
    xx, xy, yx, yy = H[..., 0, 0], H[..., 0, 1], H[..., 1, 0], H[..., 1, 1]
    return 2.0 * xx + xx * xx + yx * yx, 2.0 * yy + xy * xy + yy * yy, xy + yx + xx * xy + yx * yy


def _area_change(H: Array) -> Array:
    """J₂ - 1."""
    return np.asarray(H[..., 0, 0] + H[..., 1, 1] + H[..., 0, 0] * H[..., 1, 1] - H[..., 0, 1] * H[..., 1, 0])


def _log1p(x: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.log1p(x)


def log_thickness(log_area: Array, lame_lambda: Array, lame_mu: Array) -> Array:
    """Logarithm y of the thickness ratio in plane stress: μ (e²ʸ - 1) + λ (ln J₂ + y) = 0.

    The left side is convex in y with a positive slope at 0, so that Newton's method from there overshoots once at most
    and then comes down to the root. With λ < 0 there is none under strong compression; y is then NaN.

    Parameters
    ----------
    log_area : ndarray, shape (e, q)
        ln J₂.
    lame_lambda, lame_mu : ndarray
        Of shapes that fit.
    """
    y = np.zeros_like(log_area)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for _ in range(_ITERATIONS):
            grown = np.expm1(2.0 * y)
            slope = 2.0 * lame_mu * (1.0 + grown) + lame_lambda
            change = (lame_mu * grown + lame_lambda * (log_area + y)) / slope
            y = y - change
            open_ = np.abs(change) > _CONVERGED * np.abs(y)
            if not open_.any():
                break
    return np.where(open_ | ~np.isfinite(y), np.nan, y)


def _pressure(log_area: Array, lame_lambda: Array, lame_mu: Array, plane_stress: bool) -> tuple[Array, Array]:
    """p = λ ln J, and C_zz - 1."""
    if not plane_stress:
        return lame_lambda * log_area, np.zeros_like(log_area)
    grown = np.expm1(2.0 * log_thickness(log_area, lame_lambda, lame_mu))
    return -lame_mu * grown, grown


def _inverse(G: Symmetric, det_C: Array) -> Symmetric:
    """C⁻¹ of G = C - I."""
    return (1.0 + G[1]) / det_C, (1.0 + G[0]) / det_C, -G[2] / det_C


def _second_stress(G: Symmetric, det_C: Array, p: Array, lame_mu: Array) -> Array:
    """S, from I - C⁻¹ = (G + det(G) I)/det C."""
    xx, yy, xy = G
    det_G = _det(xx, yy, xy)
    S = np.empty((3, *xx.shape))
    with np.errstate(divide="ignore", invalid="ignore"):
        S[0] = (lame_mu * (xx + det_G) + p * (1.0 + yy)) / det_C
        S[1] = (lame_mu * (yy + det_G) + p * (1.0 + xx)) / det_C
        S[2] = (lame_mu - p) * xy / det_C
    return np.moveaxis(S, 0, 2)


def stress(H: Array, lame_lambda: Array, lame_mu: Array, *, plane_stress: bool) -> Array:
    """Second Piola–Kirchhoff stress S of a displacement gradient, shape (e, q, 3); the parameters are (e, 1)."""
    change = _area_change(H)
    p, _ = _pressure(_log1p(change), lame_lambda, lame_mu, plane_stress)
    return _second_stress(_metric_change(H), (1.0 + change) ** 2, p, lame_mu)


def energy_density(H: Array, lame_lambda: Array, lame_mu: Array, *, plane_stress: bool) -> Array:
    """W of a displacement gradient, shape (e, q)."""
    log_volume, (xx, yy, _) = _log1p(_area_change(H)), _metric_change(H)
    grown = np.zeros_like(log_volume)
    if plane_stress:
        y = log_thickness(log_volume, lame_lambda, lame_mu)
        log_volume, grown = log_volume + y, np.expm1(2.0 * y)
    return np.asarray(lame_mu * (0.5 * (xx + yy + grown) - log_volume) + 0.5 * lame_lambda * log_volume**2)


def out_of_plane(H: Array, lame_lambda: Array, lame_mu: Array, *, plane_stress: bool) -> tuple[Array, Array]:
    """S_zz C_zz, which is J times the Cauchy stress σ_zz, and the thickness ratio, each of shape (e, q)."""
    log_area = _log1p(_area_change(H))
    if not plane_stress:
        return lame_lambda * log_area, np.ones_like(log_area)
    return np.zeros_like(log_area), np.exp(log_thickness(log_area, lame_lambda, lame_mu))


def _moduli(H: Array, S: Array, lame_lambda: Array, lame_mu: Array, plane_stress: bool) -> tuple[Array, Array]:
    """λ' = dp/d ln J₂ of H, and η = μ - p with the pressure in S, p = (S:C - μ (tr C - 2))/2.

    If S is the stress of H its pressure is that of H. Far from equilibrium p is better taken from a stress that follows
    the solution than from H: where λ is large, the area that a finite rotation gains on the way makes a huge pressure.
    """
    xx, yy, xy = _metric_change(H)
    work = S[..., 0] * (1.0 + xx) + S[..., 1] * (1.0 + yy) + 2.0 * S[..., 2] * xy
    eta = lame_mu - 0.5 * (work - lame_mu * (xx + yy))
    if not plane_stress:
        return lame_lambda + np.zeros_like(eta), eta
    _, grown = _pressure(_log1p(_area_change(H)), lame_lambda, lame_mu, plane_stress)
    across = 2.0 * lame_mu * (1.0 + grown)
    return lame_lambda * across / (across + lame_lambda), eta


def linearised_stress(
    H: Array, S: Array, increment: Array, used: Array, lame_lambda: Array, lame_mu: Array, *, plane_stress: bool
) -> Array:
    """S plus what an increment ΔH of the displacement gradient adds to it in first order, shape (e, q, 3).

    With ε = sym(Fᵀ ΔH): dS = λ' (C⁻¹:ε) C⁻¹ + 2 η C⁻¹ ε C⁻¹, λ' = dp/d ln J₂ and η those of the stiffness that gave the
    increment, made with the stress ``used``, shape (e, q, 3).
    """
    of_area, eta = _moduli(H, used, lame_lambda, lame_mu, plane_stress)
    A, B, X = _inverse(_metric_change(H), (1.0 + _area_change(H)) ** 2)
    exx, eyy, exy = (0.5 * part for part in _strain_change(H, increment))
    trace = of_area * (A * exx + B * eyy + 2.0 * X * exy)
    result = np.empty((3, *eta.shape))
    result[0] = trace * A + 2.0 * eta * (A * A * exx + 2.0 * A * X * exy + X * X * eyy)
    result[1] = trace * B + 2.0 * eta * (X * X * exx + 2.0 * X * B * exy + B * B * eyy)
    result[2] = trace * X + 2.0 * eta * (A * X * exx + (A * B + X * X) * exy + X * B * eyy)
    return S + np.moveaxis(result, 0, 2)


def _strain_change(H: Array, D: Array) -> Symmetric:
    """FᵀD + DᵀF."""
    xx, xy, yx, yy = 1.0 + H[..., 0, 0], H[..., 0, 1], H[..., 1, 0], 1.0 + H[..., 1, 1]
    return (
        2.0 * (xx * D[..., 0, 0] + yx * D[..., 1, 0]),
        2.0 * (xy * D[..., 0, 1] + yy * D[..., 1, 1]),
        xx * D[..., 0, 1] + yx * D[..., 1, 1] + xy * D[..., 0, 0] + yy * D[..., 1, 0],
    )


def mean_stress(H: Array, start: Array, lame_lambda: Array, lame_mu: Array, *, plane_stress: bool) -> Array:
    """Stress of a step whose work on the strains is exactly the change of W, shape (e, q, 3).

    With C̄ the mean of C at start and end and ΔC their difference,

        S = S(C̄) + (2 ΔW - S(C̄):ΔC)/(ΔC:ΔC) ΔC.

    The numerator is of third order in ΔC. It is written in terms that are small themselves, so that nothing is lost
    where ΔC is small. With x = (det C₁ - det C₀)/(det C₁ + det C₀), τ = det ΔC/(4 det C̄) and the changes ℓ of ln J₂
    from C̄ to the ends, ℓ₁ - ℓ₀ = artanh x, it is

        2 (μ - p̄) (x τ + x - artanh x) + 2 (v(ℓ₁) - v(ℓ₀)),

    where v is the part of W in ln J less its linearisation about C̄.

    Parameters
    ----------
    H : ndarray, shape (e, q, 2, 2)
        Displacement gradient in the middle of the step.
    start : ndarray, shape (e, q, 2, 2)
        At its start.
    lame_lambda, lame_mu : ndarray, shape (e, 1)
    plane_stress : bool

    References
    ----------
    Gonzalez, Exact energy and momentum conserving algorithms for general models in nonlinear elasticity, Comput.
    Methods Appl. Mech. Eng. 190 (2000) 1763–1783, doi:10.1016/S0045-7825(00)00189-4.
    """
    D = H - start
    middle = _metric_change(H)
    xx, xy, yx, yy = D[..., 0, 0], D[..., 0, 1], D[..., 1, 0], D[..., 1, 1]
    G = middle[0] + xx * xx + yx * yx, middle[1] + xy * xy + yy * yy, middle[2] + xx * xy + yx * yy
    change = tuple(2.0 * part for part in _strain_change(H, D))
    rise = G[0] + G[1] + _det(*G)
    det_C = 1.0 + rise
    p, grown = _pressure(0.5 * _log1p(rise), lame_lambda, lame_mu, plane_stress)
    S = _second_stress(G, det_C, p, lame_mu)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        A, B, X = _inverse(G, det_C)
        tau = 0.25 * _det(*change) / det_C
        x = 0.5 * (A * change[0] + B * change[1] + 2.0 * X * change[2]) / (1.0 + tau)
        excess = _artanh_excess(x)
        common = 0.5 * (_log1p(tau) + 0.5 * _log1p(-x * x))
        ends = (common + 0.5 * (x + excess), common - 0.5 * (x + excess))
        last, first = (_volumetric_excess(end, lame_lambda, lame_mu * (1.0 + grown), plane_stress) for end in ends)
        missing = 2.0 * (lame_mu - p) * (x * tau - excess) + 2.0 * (last - first)
        square = change[0] ** 2 + change[1] ** 2 + 2.0 * change[2] ** 2
        factor = missing / np.maximum(square, np.finfo(float).tiny)
        inverted = _area_change(H + D) <= -1.0  # C at the end does not tell
    factor = np.where(inverted, np.nan, factor)
    return np.asarray(S + factor[..., None] * np.stack(change, axis=-1))


def _volumetric_excess(log_area: Array, lame_lambda: Array, lame_mu: Array, plane_stress: bool) -> Array:
    """Part of W in ln J less its linearisation, at a distance in ln J₂; in plane stress μ is multiplied by C_zz."""
    if not plane_stress:
        return 0.5 * lame_lambda * log_area**2
    y = log_thickness(log_area, lame_lambda, lame_mu)
    return lame_mu * _exponential_excess(y) + 0.5 * lame_lambda * (log_area + y) ** 2


def _artanh_excess(x: Array) -> Array:
    """artanh x - x."""
    square = np.where(np.abs(x) < _SMALL, x * x, 0.0)
    series = np.zeros_like(x)
    for n in range(19, 1, -2):
        series = series * square + 1.0 / n
    return np.where(np.abs(x) < _SMALL, x * square * series, np.arctanh(x) - x)


def _exponential_excess(y: Array) -> Array:
    """(e²ʸ - 1)/2 - y."""
    small = np.where(np.abs(y) < _SMALL, 2.0 * y, 0.0)
    series = np.zeros_like(y)
    for n in range(14, 2, -1):
        series = (series + 1.0) * small / n
    return np.where(np.abs(y) < _SMALL, 0.25 * small**2 * (1.0 + series), 0.5 * np.expm1(2.0 * y) - y)


def stiffness(
    H: Array,
    S: Array,
    lame_lambda: Array,
    lame_mu: Array,
    products: tuple[Array, Array],
    J_inv: Array,
    weights: Array,
    *,
    plane_stress: bool,
) -> Array:
    """Derivative of `elasticity.internal_force`, shape (e, 2 i, 2 j), with local unknowns 2 i + a.

    With f = F⁻ᵀ: A_{aDbC} = δ_ab S_DC + λ' f_aD f_bC + η (δ_ab C⁻¹_DC + f_aC f_bD), λ' = dp/d ln J₂, η = μ - p, where p
    is the pressure in S. It is the derivative if S is the stress of H.

    Parameters
    ----------
    H : ndarray, shape (e, q, 2, 2)
    S : ndarray, shape (e, q, 3)
    lame_lambda, lame_mu : ndarray, shape (e, 1)
    products : pair of ndarray
        From `elasticity.gradient_products`.
    J_inv : ndarray, shape (e, q, 2, 2)
    weights : ndarray, shape (e, q)
    plane_stress : bool
    """
    of_area, eta = _moduli(H, S, lame_lambda, lame_mu, plane_stress)
    area = 1.0 + _area_change(H)
    f = np.empty((2, 2, *eta.shape))
    f[0, 0], f[0, 1] = (1.0 + H[..., 1, 1]) / area, -H[..., 1, 0] / area
    f[1, 0], f[1, 1] = -H[..., 0, 1] / area, (1.0 + H[..., 0, 0]) / area
    push = pulled_back(np.moveaxis(f, (0, 1), (2, 3)), J_inv)
    wm = eta * weights
    parts = [
        wm * (push[0][c] * push[0][k] + push[1][c] * push[1][k]) + part
        for (c, k), part in zip(PAIRS, geometric_terms(S, J_inv, weights), strict=True)
    ]
    return stiffness_of_terms(
        push, of_area * weights, wm, lambda a, n: parts[n], lambda c, k: wm * push[0][k] * push[1][c], products
    )
