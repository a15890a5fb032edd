"""Convection of a fluid on one mesh, in the form that the case asks for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hofsi.kernels import navier_stokes as kernel
from hofsi.solvers.fluid_equations import FluidEquations
from hofsi.solvers.fluid_matrices import Coefficients, SkewTerms

Array = NDArray[np.float64]

__all__ = ["ConvectionTerms", "FluidConvection"]


@dataclass(frozen=True, eq=False)
class ConvectionTerms:
    """Convection at the quadrature points, over the density.

    Attributes
    ----------
    force : ndarray, shape (e, q, 2)
        What is tested with v.
    stress : ndarray, shape (a, b, e, q), or None
        What is tested with ∂_b v_a.
    fluxes : sequence of pairs of ndarray, each (n, 2)
        Nodal a and u of ½ ∮ (a·n) u·v.
    """

    force: Array
    stress: Array | None
    fluxes: Sequence[tuple[Array, Array]]


class FluidConvection:
    """The form c(a; u, v) of convection, linear in a, u and v, and its linearisations.

    With a = u - w it is ∫ ρ (a·∇u)·v, or skew-symmetric in u and v but for what flows through the boundary, which is
    the same plus ½ ρ (∇·u) u·v if integrals are exact:

        ½ ∫ ρ [(a·∇u)·v - (a·∇v)·u] + ½ ∫ ρ (∇·w) u·v + ½ ∮ ρ (a·n) u·v

    Parameters
    ----------
    equations : FluidEquations
    points, mesh_velocity : ndarray, shape (n, 2)
    """

    def __init__(self, equations: FluidEquations, points: Array, mesh_velocity: Array) -> None:
        self._equations, self._points, self._mesh_velocity = equations, points, mesh_velocity
        self._skew = equations.fluid.skew_symmetric
        self._about: tuple[Array, Array] | None = None

    def coefficients(self, velocity: Array, density: float, *, newton: bool) -> Coefficients:
        """Those of matrices of c(u - w; ·, ·) of a nodal velocity (n, 2), with ``newton`` of c(·; u, ·) too."""
        equations, relative = self._equations, velocity - self._mesh_velocity
        geometry = equations.geometry(self._points)
        w, J_inv = geometry.weights, geometry.J_inv
        part = 0.5 * density if self._skew else density
        along = kernel.convection(w, J_inv, part, self._at_points(relative))
        reaction = kernel.reaction(w, part, self._gradient_about(velocity)) if newton else None
        sides = equations.backflow.terms(self._points, relative)
        equations.counts.backflows += bool(sides)
        if not self._skew:
            return Coefficients(*along, reaction, sides)
        pairs = None
        sides += equations.flux.terms(self._points, density, relative)
        if newton:
            pairs = kernel.advected_transport(w, J_inv, part, self._at_points(velocity))
            sides += equations.flux.derivatives(self._points, density, velocity)
        skew = SkewTerms(None if self._spreading is None else part * w * self._spreading, pairs)
        return Coefficients(*along, reaction, sides, skew)

    def full(self, velocity: Array, gradient: Array) -> ConvectionTerms:
        """c(u - w; u, ·) of a nodal velocity (n, 2) with the gradient (a, b, e, q)."""
        return self._terms(velocity - self._mesh_velocity, velocity, gradient)

    def about(self, velocity: Array, gradient: Array, expected: Array, *, newton: bool) -> ConvectionTerms:
        """c(û - w; u, ·), with ``newton`` + c(u - û; û, ·), û the velocity expected."""
        return self._terms(expected - self._mesh_velocity, velocity, gradient, expected if newton else None)

    def gradient(self, velocity: Array) -> Array:
        """∂_b u_a at the quadrature points, shape (a, b, e, q)."""
        space = self._equations.space
        J_inv = self._equations.geometry(self._points).J_inv
        return kernel.velocity_gradient(space.velocity.dN, J_inv, velocity[space.velocity_cells])

    def _terms(
        self, advective: Array, velocity: Array, gradient: Array, expected: Array | None = None
    ) -> ConvectionTerms:
        """c(a; u, ·), and c(u - û; û, ·) if û is given."""
        force = kernel.advection(gradient, self._at_points(advective))
        fluxes = [(advective, velocity)]
        if expected is not None:
            force += kernel.advection(self._gradient_about(expected), self._at_points(velocity - expected))
            fluxes.append((velocity - expected, expected))
        if not self._skew:
            return ConvectionTerms(force, None, ())
        if self._spreading is not None:
            force += self._spreading[..., None] * self._at_points(velocity)
        stress = sum(kernel.advected_stress(self._at_points(u), self._at_points(a)) for a, u in fluxes)
        return ConvectionTerms(0.5 * force, np.asarray(0.5 * stress), fluxes)

    def _at_points(self, field: Array) -> Array:
        """A nodal field (n, 2) at the quadrature points, shape (e, q, 2)."""
        space = self._equations.space
        return np.asarray(space.velocity.N @ field[space.velocity_cells])

    def _gradient_about(self, velocity: Array) -> Array:
        """The gradient of a velocity that is linearised about, usually several times: the last one is kept."""
        if self._about is None or self._about[0] is not velocity:
            self._about = velocity, self.gradient(velocity)
        return self._about[1]

    @cached_property
    def _spreading(self) -> Array | None:
        """∇·w at the quadrature points, shape (e, q), or None if the mesh stands still."""
        if not self._mesh_velocity.any():
            return None
        gradient = self.gradient(self._mesh_velocity)
        return np.asarray(gradient[0, 0] + gradient[1, 1])
