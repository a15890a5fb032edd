"""The discrete equations of one step, or of the steady state, of a fluid on one mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi.fem.assembly import assemble_vector
from hofsi.kernels import navier_stokes as kernel
from hofsi.solvers.fluid_equations import FluidEquations
from hofsi.solvers.fluid_system import FluidSystem

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["FluidOperator"]


class FluidOperator:
    """Element matrices and vectors of A(u) u = f on one mesh.

    Parameters
    ----------
    equations : FluidEquations
    points, mesh_velocity : ndarray, shape (n, 2)
    rate : float
        Weight of the new velocity in the time derivative; 0 if steady.
    history : ndarray, shape (n, 2)
        What the old velocities contribute to it.
    time : float
        At which loads are taken.

    Attributes
    ----------
    load : ndarray, shape (e, k)
        Element vectors f.
    share : float
        Of the convection, 1 for all of it.
    """

    def __init__(
        self, equations: FluidEquations, points: Array, mesh_velocity: Array, rate: float, history: Array, time: float
    ) -> None:
        self._equations, self._points, self._mesh_velocity, self._rate = equations, points, mesh_velocity, rate
        self.share = 1.0
        self.load = self._external(history, time)

    def _external(self, history: Array, time: float) -> Array:
        """Element load vectors of inertia, body force and given tractions."""
        equations, space = self._equations, self._equations.space
        geometry, _, _ = equations.geometry(self._points)
        force = equations.fluid.body_force
        f = np.zeros(space.dofs.shape)
        if self._rate or force is not None:
            density = np.zeros((*geometry.weights.shape, 2))
            if self._rate:
                density -= equations.fluid.density * (space.velocity.N @ history[space.velocity_cells])
            if force is not None:
                x, y = geometry.x[..., 0], geometry.x[..., 1]
                for a in range(2):
                    density[..., a] += force[a].evaluate(x=x, y=y, t=time)
            f = space.local_vector(kernel.load(space.velocity.N, geometry.weights, density))
        equations.boundary.add_loads(f, self._points, time)
        return f

    def without_convection(self) -> Array:
        """Element matrices of everything else (e, k, k), shared: not to be written to."""
        return self._equations.constant_matrices(self._points, self._rate)

    def convecting_with(self, velocity: Array) -> Array:
        """Element matrices A(u) of a nodal velocity (n, 2): its convection is ∫ ρ ((u - w)·∇·)·v."""
        space = self._equations.space
        A = self.without_convection().copy()
        geometry, dNx, dNy = self._equations.geometry(self._points)
        a = space.velocity.N @ (velocity - self._mesh_velocity)[space.velocity_cells]
        block = kernel.transport(space.velocity.N, dNx, dNy, geometry.weights, 0.0, self._density, a)
        space.add(A, 0, 0, block)
        space.add(A, 1, 1, block)
        self._equations.counts.assemblies += 1
        return A

    @property
    def _density(self) -> float:
        return self.share * self._equations.fluid.density

    def add_reaction(self, A: Array, velocity: Array) -> None:
        """Add Newton's term ∫ ρ (δu·∇u)·v."""
        space = self._equations.space
        geometry, dNx, dNy = self._equations.geometry(self._points)
        gradient = kernel.velocity_gradient(dNx, dNy, velocity[space.velocity_cells])
        blocks = kernel.reaction(space.velocity.N, geometry.weights, self._density, gradient)
        for (a, b), block in zip(((0, 0), (0, 1), (1, 0), (1, 1)), blocks, strict=True):
            space.add(A, a, b, block)

    def self_convection(self, velocity: Array) -> Array:
        """Element load vectors of ∫ ρ (u·∇u)·v for a nodal velocity."""
        space = self._equations.space
        geometry, dNx, dNy = self._equations.geometry(self._points)
        local = velocity[space.velocity_cells]
        u, gradient = space.velocity.N @ local, kernel.velocity_gradient(dNx, dNy, local)
        density = self._density * (gradient @ u[..., None])[..., 0]
        return space.local_vector(kernel.load(space.velocity.N, geometry.weights, density))

    def imbalance(self, A: Array, unknowns: Array, load: Array | None = None) -> Array:
        """Element residuals f - A u, shape (e, k); f is the operator's load if no other is given."""
        local = unknowns[self._equations.space.dofs]
        return np.asarray((self.load if load is None else load) - (A @ local[:, :, None])[:, :, 0])

    def size(self, residual: Array) -> tuple[float, float]:
        """Norm of what element residuals leave in the free rows, and a scale to compare it with."""
        system = self._equations.system(self._points)
        dofs, size = self._equations.space.dofs, self._equations.space.size
        scale = assemble_vector(dofs, np.abs(residual - self.load) + np.abs(self.load), size)
        left = self._in_frames(assemble_vector(dofs, residual, size))[_free_rows(system)]
        return float(np.linalg.norm(left)), float(np.linalg.norm(scale)) or 1.0

    def magnitude(self, A: Array, unknowns: Array) -> float:
        """Norm of |A| |u|: unlike the scale it does not vanish if the terms of every row cancel."""
        space = self._equations.space
        local = np.abs(unknowns)[space.dofs]
        rows = (np.abs(A) @ local[:, :, None])[:, :, 0]
        return float(np.linalg.norm(assemble_vector(space.dofs, rows, space.size)))

    def _in_frames(self, vector: Array) -> Array:
        """A global vector with the velocity part in the nodes' own frames."""
        constraints = self._equations.boundary.constraints(self._points)
        if constraints.rotated.size:
            n = 2 * self._equations.space.velocity_count
            pairs = vector[:n].reshape(-1, 2)
            frames = constraints.frames[constraints.rotated]
            pairs[constraints.rotated] = (frames.transpose(0, 2, 1) @ pairs[constraints.rotated][:, :, None])[:, :, 0]
        return vector


def _free_rows(system: FluidSystem) -> Index:
    inner = system.dofs[:, system.boundary :].ravel()
    return np.concatenate([system.unknowns, inner])
