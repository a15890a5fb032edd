"""Whether elements are fine enough for the flow in them: Péclet numbers, and what their highest polynomials hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legval
from numpy.typing import NDArray

from hoblock.reference import gauss_lobatto
from hofsi.fem.resampling import lexicographic
from hofsi.solvers.fluid import FluidSolver, FluidState

Array = NDArray[np.float64]

__all__ = ["FlowResolution", "flow_resolution"]


@dataclass(frozen=True, eq=False)
class FlowResolution:
    """Measures of all elements.

    Attributes
    ----------
    peclet : ndarray, shape (e,)
        Largest ρ |u - w| h/(2 μ p), h the element's length along the flow, so that h/p is the mean distance of nodes.
    roughness : ndarray, shape (e,)
        Root mean square of the part of the velocity in the polynomials of the element's highest degree along one of its
        directions, over the largest velocity anywhere; small where the element resolves the flow.
    """

    peclet: Array
    roughness: Array


def flow_resolution(solver: FluidSolver, state: FluidState) -> FlowResolution:
    """Measure how well the elements resolve the flow at a state."""
    return FlowResolution(_peclet(solver, state), _roughness(solver, state))


def _peclet(solver: FluidSolver, state: FluidState) -> Array:
    space, fluid = solver.space, solver.fluid
    velocity = state.velocity if state.mesh_velocity is None else state.velocity - state.mesh_velocity
    a = space.velocity.N @ velocity[space.velocity_cells]
    reference = np.abs((solver.geometry(state.points[0]).J_inv @ a[..., None])[..., 0]).max(axis=-1)
    speed = np.hypot(a[..., 0], a[..., 1])
    length = np.divide(2.0 * speed, reference, out=np.zeros_like(speed), where=reference > 0.0)
    return np.asarray(fluid.density * (speed * length).max(axis=1) / (2.0 * fluid.viscosity * space.velocity.order))


def _roughness(solver: FluidSolver, state: FluidState) -> Array:
    space = solver.space
    p = space.velocity.order
    u = state.velocity[lexicographic(space.velocity_cells, p)].reshape(-1, p + 1, p + 1, 2)
    highest = _highest_coefficient(p)
    along = [np.einsum("i,ejia->eja", highest, u), np.einsum("j,ejia->eia", highest, u)]
    squares = [(part**2).sum(axis=-1).mean(axis=-1) / (2 * p + 1) for part in along]
    largest = float(np.abs(state.velocity).max())
    return np.sqrt(np.maximum(*squares)) / largest if largest else np.zeros(len(u))


def _highest_coefficient(p: int) -> Array:
    """Weights of the p + 1 GLL nodes that give the coefficient of the Legendre polynomial of degree p.

    On these nodes the quadrature's norm of that polynomial is 2/p, its weights are 2/(p (p + 1) P_p²).
    """
    return np.asarray(1.0 / ((p + 1) * legval(gauss_lobatto(p), [0.0] * p + [1.0])))
