"""The shape of a bending cantilever."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["Cantilever", "mode_slope"]

BETA, SIGMA = 1.875104, 0.7340955
GAUSS = np.polynomial.legendre.leggauss(32)


def mode_slope(xi: Array) -> Array:
    """Derivative of the first clamped–free mode φ₁ of a beam of length 1, φ₁(1) = 2."""
    b = BETA * np.asarray(xi, dtype=float)
    return np.asarray(BETA * (np.sinh(b) + np.sin(b) - SIGMA * (np.cosh(b) - np.cos(b))))


@dataclass(frozen=True)
class Cantilever:
    """A horizontal cantilever whose middle line keeps its length and whose normals stay normal.

    Its slope at the fraction ξ of its length is the angle A φ₁'(ξ), A being the amplitude.

    Attributes
    ----------
    root : (float, float)
        The clamped end of the middle line.
    length : float
        To the right of the root.
    """

    root: tuple[float, float]
    length: float

    def bent(self, points: Array, amplitude: float) -> Array:
        """Positions of points, shape (..., 2), from those in the straight cantilever."""
        offset = np.asarray(points, dtype=float) - self.root
        xi, e = offset[..., 0] / self.length, offset[..., 1]
        places, weights = GAUSS
        angles = amplitude * mode_slope(0.5 * xi[..., None] * (places + 1.0))
        along, up = (0.5 * self.length * xi * (part(angles) @ weights) for part in (np.cos, np.sin))
        angle = amplitude * mode_slope(xi)
        return np.stack(
            [self.root[0] + along - e * np.sin(angle), self.root[1] + up + e * np.cos(angle)],
            axis=-1,
        )

    def deflection(self, amplitude: float) -> float:
        """Height of the end of the middle line over the root."""
        tip = np.array([[self.root[0] + self.length, self.root[1]]])
        return float(self.bent(tip, amplitude)[0, 1] - self.root[1])
