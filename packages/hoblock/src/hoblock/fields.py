"""Fields given by values: on a rectangular grid, or at the nodes of a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import FieldError
from hoblock.locate import Locations, Locator
from hoblock.mesh import QuadMesh
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_gradient

Array = NDArray[np.float64]

__all__ = ["GridField", "MeshField"]

_ROUNDING = 1e-12  # of the grid's size: places this far outside count as on its border
_HIGHEST_DEGREE = 5  # that the spline library offers


@dataclass(frozen=True, eq=False)
class GridField:
    """Spline through values on a rectangular grid.

    The error falls as h^(degree + 1) with the grid spacing h where the field is smooth; the spline has degree - 1
    continuous derivatives.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Ascending; spacing may vary.
    y : ndarray, shape (n,)
        Ascending.
    values : ndarray, shape (m, n)
        ``values[i, j]`` at ``(x[i], y[j])``.
    degree : int
        1 to 5.

    Raises
    ------
    FieldError
        At construction, if the values do not fit the grid, are not finite, or the grid has too few lines for the
        degree; when called, if a point is outside the grid.
    """

    x: Array
    y: Array
    values: Array
    degree: int = 3

    def __post_init__(self) -> None:
        if isinstance(self.degree, bool) or self.degree not in range(1, _HIGHEST_DEGREE + 1):
            raise FieldError(f"grid field: degree is {self.degree!r}; expected 1 to {_HIGHEST_DEGREE}.")
        for name in ("x", "y"):
            object.__setattr__(self, name, _grid_lines(getattr(self, name), name, self.degree))
        values = np.array(self.values, dtype=float)
        expected = (len(self.x), len(self.y))
        if values.shape != expected:
            turned = " Transpose them: the first axis is x." if values.shape == expected[::-1] else ""
            raise FieldError(f"grid field: values have shape {values.shape}; expected {expected}, x first.{turned}")
        if not np.isfinite(values).all():
            i, j = np.argwhere(~np.isfinite(values))[0]
            raise FieldError(
                f"grid field: the value at ({self.x[i]:g}, {self.y[j]:g}) is {values[i, j]}; expected finite numbers. "
                "Fill the gap, or leave the grid lines out."
            )
        values.setflags(write=False)
        object.__setattr__(self, "values", values)

    def __call__(self, points: Array) -> Array:
        """Values at points (n, 2), shape (n,)."""
        x, y = self._inside(points)
        return np.asarray(self._spline.ev(x, y))

    def gradient(self, points: Array) -> Array:
        """Gradients at points (n, 2), shape (n, 2)."""
        x, y = self._inside(points)
        if self.degree == 1:  # FITPACK has no derivatives of such splines
            return self._bilinear_gradient(x, y)
        return np.stack([self._spline.ev(x, y, dx=1), self._spline.ev(x, y, dy=1)], axis=-1)

    def _bilinear_gradient(self, x: Array, y: Array) -> Array:
        """Difference quotients between the grid lines on both sides."""
        (x0, x1), (y0, y1) = _neighbours(self.x, x), _neighbours(self.y, y)
        along_x = (self._spline.ev(x1, y) - self._spline.ev(x0, y)) / (x1 - x0)
        along_y = (self._spline.ev(x, y1) - self._spline.ev(x, y0)) / (y1 - y0)
        return np.stack([along_x, along_y], axis=-1)

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import RectBivariateSpline

        return RectBivariateSpline(self.x, self.y, self.values, kx=self.degree, ky=self.degree, s=0)

    def _inside(self, points: Array) -> tuple[Array, Array]:
        points = np.asarray(points, dtype=float)
        low, high = np.array([self.x[0], self.y[0]]), np.array([self.x[-1], self.y[-1]])
        outside = ~(np.abs(points - 0.5 * (low + high)) <= (0.5 + _ROUNDING) * (high - low)).all(axis=1)
        if outside.any():
            x, y = points[outside][0]
            raise FieldError(
                f"({x:.6g}, {y:.6g}) is outside the grid of values; expected places in [{low[0]:g}, {high[0]:g}] × "
                f"[{low[1]:g}, {high[1]:g}]. Give values on a larger grid."
            )
        return tuple(np.clip(points, low, high).T)


@dataclass(frozen=True, eq=False)
class MeshField:
    """Values at the nodes of a mesh, between them the polynomials of the (curved) elements.

    The field is continuous, its gradient is not: between elements an isoline may have kinks as small as the error of
    the interpolation.

    Parameters
    ----------
    mesh : QuadMesh
    values : ndarray, shape (n,)
        At ``mesh.points``.

    Raises
    ------
    FieldError
        At construction, if the values do not fit the mesh or are not finite; when called, if a point is outside the
        mesh by more than 1 % of an element.
    """

    mesh: QuadMesh
    values: Array

    def __post_init__(self) -> None:
        values = np.array(self.values, dtype=float)
        if values.shape != (len(self.mesh.points),):
            raise FieldError(
                f"mesh field: values have shape {values.shape}; expected ({len(self.mesh.points)},), one for each node."
            )
        if not np.isfinite(values).all():
            bad = int(np.argmin(np.isfinite(values)))
            raise FieldError(f"mesh field: the value of node {bad} is {values[bad]}; expected finite numbers.")
        values.setflags(write=False)
        object.__setattr__(self, "values", values)

    def __call__(self, points: Array) -> Array:
        """Values at points (n, 2), shape (n,)."""
        at = self._located(points)
        basis = tensor_basis(gauss_lobatto(self.mesh.order), at.xi) if len(at) else np.zeros((0, 1))
        return np.asarray((basis * self.values[self.mesh.cells[at.elements]]).sum(axis=1))

    def gradient(self, points: Array) -> Array:
        """Gradients at points (n, 2), shape (n, 2); on a face, those of the element with the lowest number."""
        at = self._located(points)
        if not len(at):
            return np.zeros((0, 2))
        dN = tensor_gradient(gauss_lobatto(self.mesh.order), at.xi)
        nodes = self.mesh.cells[at.elements]
        J = np.swapaxes(self.mesh.points[nodes], 1, 2) @ dN
        along = np.swapaxes(dN, 1, 2) @ self.values[nodes][:, :, None]
        return np.asarray(np.linalg.solve(np.swapaxes(J, 1, 2), along)[:, :, 0])

    @cached_property
    def _locator(self) -> Locator:
        return Locator(self.mesh)

    def _located(self, points: Array) -> Locations:
        points = np.asarray(points, dtype=float)
        at = self._locator.find(points)
        if not at.found.all():
            x, y = points[~at.found][0]
            low, high = self.mesh.points.min(axis=0), self.mesh.points.max(axis=0)
            raise FieldError(
                f"({x:.6g}, {y:.6g}) is outside the mesh with the values, whose nodes lie in [{low[0]:g}, {high[0]:g}] "
                f"× [{low[1]:g}, {high[1]:g}]. Give values on a larger mesh."
            )
        return at


def _neighbours(lines: Array, x: Array) -> tuple[Array, Array]:
    """Grid lines on both sides of some places."""
    k = np.clip(np.searchsorted(lines, x, side="right") - 1, 0, len(lines) - 2)
    return lines[k], lines[k + 1]


def _grid_lines(lines: Array, name: str, degree: int) -> Array:
    lines = np.array(lines, dtype=float)
    if lines.ndim != 1 or len(lines) < degree + 1:
        raise FieldError(
            f"grid field: {name} has shape {lines.shape}; expected at least {degree + 1} grid lines for degree "
            f"{degree}. Refine the grid, or lower the degree."
        )
    if not (np.isfinite(lines).all() and (np.diff(lines) > 0.0).all()):
        bad = int(np.argmin(np.diff(lines) > 0.0))
        raise FieldError(
            f"grid field: {name}[{bad}] = {lines[bad]:g} is followed by {lines[bad + 1]:g}; expected finite, ascending "
            "grid lines. Sort them, and the values with them."
        )
    lines.setflags(write=False)
    return lines
