"""The compressible neo-Hookean material in plane strain, at all quadrature points at once.

    W = μ/2 (tr FᵀF - 2 - 2 ln J) + λ/4 (J² - 1 - 2 ln J),        J = det F

is polyconvex, infinite at J = 0, and that of Hooke's law for small strains (Ciarlet, Geymonat, C. R. Acad. Sci. Paris
II 295 (1982) 423–426). Components are outermost: F[a, D] is an array (e, q).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["determinant", "energy", "moduli", "stress"]


def determinant(F: Array) -> Array:
    """Determinants of (2, 2, ...)."""
    return F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]


def _cofactor(F: Array) -> Array:
    return np.stack([[F[1, 1], -F[1, 0]], [-F[0, 1], F[0, 0]]])


def energy(F: Array, lame_lambda: float, lame_mu: float) -> Array:
    """W for Young's modulus 1; infinite where J is not positive."""
    J = determinant(F)
    valid = J > 0.0
    J = np.where(valid, J, 1.0)
    log_J = np.log(J)
    W = 0.5 * lame_mu * ((F * F).sum(axis=(0, 1)) - 2.0 - 2.0 * log_J) + 0.25 * lame_lambda * (
        J * J - 1.0 - 2.0 * log_J
    )
    return np.where(valid, W, np.inf)


def stress(F: Array, lame_lambda: float, lame_mu: float) -> Array:
    """P = ∂W/∂F = μ (F - F⁻ᵀ) + λ/2 (J² - 1) F⁻ᵀ."""
    J = determinant(F)
    G = _cofactor(F) / J
    return lame_mu * (F - G) + 0.5 * lame_lambda * (J * J - 1.0) * G


def moduli(F: Array, lame_lambda: float, lame_mu: float) -> Array:
    """A_aDbC = ∂P_aD/∂F_bC, shape (2, 2, 2, 2, ...)."""
    J = determinant(F)
    G = _cofactor(F) / J
    crossed = lame_mu - 0.5 * lame_lambda * (J * J - 1.0)
    A = crossed * (G[:, None, None, :] * G.swapaxes(0, 1)[None, :, :, None])  # G_aC G_bD
    A += lame_lambda * J * J * (G[:, :, None, None] * G[None, None])
    for a in range(2):
        for D in range(2):
            A[a, D, a, D] += lame_mu
    return A
