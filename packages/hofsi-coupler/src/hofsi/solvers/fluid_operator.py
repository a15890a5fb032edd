"""The discrete equations of one step, or of the steady state, of a fluid on one mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi.fem.assembly import assemble_vector
from hofsi.kernels import navier_stokes as kernel
from hofsi.kernels import tensor_products
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

    def matrices(self, velocity: Array, *, newton: bool) -> Array:
        """Element matrices A(u) of a nodal velocity (n, 2), with the convection ∫ ρ ((u - w)·∇·)·v.

        With ``newton`` Newton's term ∫ ρ (·∇u)·v is added.
        """
        space = self._equations.space
        A = self.without_convection().copy()
        geometry, dNx, dNy = self._equations.geometry(self._points)
        a = space.velocity.N @ (velocity - self._mesh_velocity)[space.velocity_cells]
        c = kernel.convection(geometry.weights, geometry.J_inv, self._density, a)
        convection = tensor_products.transport(self._equations.products, *c)
        if newton:
            gradient = kernel.velocity_gradient(dNx, dNy, velocity[space.velocity_cells])
            g = kernel.reaction(geometry.weights, self._density, gradient).reshape(-1, a.shape[1])
            xx, xy, yx, yy = np.split(tensor_products.mass(self._equations.products, g), 4)
            space.add(A, 0, 1, xy)
            space.add(A, 1, 0, yx)
            space.add(A, 0, 0, np.add(xx, convection, out=xx))
            space.add(A, 1, 1, np.add(yy, convection, out=yy))
        else:
            space.add(A, 0, 0, convection)
            space.add(A, 1, 1, convection)
        counts = self._equations.counts
        counts.backflows += self._equations.backflow.add(A, self._points, velocity - self._mesh_velocity)
        counts.assemblies += 1
        return A

    @property
    def _density(self) -> float:
        return self.share * self._equations.fluid.density

    def convection(self, velocity: Array, advective: Array) -> Array:
        """Element vectors of ∫ ρ (a·∇u)·v for nodal velocities u and a."""
        space = self._equations.space
        geometry, dNx, dNy = self._equations.geometry(self._points)
        gradient = kernel.velocity_gradient(dNx, dNy, velocity[space.velocity_cells])
        a = space.velocity.N @ advective[space.velocity_cells]
        density = self._density * (gradient @ a[..., None])[..., 0]
        return space.local_vector(kernel.load(space.velocity.N, geometry.weights, density))

    def residual(self, unknowns: Array) -> Array:
        """Element residuals f - A(u) u, shape (e, k), without assembling A(u)."""
        velocity = self._velocity(unknowns)
        relative = velocity - self._mesh_velocity
        r = self.imbalance(self.without_convection(), unknowns) - self.convection(velocity, relative)
        self._equations.backflow.subtract(r, self._points, relative, velocity)
        return r

    def _velocity(self, unknowns: Array) -> Array:
        return unknowns[: 2 * self._equations.space.velocity_count].reshape(-1, 2)

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

    def is_rounding(self, norm: float, unknowns: Array, part: float) -> bool:
        """Whether the norm of a residual is at most a part of ‖|A(u)| |u|‖.

        Unlike the scale of `size` that does not vanish if the terms of every row cancel.
        """
        if norm > part * self._largest_magnitude(unknowns):
            return False
        space = self._equations.space
        A = self.matrices(self._velocity(unknowns), newton=False)
        rows = (np.abs(A, out=A) @ np.abs(unknowns)[space.dofs][:, :, None])[:, :, 0]
        return norm <= part * float(np.linalg.norm(assemble_vector(space.dofs, rows, space.size)))

    def _largest_magnitude(self, unknowns: Array) -> float:
        """A bound of ‖|A(u)| |u|‖ that is quick to find."""
        velocity = self._velocity(unknowns)
        u, a = np.abs(velocity).max(), np.abs(velocity - self._mesh_velocity).max()
        fixed, convecting = self._equations.row_sums(self._points, self._rate)
        return float(np.abs(unknowns).max() * fixed + 2.0 * self._density * a * u * convecting)

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
