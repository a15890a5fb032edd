"""Airfoils of the NACA four-digit series."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["NacaProfile", "NacaSurface"]

_THICKNESS = (0.2969, -0.1260, -0.3516, 0.2843)
"""Coefficients of √x, x, x², x³ in the half thickness over 5 t; that of x⁴ closes the trailing edge or does not."""

_CLOSED, _BLUNT = -0.1036, -0.1015


@dataclass(frozen=True)
class NacaProfile:
    """An airfoil of the NACA four-digit series.

    Its nose is at (0, 0), its chord along the x axis, before it is turned about the quarter-chord point.

    Attributes
    ----------
    camber : float
        Largest height of the camber line over the chord.
    position : float
        Where it is, over the chord.
    thickness : float
        Largest thickness over the chord.
    chord : float
    angle : float
        Angle of attack in radians: the nose turns up.
    closed : bool
        Whether the trailing edge is sharp; if not, it is blunt as in the original definition.

    References
    ----------
    E. N. Jacobs, K. E. Ward, R. M. Pinkerton, The characteristics of 78 related airfoil sections from tests in the
    variable-density wind tunnel, NACA Report 460 (1933).
    """

    camber: float
    position: float
    thickness: float
    chord: float = 1.0
    angle: float = 0.0
    closed: bool = True

    @staticmethod
    def from_digits(digits: str, chord: float = 1.0, angle: float = 0.0, closed: bool = True) -> NacaProfile:
        """Return the airfoil of a designation such as ``"2412"``: camber 2 %, at 40 %, thickness 12 % of the chord.

        Raises
        ------
        ValueError
            If it is no designation of the series.
        """
        if not re.fullmatch(r"\d{4}", digits, re.ASCII):
            raise ValueError("expected four digits such as '0012' or '2412'")
        camber, position, thickness = int(digits[0]), int(digits[1]), int(digits[2:])
        if not 1 <= thickness <= 40:
            raise ValueError("expected a thickness (the last two digits) from 01 to 40")
        if (camber == 0) != (position == 0):
            raise ValueError("expected first and second digit both 0 (no camber) or neither")
        return NacaProfile(camber / 100.0, position / 10.0, thickness / 100.0, chord, angle, closed)

    @property
    def split(self) -> float:
        """Parameter √x where the surface is not smooth: at the largest camber; at x = 1/4 without camber."""
        return math.sqrt(self.position) if self.camber else 0.5

    @property
    def nose_slope(self) -> float:
        """Derivative of the half thickness with respect to √x at the nose, over the chord: √(2 nose radius)."""
        return 5.0 * self.thickness * _THICKNESS[0]

    def half_thickness(self, tau: Array) -> tuple[Array, Array]:
        """Half the thickness over the chord at x = τ², and its derivative with respect to τ."""
        coefficients = np.zeros(9)
        coefficients[[1, 2, 4, 6]] = _THICKNESS
        coefficients[8] = _CLOSED if self.closed else _BLUNT
        polynomial = np.polynomial.Polynomial(5.0 * self.thickness * coefficients)
        return polynomial(tau), polynomial.deriv()(tau)

    def camber_line(self, x: Array, rear: bool) -> tuple[Array, Array, Array]:
        """Height of the camber line over the chord and its first two derivatives, before or behind its top."""
        if not self.camber:
            return np.zeros_like(x), np.zeros_like(x), np.zeros_like(x)
        m, p = self.camber, self.position
        scale = m / (1.0 - p) ** 2 if rear else m / p**2
        y = scale * ((1.0 - 2.0 * p if rear else 0.0) + 2.0 * p * x - x * x)
        return y, 2.0 * scale * (p - x), np.full_like(x, -2.0 * scale)

    def surface(self, tau: Array, side: int, rear: bool) -> tuple[Array, Array]:
        """Points (n, 2) of the upper (side 1) or lower (-1) surface at x = τ², and their derivatives by τ."""
        x = tau * tau
        thick, thick_slope = self.half_thickness(tau)
        line, slope, bend = self.camber_line(x, rear)
        theta = np.arctan(slope)
        turning = bend / (1.0 + slope**2) * 2.0 * tau
        sin, cos = side * np.sin(theta), side * np.cos(theta)
        points = np.stack([x - thick * sin, line + thick * cos], axis=-1)
        dx = 2.0 * tau - thick_slope * sin - thick * cos * turning
        dy = 2.0 * tau * slope + thick_slope * cos - thick * sin * turning
        pivot = np.array([0.25, 0.0])
        placed = self._placed(points - pivot) + self.chord * pivot
        return placed, self._placed(np.stack([dx, dy], axis=-1))

    def _placed(self, vectors: Array) -> Array:
        sin, cos = math.sin(self.angle), math.cos(self.angle)
        return np.asarray(self.chord * vectors @ np.array([[cos, -sin], [sin, cos]]))


@dataclass(frozen=True)
class NacaSurface:
    """Part of an airfoil's surface, or a line at constant distance from it; runs towards the trailing edge.

    The parameter is proportional to √x: the curve is smooth at the nose too, where √x would not be smooth in x, and
    elements of equal parameter length cluster there.

    Attributes
    ----------
    profile : NacaProfile
    side : int
        1: upper, -1: lower.
    rear : bool
        The part behind `NacaProfile.split`; otherwise the one before.
    distance : float
        Normal distance from the surface, outwards.
    """

    profile: NacaProfile
    side: int
    rear: bool
    distance: float = 0.0

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        start, stop = (self.profile.split, 1.0) if self.rear else (0.0, self.profile.split)
        t = np.asarray(t, dtype=float)
        points, tangents = self.profile.surface((1.0 - t) * start + t * stop, self.side, self.rear)
        if self.distance == 0.0:
            return points
        normals = self.side * np.stack([-tangents[:, 1], tangents[:, 0]], axis=-1)
        return np.asarray(points + self.distance * normals / np.hypot(*tangents.T)[:, None])
