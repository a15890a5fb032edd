"""Energies of block corners with their gradients and Hessians: functions of arrays, all corners at once.

A corner is z = (e_x, e_y, f_x, f_y), the vectors e and f along its two edges, stored as an array (4, C). D = e × f,
relative to the reference d = D/D₀. Where d is replaced by h(d) = (d + √(d² + ε²))/2 the energy is finite for turned
corners too (Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov: Foldover-free maps in 50 lines of code, ACM Trans.
Graph. 40 (2021) 102, doi:10.1145/3450626.3459847); h = d for ε = 0 and d > 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["AngleEnergy", "CornerEnergy", "DistortionEnergy", "Derivatives", "positive_part"]

_CROSS = np.zeros((4, 4))
_CROSS[0, 3] = _CROSS[3, 0] = 1.0
_CROSS[1, 2] = _CROSS[2, 1] = -1.0
"""Second derivatives of e × f."""


@dataclass(frozen=True, eq=False)
class Derivatives:
    """Energies of corners and their derivatives by z.

    Attributes
    ----------
    value : ndarray, shape (C,)
    gradient : ndarray, shape (4, C)
    hessian : ndarray, shape (4, 4, C)
    """

    value: Array
    gradient: Array
    hessian: Array


class CornerEnergy(Protocol):
    """An energy that grows without bound as a corner closes to 0° or opens to 180°."""

    def values(self, z: Array, epsilon: float) -> tuple[Array, Array]:
        """Energies (C,) of corners and their d = D/D₀ (C,)."""
        ...

    def derivatives(self, z: Array, epsilon: float) -> Derivatives:
        """Energies of corners with their derivatives."""
        ...


def positive_part(d: Array, epsilon: float) -> tuple[Array, Array, Array]:
    """h(d) and its first two derivatives."""
    if epsilon == 0.0:
        return d, np.ones_like(d), np.zeros_like(d)
    root = np.sqrt(d * d + epsilon * epsilon)
    h = np.where(d > 0.0, 0.5 * (d + root), 0.5 * epsilon * epsilon / (root + np.abs(d)))
    return h, 0.5 * (1.0 + d / root), 0.5 * epsilon * epsilon / root**3


@dataclass(frozen=True, eq=False)
class _Reference:
    """Corners of the reference."""

    cross: Array
    first: Array
    second: Array
    both: Array

    @staticmethod
    def of(z: Array) -> _Reference:
        e, f = z[:2], z[2:]
        return _Reference(e[0] * f[1] - e[1] * f[0], (e * e).sum(axis=0), (f * f).sum(axis=0), (e * f).sum(axis=0))

    def relative_cross(self, z: Array) -> Array:
        """Return d = (e × f)/D₀."""
        return np.asarray((z[0] * z[3] - z[1] * z[2]) / self.cross)

    def cross_gradient(self, z: Array) -> Array:
        """∂d/∂z."""
        return np.stack([z[3], -z[2], -z[1], z[0]]) / self.cross


class DistortionEnergy:
    """How much a corner is distorted.

    With J = [e f][e₀ f₀]⁻¹ and |J| its Frobenius norm,

        E = |J|²/(2 det J) - 1 + (λ/2)(det J + 1/det J - 2),

    0 for a corner that is as in the reference but for a rotation, polyconvex, unbounded as det J → 0; and E + κ E²,
    which weighs the worst corners more.

    Parameters
    ----------
    reference : ndarray, shape (4, C)
        The corners z of the reference; their cross products are positive.
    size_weight : float
        λ.
    emphasis : float
        κ.
    """

    def __init__(self, reference: Array, size_weight: float, emphasis: float) -> None:
        self._reference = ref = _Reference.of(reference)
        self._size_weight, self._emphasis = size_weight, emphasis
        metric = ref.first * ref.second - ref.both**2
        self._g = ref.second / metric, -ref.both / metric, ref.first / metric
        self._Q = np.zeros((4, 4, reference.shape[1]))
        for i in range(2):
            self._Q[i, i], self._Q[i + 2, i + 2] = self._g[0], self._g[2]
            self._Q[i, i + 2] = self._Q[i + 2, i] = self._g[1]
        self._cross = _CROSS[:, :, None] / ref.cross

    def _parts(self, z: Array) -> tuple[Array, Array, Array]:
        """Half the gradient of |J|², |J|² and d = det J."""
        g11, g12, g22 = self._g
        half = np.empty_like(z)
        half[:2], half[2:] = g11 * z[:2] + g12 * z[2:], g12 * z[:2] + g22 * z[2:]
        return half, (z * half).sum(axis=0), self._reference.relative_cross(z)

    def values(self, z: Array, epsilon: float) -> tuple[Array, Array]:
        """See `CornerEnergy`."""
        _, q, d = self._parts(z)
        h = positive_part(d, epsilon)[0]
        E = 0.5 * q / h - 1.0 + 0.5 * self._size_weight * (h + 1.0 / h - 2.0)
        return E + self._emphasis * E * E, d

    def derivatives(self, z: Array, epsilon: float) -> Derivatives:
        """See `CornerEnergy`."""
        half, q, d = self._parts(z)
        h, h1, h2 = positive_part(d, epsilon)
        size, inverse = self._size_weight, 1.0 / h
        E = 0.5 * q * inverse - 1.0 + 0.5 * size * (h + inverse - 2.0)
        by_h = 0.5 * (size - (q + size) * inverse**2)
        by_d = by_h * h1
        mixed = -0.5 * h1 * inverse**2
        by_dd = (q + size) * inverse**3 * h1 * h1 + by_h * h2
        k = self._reference.cross_gradient(z)
        gradient = inverse * half + by_d * k
        both = (2.0 * mixed * half + 0.5 * by_dd * k)[:, None] * k
        hessian = both + both.transpose(1, 0, 2) + inverse * self._Q + by_d * self._cross
        if self._emphasis:
            slope = 1.0 + 2.0 * self._emphasis * E
            hessian *= slope
            hessian += (2.0 * self._emphasis * gradient)[:, None] * gradient
            gradient = slope * gradient
            E = E + self._emphasis * E * E
        return Derivatives(E, gradient, hessian)


class AngleEnergy:
    """How far the angle α of a corner is from a right one: E = sin²α₀ |e|²|f|²/D² = sin²α₀/sin²α.

    Parameters
    ----------
    reference : ndarray, shape (4, C)
        The corners z of the reference; their cross products are positive.
    """

    def __init__(self, reference: Array) -> None:
        self._reference = ref = _Reference.of(reference)
        self._scale = 1.0 / (ref.first * ref.second)
        self._cross = _CROSS[:, :, None] / ref.cross

    def values(self, z: Array, epsilon: float) -> tuple[Array, Array]:
        """See `CornerEnergy`."""
        d = self._reference.relative_cross(z)
        h = positive_part(d, epsilon)[0]
        squares = z * z
        return self._scale * (squares[0] + squares[1]) * (squares[2] + squares[3]) / h**2, d

    def derivatives(self, z: Array, epsilon: float) -> Derivatives:
        """See `CornerEnergy`."""
        e, f, c = z[:2], z[2:], self._scale
        h, h1, h2 = positive_part(self._reference.relative_cross(z), epsilon)
        a, b = c * (e * e).sum(axis=0), (f * f).sum(axis=0)
        m = a * b
        by_m = 1.0 / h**2
        by_d, mixed = -2.0 * m * h1 * by_m / h, -2.0 * h1 * by_m / h
        by_dd = m * (6.0 * h1 * h1 / h - 2.0 * h2) * by_m / h
        k = self._reference.cross_gradient(z)
        by_z = np.concatenate([2.0 * c * b * e, 2.0 * a * f])
        gradient = by_m * by_z + by_d * k
        both = (mixed * by_z + 0.5 * by_dd * k)[:, None] * k
        hessian = both + both.transpose(1, 0, 2) + by_d * self._cross
        cross = (4.0 * c * by_m) * e[:, None] * f[None]
        hessian[:2, 2:] += cross
        hessian[2:, :2] += cross.transpose(1, 0, 2)
        for i in range(2):
            hessian[i, i] += 2.0 * c * b * by_m
            hessian[i + 2, i + 2] += 2.0 * a * by_m
        return Derivatives(m * by_m, gradient, hessian)
