"""Curves moved as a whole: translated, rotated, scaled, mirrored."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.arc import Arc
from hoblock.curves.curve import Curve, CuttableCurve, breaks_of
from hoblock.curves.nodal import NodalCurve
from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["Affine", "transformed"]


@dataclass(frozen=True, eq=False)
class Affine:
    """The image x ↦ A x + b of a curve; maps of maps are multiplied out.

    Parameters
    ----------
    curve : Curve
    matrix : ndarray, shape (2, 2)
        A, regular.
    offset : ndarray, shape (2,)
        b.
    """

    curve: Curve
    matrix: Array
    offset: Array

    def __post_init__(self) -> None:
        A, b = np.array(self.matrix, dtype=float), np.array(self.offset, dtype=float)
        if A.shape != (2, 2) or b.shape != (2,) or not (np.isfinite(A).all() and np.isfinite(b).all()):
            raise CurveError(
                f"affine map of a curve: matrix and offset have shapes {A.shape} and {b.shape}; expected (2, 2) and "
                "(2,), all finite."
            )
        if A[0, 0] * A[1, 1] == A[0, 1] * A[1, 0]:
            raise CurveError(f"affine map of a curve: the matrix {A.tolist()} is singular; expected a regular one.")
        curve = self.curve
        if isinstance(curve, Affine):
            A, b, curve = A @ curve.matrix, A @ curve.offset + b, curve.curve
        for array in (A, b):
            array.setflags(write=False)
        for name, value in (("curve", curve), ("matrix", A), ("offset", b)):
            object.__setattr__(self, name, value)

    @property
    def breaks(self) -> Array:
        """Parameters where the curve is not smooth: those of the original."""
        return breaks_of(self.curve)

    def cut(self, first: Array, second: Array) -> Curve | None:
        """Return the image of the original cut between other ends, if it can be cut so."""
        if not isinstance(self.curve, CuttableCurve):
            return None
        inverse = np.linalg.inv(self.matrix)
        cut = self.curve.cut(inverse @ (first - self.offset), inverse @ (second - self.offset))
        return None if cut is None else Affine(cut, self.matrix, self.offset)

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        return np.asarray(self.curve(np.asarray(t, dtype=float)) @ self.matrix.T + self.offset)


def transformed(curve: Curve, matrix: Array, offset: Array) -> Curve:
    """Return the image x ↦ A x + b of a curve: of a nodal curve a nodal curve, of an arc under a similarity an arc.

    Parameters
    ----------
    curve : Curve
    matrix : ndarray, shape (2, 2)
    offset : ndarray, shape (2,)

    Raises
    ------
    CurveError
        If the matrix is singular or something is not finite.
    """
    image = Affine(curve, matrix, offset)
    A, b = image.matrix, image.offset
    if isinstance(image.curve, NodalCurve):
        return NodalCurve(image.curve.points @ A.T + b, image.curve.order)
    scale = float(np.hypot(*A[:, 0]))
    if isinstance(image.curve, Arc) and np.allclose(A.T @ A, scale**2 * np.eye(2), rtol=0.0, atol=1e-14 * scale**2):
        arc, turn = image.curve, float(np.sign(np.linalg.det(A)))
        center = A @ np.array(arc.center) + b
        start = A @ np.array([np.cos(arc.start), np.sin(arc.start)])
        angle = float(np.arctan2(start[1], start[0]))
        return Arc((float(center[0]), float(center[1])), scale * arc.radius, angle, turn * arc.opening)
    return image
