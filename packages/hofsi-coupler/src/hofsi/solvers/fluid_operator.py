"""The discrete equations of one step, or of the steady state, of a fluid on one mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi.fem.assembly import assemble_vector
from hofsi.fem.element_matrices import TracedMatrices, batches
from hofsi.kernels import navier_stokes as kernel
from hofsi.solvers.fluid_convection import ConvectionTerms, FluidConvection
from hofsi.solvers.fluid_equations import FluidEquations
from hofsi.solvers.fluid_matrices import MatrixOrigin, element_matrices
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
    share : float, optional
        Of the convection.

    Attributes
    ----------
    load : ndarray, shape (e, k)
        Element vectors f.
    share : float
        Of the convection, 1 for all of it.
    """

    def __init__(
        self,
        equations: FluidEquations,
        points: Array,
        mesh_velocity: Array,
        rate: float,
        history: Array,
        time: float,
        *,
        share: float = 1.0,
    ) -> None:
        self._equations, self._points, self._mesh_velocity, self._rate = equations, points, mesh_velocity, rate
        self.share = share
        self._convection = FluidConvection(equations, points, mesh_velocity)
        self.load = self._external(history, time)

    def _external(self, history: Array, time: float) -> Array:
        """Element load vectors of inertia, body force and given tractions."""
        equations, space = self._equations, self._equations.space
        geometry = equations.geometry(self._points)
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

    def matrices(self, velocity: Array, *, newton: bool) -> TracedMatrices:
        """What makes element matrices A(u) of a nodal velocity (n, 2), which convects with u - w.

        With ``newton`` Newton's term, what convects u, is added.
        """
        equations = self._equations
        changing = self._convection.coefficients(velocity, self._density, newton=newton)
        equations.counts.assemblies += 1
        constant = equations.constant_terms(self._points, self._rate).ask()
        origin = MatrixOrigin(self._points, self._mesh_velocity, self._rate, self.share, velocity, newton)
        return TracedMatrices(element_matrices(constant, changing), origin)

    @property
    def _density(self) -> float:
        return self.share * self._equations.fluid.density

    def residual(self, unknowns: Array) -> Array:
        """Element residuals f - A(u) u, shape (e, k), from the fields at the quadrature points, without any matrix."""
        velocity = self._velocity(unknowns)
        gradient = self._convection.gradient(velocity)
        convection = self._convection.full(velocity, gradient)
        return self._imbalance(unknowns, gradient, convection, velocity - self._mesh_velocity)

    def residual_about(self, unknowns: Array, expected: Array, *, newton: bool) -> Array:
        """Element residuals of the equations linearised about an expected velocity (n, 2), otherwise as `residual`.

        The convection is û·∇u, with ``newton`` û·∇u + u·∇û - û·∇û, the advecting û less the mesh velocity.
        """
        velocity = self._velocity(unknowns)
        gradient = self._convection.gradient(velocity)
        convection = self._convection.about(velocity, gradient, expected, newton=newton)
        return self._imbalance(unknowns, gradient, convection, expected - self._mesh_velocity)

    def residual_without_convection(self, unknowns: Array) -> Array:
        """Element residuals of Stokes' equations, otherwise as `residual`."""
        return self._imbalance(unknowns, self._convection.gradient(self._velocity(unknowns)), None, None)

    def _imbalance(
        self, unknowns: Array, gradient: Array, convection: ConvectionTerms | None, relative: Array | None
    ) -> Array:
        """Element residuals for a velocity gradient (a, b, e, q), a convection and what convects at outlets."""
        equations, space, fluid = self._equations, self._equations.space, self._equations.fluid
        geometry, velocity = equations.geometry(self._points), self._velocity(unknowns)
        divergence = gradient[0, 0] + gradient[1, 1]
        pressure = unknowns[velocity.size :][space.pressure_cells] @ space.pressure.N.T
        stress = fluid.viscosity * (gradient + gradient.swapaxes(0, 1))
        for a in range(2):
            stress[a, a] += fluid.grad_div * divergence - pressure
        if convection is not None and convection.stress is not None:
            stress += self._density * convection.stress
        nodal = -kernel.stress_work(space.velocity.dN, geometry.J_inv, geometry.weights, stress)
        if self._rate or convection is not None:
            inertia = np.zeros((*geometry.weights.shape, 2))
            if self._rate:
                inertia += (self._rate * fluid.density) * (space.velocity.N @ velocity[space.velocity_cells])
            if convection is not None:
                inertia += self._density * convection.force
            nodal -= kernel.load(space.velocity.N, geometry.weights, inertia)
        r = self.load + space.local_vector(nodal)
        sources = (geometry.weights * divergence) @ space.pressure.N
        for rows, part in zip(space.rows(2), np.split(sources, [space.pressure_boundary], axis=1), strict=True):
            r[:, rows] += part
        equations.boundary.subtract_do_nothing(r, self._points, velocity)
        if convection is not None and relative is not None:
            equations.backflow.subtract(r, self._points, relative, velocity)
            for advective, advected in convection.fluxes:
                equations.flux.add(r, self._points, -self._density, advective, advected)
        return r

    def _velocity(self, unknowns: Array) -> Array:
        return unknowns[: 2 * self._equations.space.velocity_count].reshape(-1, 2)

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
        make, local = self.matrices(self._velocity(unknowns), newton=False), np.abs(unknowns)[space.dofs]
        rows = np.empty(local.shape)
        for batch in batches(*local.shape):
            rows[batch] = (np.abs(make(batch)) @ local[batch, :, None])[:, :, 0]
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
