"""Integrals over the whole fluid: kinetic energy, enstrophy, dissipation, divergence."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi.kernels import navier_stokes as kernel
from hofsi.solvers.fluid import FluidSolver, FluidState

Array = NDArray[np.float64]

__all__ = ["area", "continuity_residual", "dissipation", "divergence", "enstrophy", "kinetic_energy"]


def area(solver: FluidSolver, state: FluidState) -> float:
    """Area of the fluid where it is now."""
    return float(solver.geometry(state.points[0]).weights.sum())


def kinetic_energy(solver: FluidSolver, state: FluidState) -> float:
    """∫ ρ |u|²/2."""
    space = solver.space
    u = space.velocity.N @ state.velocity[space.velocity_cells]
    return _integral(solver, state, 0.5 * solver.fluid.density * (u * u).sum(axis=-1))


def enstrophy(solver: FluidSolver, state: FluidState) -> float:
    """∫ ω²/2 with the vorticity ω = ∂v/∂x - ∂u/∂y."""
    gradient = _gradient(solver, state)
    return _integral(solver, state, 0.5 * (gradient[1, 0] - gradient[0, 1]) ** 2)


def dissipation(solver: FluidSolver, state: FluidState) -> float:
    """∫ 2 μ ε(u):ε(u), the power that becomes heat."""
    gradient = _gradient(solver, state)
    strain = 0.5 * (gradient + gradient.swapaxes(0, 1))
    return _integral(solver, state, 2.0 * solver.fluid.viscosity * (strain * strain).sum(axis=(0, 1)))


def divergence(solver: FluidSolver, state: FluidState) -> float:
    """(∫ (∇·u)²)^½, which falls with the elements' size at the order of the velocity's gradient."""
    return float(np.sqrt(_integral(solver, state, _divergence(solver, state) ** 2)))


def continuity_residual(solver: FluidSolver, state: FluidState) -> float:
    """Largest |∫ ψ ∇·u| of all pressure basis functions ψ, a flow rate: what the solution leaves of continuity.

    It is rounding, but for enclosed regions whose given velocities do not balance exactly: there it is their share of
    the source that balances them.
    """
    space = solver.space
    weights = solver.geometry(state.points[0]).weights
    local = (weights * _divergence(solver, state)) @ space.pressure.N
    total = np.bincount(space.pressure_unknowns.ravel(), weights=local.ravel(), minlength=space.pressure_count)
    return float(np.abs(total).max())


def _gradient(solver: FluidSolver, state: FluidState) -> Array:
    """∂_b u_a at the quadrature points, shape (a, b, e, q)."""
    space = solver.space
    J_inv = solver.geometry(state.points[0]).J_inv
    return kernel.velocity_gradient(space.velocity.dN, J_inv, state.velocity[space.velocity_cells])


def _divergence(solver: FluidSolver, state: FluidState) -> Array:
    gradient = _gradient(solver, state)
    return np.asarray(gradient[0, 0] + gradient[1, 1])


def _integral(solver: FluidSolver, state: FluidState, density: Array) -> float:
    """Integral of a density (e, q)."""
    return float((solver.geometry(state.points[0]).weights * density).sum())
