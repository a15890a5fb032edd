"""Interpolation of the displacement by radial basis functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve
from scipy.spatial.distance import cdist

from full_mesh_movers.errors import MotionFailed
from full_mesh_movers.node_roles import NodeRoles
from hoblock import QuadMesh

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Kernel = Literal["cubic", "thin_plate_spline", "wendland_c2"]

__all__ = ["Kernel", "RadialBasis", "RadialInterpolant", "thinned"]

_ROWS = 2048
"""Points that are evaluated at a time."""


def _thin_plate_spline(r2: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(r2 > 0.0, 0.5 * r2 * np.log(r2), 0.0)


def _wendland_c2(r2: Array) -> Array:
    r = np.minimum(np.sqrt(r2), 1.0)
    return (1.0 - r) ** 4 * (4.0 * r + 1.0)


_KERNELS: dict[str, Callable[[Array], Array]] = {
    "cubic": lambda r2: r2 * np.sqrt(r2),
    "thin_plate_spline": _thin_plate_spline,
    "wendland_c2": _wendland_c2,
}
_LOWEST_DEGREE = {"cubic": 1, "thin_plate_spline": 1, "wendland_c2": -1}


class RadialInterpolant:
    """Interpolation in given centres, factorised once for any data.

    Parameters
    ----------
    centres : ndarray, shape (m, 2)
    kernel : {"thin_plate_spline", "cubic", "wendland_c2"}
        r² log r, r³ or (1 - r)⁴ (4r + 1) with compact support r < 1, r being the distance by ``radius``.
    degree : int
        Of the polynomial: -1 for none, 0 or 1. The first two kernels need 1.
    radius : float, optional
        Of the support; the diameter of the centres by default. Without meaning for the first two kernels.

    Attributes
    ----------
    scale : float
        The unit of length, ``radius`` if it is given.

    Raises
    ------
    ValueError
        If the kernel is unknown, the degree too low, or the system is singular (centres on a line, or twice the same).
    """

    def __init__(self, centres: Array, kernel: Kernel, degree: int, radius: float | None = None) -> None:
        if kernel not in _KERNELS:
            raise ValueError(f"kernel is {kernel!r}; expected one of {', '.join(map(repr, _KERNELS))}.")
        if degree not in range(_LOWEST_DEGREE[kernel], 2):
            raise ValueError(f"degree is {degree}; expected from {_LOWEST_DEGREE[kernel]} to 1 for kernel {kernel!r}.")
        if radius is not None and not radius > 0.0:
            raise ValueError(f"radius is {radius:g}; expected a positive one.")
        self._kernel, self._degree = _KERNELS[kernel], degree
        self._middle = centres.mean(axis=0)
        self.scale = radius or float(np.hypot(*np.ptp(centres, axis=0)))
        self._centres = (centres - self._middle) / self.scale
        m, terms = len(centres), self._terms
        A = np.zeros((m + terms, m + terms))
        A[:m, :m] = self._kernel(cdist(self._centres, self._centres, "sqeuclidean"))
        A[:m, m:] = self._polynomials(self._centres)
        A[m:, :m] = A[:m, m:].T
        if np.linalg.matrix_rank(A[:m, m:]) < terms or len(np.unique(centres, axis=0)) < m:
            raise ValueError("the interpolation is singular: all centres on a line, or two in one place.")
        self._factors = lu_factor(A, overwrite_a=True)

    @property
    def _terms(self) -> int:
        return (self._degree + 1) * (self._degree + 2) // 2

    def _polynomials(self, x: Array) -> Array:
        return np.column_stack([np.ones(len(x)), x])[:, : self._terms]

    def coefficients(self, data: Array) -> Array:
        """Coefficients of data (m, r) in the centres, shape (m + terms, r)."""
        return np.asarray(lu_solve(self._factors, np.concatenate([data, np.zeros((self._terms, data.shape[1]))])))

    def evaluated(self, coefficients: Array, points: Array) -> Array:
        """Values (k, r) at points (k, 2)."""
        result = np.empty((len(points), coefficients.shape[1]))
        for first in range(0, len(points), _ROWS):
            some = slice(first, first + _ROWS)
            x = (points[some] - self._middle) / self.scale
            kernel = self._kernel(cdist(x, self._centres, "sqeuclidean"))
            m = len(self._centres)
            result[some] = kernel @ coefficients[:m] + self._polynomials(x) @ coefficients[m:]
        return result


def thinned(nodes: Index, points: Array, fraction: float) -> Index:
    """Keep a share of some nodes, each as far as possible from those chosen before; ascending.

    Parameters
    ----------
    nodes : ndarray, shape (k,)
    points : ndarray, shape (n, 2)
        Positions of all nodes.
    fraction : float
        In (0, 1].
    """
    if not 0.0 < fraction <= 1.0:
        raise ValueError(f"fraction is {fraction:g}; expected one in (0, 1].")
    if fraction == 1.0 or not nodes.size:
        return nodes
    x = points[nodes]
    chosen = [0]
    distance = np.full(len(nodes), np.inf)
    for _ in range(max(1, round(fraction * len(nodes))) - 1):
        distance = np.minimum(distance, ((x - x[chosen[-1]]) ** 2).sum(axis=1))
        chosen.append(int(np.argmax(distance)))
    return np.sort(nodes[chosen])


@dataclass(frozen=True, eq=False)
class RadialBasis:
    """The displacement is interpolated between moving and fixed nodes of the boundary.

    Parameters
    ----------
    mesh : QuadMesh
        The reference.
    moving, fixed : ndarray of int
        Ascending nodes on the moving body and on the rest of the boundary.
    kernel, degree, radius
        See `RadialInterpolant`.
    fraction : float
        Share of the moving and of the fixed nodes that are centres, chosen evenly in space. All moving nodes get their
        positions in any case; with fewer centres the free nodes beside them know them approximately only.
    incremental : bool
        Interpolate the increment from the last accepted state between the nodes' positions there, factorised in each
        move. Otherwise everything is factorised once, on the reference.
    cached : bool
        Whether a one-step method keeps the matrix that takes the displacement of the moving nodes to that of the free
        ones, shape (free, moving). Without, the kernel is evaluated in each move, which takes less memory and longer.

    References
    ----------
    de Boer, van der Schoot, Bijl, Comput. Struct. 85 (2007) 784–795, doi:10.1016/j.compstruc.2007.01.013.
    """

    mesh: QuadMesh
    moving: Index
    fixed: Index
    kernel: Kernel = field(default="thin_plate_spline", kw_only=True)
    degree: int = field(default=1, kw_only=True)
    radius: float | None = field(default=None, kw_only=True)
    fraction: float = field(default=1.0, kw_only=True)
    incremental: bool = field(default=False, kw_only=True)
    cached: bool = field(default=True, kw_only=True)
    _roles: NodeRoles = field(init=False, repr=False)
    _driving: Index = field(init=False, repr=False)
    _centres: Index = field(init=False, repr=False)
    _interpolant: RadialInterpolant = field(init=False, repr=False)
    _response: Array | None = field(init=False, repr=False, default=None)

    def __post_init__(self) -> None:
        roles, points = NodeRoles.of(self.mesh, self.moving, self.fixed), self.mesh.points
        driving = thinned(roles.moving, points, self.fraction)
        centres = np.concatenate([driving, thinned(roles.fixed, points, self.fraction)])
        interpolant = RadialInterpolant(points[centres], self.kernel, self.degree, self.radius)
        for name, value in (
            ("moving", roles.moving),
            ("fixed", roles.fixed),
            ("_roles", roles),
            ("_driving", driving),
            ("_centres", centres),
            ("_interpolant", interpolant),
        ):
            object.__setattr__(self, name, value)
        if self.cached and not self.incremental:
            unit = interpolant.coefficients(np.eye(len(centres), len(driving)))
            object.__setattr__(self, "_response", interpolant.evaluated(unit, points[roles.free]))

    def move(self, current: Array, positions: Array) -> Array:
        """Return all node positions; see `FullMeshMover.move`."""
        start = self._roles.start(current, self.incremental)
        given = self._roles.displacement(start, positions)
        points, free = start.copy(), self._roles.free
        if self._response is not None:
            points[free] += self._response @ given[self._driving]
        else:
            interpolant = self._interpolant if not self.incremental else self._refactorised(start)
            points[free] += interpolant.evaluated(interpolant.coefficients(given[self._centres]), start[free])
        return self._roles.placed(points, positions)

    def _refactorised(self, start: Array) -> RadialInterpolant:
        try:
            return RadialInterpolant(start[self._centres], self.kernel, self.degree, self._interpolant.scale)
        except ValueError as error:
            raise MotionFailed(f"radial basis functions on the last state: {error}") from error
