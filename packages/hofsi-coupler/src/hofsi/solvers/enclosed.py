"""Parts of the fluid whose pressure is determined only up to a constant, and what the solver does about them."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hofsi.errors import CaseError
from hofsi.fem.constraints import NodeConstraints
from hofsi.fem.geometry import Geometry
from hofsi.fem.spaces import TaylorHood

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["EnclosedRegions"]

_CLOSED = 1e-9  # part of ∮ φ n that a free direction may carry by round-off
_CLOSED_PERIODIC = 1e-6  # the same where sides cancel that need not agree to round-off
_LEAK = 0.02  # net flux, as a part of ∮ |u|, that elements explain which do not resolve the given velocities, ...
_LEAK_IN_MOTION = 0.1  # ... and the one that the time discretisation of a moving boundary explains


class EnclosedRegions:
    """Connected parts of the fluid with no boundary through which a constant pressure could be felt.

    A constant pressure does work on a velocity u only by ∮ u·n. A region is enclosed if no free unknown of its velocity
    contributes to that integral, whatever conditions bring this about: walls, given velocities, slip, or a component
    given along the normal. One pressure of each enclosed region is held, and its mean is made zero afterwards.

    The given velocities must balance, ∮ u·n = 0. What the discretisation leaves over (of the order of the time step on
    moving boundaries) is spread evenly: ∇·u = ∮ u·n / area.

    Parameters
    ----------
    space : TaylorHood
    constraints : NodeConstraints
        Of the velocity.
    flux : ndarray, shape (e, n, 2)
        ∫ ∂N/∂x over each element: what a unit pressure does to a velocity.

    Attributes
    ----------
    pinned : tuple of int
        One unknown of each region, numbered as in the space.
    drifts : tuple of ndarray, shape (2,)
        Directions of uniform velocities that nothing holds, of any region between periodic sides.
    """

    def __init__(self, space: TaylorHood, constraints: NodeConstraints, flux: Array) -> None:
        self._space = space
        self._elements = [
            elements
            for elements in _connected(space.pressure_unknowns, space.pressure_count)
            if _closed(space, constraints, flux, elements)
        ]
        # Pressure numbers begin with the elements' corners; the first local one is never eliminated with the interior.
        self.pinned = tuple(
            2 * space.velocity_count + int(space.pressure_unknowns[elements[0], 0]) for elements in self._elements
        )
        self.drifts = tuple(
            direction
            for elements in (self._elements if space.same is not None else [])
            for direction in _drifts(constraints, np.unique(space.velocity_unknowns[elements]))
        )

    def __len__(self) -> int:
        return len(self._elements)

    def balance(self, load: Array, velocity: Array, geometry: Geometry, flux: Array, *, moving: bool = False) -> None:
        """Write the evenly spread source that balances the boundary's velocity into element load vectors.

        Parameters
        ----------
        load : ndarray, shape (e, 2n + m)
            Its rows of the continuity equation are overwritten in the enclosed regions.
        velocity : ndarray, shape (n, 2)
            With the boundary's values.
        geometry : Geometry
        flux : ndarray, shape (e, n, 2)
        moving : bool
            Whether the mesh moves; more is left over then.

        Raises
        ------
        CaseError
            If the given velocities do not balance even roughly.
        """
        space = self._space
        for elements, (net, gross) in zip(self._elements, self.net_flows(velocity, flux), strict=True):
            largest = np.abs(velocity[space.velocity_cells[elements]]).max()
            rounding = 1e-12 * float(np.abs(flux[elements]).sum() * largest)
            if abs(net) > (_LEAK_IN_MOTION if moving else _LEAK) * gross + rounding:
                raise CaseError(
                    f"the velocities around an enclosed part of the fluid bring in {-net:.4g} per unit time more than "
                    f"they let out (∮ |u| = {gross:.4g}); an incompressible fluid needs the sum 0. Correct the given "
                    'velocities, open a boundary with type = "do-nothing", "traction" or "pressure", or refine the '
                    "mesh if it is too coarse for them.",
                    "fluid.boundary",
                )
            weights = geometry.weights[elements]
            shares = (-net / weights.sum()) * (weights @ space.pressure.N)
            for rows, part in zip(space.rows(2), np.split(shares, [space.pressure_boundary], axis=1), strict=True):
                load[elements, rows] = part

    def net_flows(self, velocity: Array, flux: Array) -> list[tuple[float, float]]:
        """∮ u·n and about ∮ |u| of each region, for a velocity (n, 2) with the boundary's values."""
        flows = []
        for elements in self._elements:
            cells = self._space.velocity_unknowns[elements]
            flows.append(
                (float((flux[elements] * velocity[cells]).sum()), _gross_flux(cells, flux[elements], velocity))
            )
        return flows

    def expect_held(self) -> None:
        """Check that no region can have any uniform velocity on top, which a steady flow does not determine.

        Raises
        ------
        CaseError
            If one can.
        """
        if self.drifts:
            x, y = self.drifts[0] * np.sign(self.drifts[0][np.abs(self.drifts[0]).argmax()])
            raise CaseError(
                f"between periodic sides nothing holds a uniform velocity along ({x:.4g}, {y:.4g}): the steady "
                "velocity is determined but for that. March in time, from an initial velocity, or give an edge "
                'type = "no-slip" or "velocity"',
                "fluid.boundary",
            )

    def remove_mean(self, pressure: Array, residual: Array, geometry: Geometry, flux: Array) -> None:
        """Subtract each region's mean pressure, and what it did, from the pressure (m,) and the element residuals."""
        space = self._space
        for elements in self._elements:
            weights = geometry.weights[elements]
            at_points = pressure[space.pressure_cells[elements]] @ space.pressure.N.T
            mean = float(np.sum(weights * at_points) / np.sum(weights))
            pressure[np.unique(space.pressure_cells[elements])] -= mean
            residual[elements] -= space.local_vector(mean * flux[elements])


def _connected(cells: Index, count: int) -> list[Index]:
    """Elements of each set that hangs together by common pressure nodes."""
    rows = np.repeat(np.arange(len(cells)), cells.shape[1])
    incidence = sp.csr_matrix((np.ones(cells.size), (rows, cells.ravel())), shape=(len(cells), count))
    number, labels = sp.csgraph.connected_components(incidence @ incidence.T, directed=False)
    return [np.flatnonzero(labels == label) for label in range(number)]


def _nodal_flux(cells: Index, flux: Array) -> tuple[Index, Array]:
    """Nodes of some elements and ∮ φ n at each, shape (k, 2); zero inside."""
    nodes, inverse = np.unique(cells, return_inverse=True)
    inverse = inverse.ravel()
    total = np.stack([np.bincount(inverse, weights=flux[..., a].ravel()) for a in range(2)], axis=-1)
    return nodes, np.asarray(total, dtype=np.float64)


def _closed(space: TaylorHood, constraints: NodeConstraints, flux: Array, elements: Index) -> bool:
    nodes, total = _nodal_flux(space.velocity_unknowns[elements], flux[elements])
    own = (constraints.frames[nodes].transpose(0, 2, 1) @ total[:, :, None])[:, :, 0]
    free = np.abs(own[~constraints.fixed[nodes]])
    # Through periodic sides what the elements of one side let out cancels with what those of the other let in.
    if space.same is not None:
        whole = _nodal_flux(space.velocity_cells[elements], flux[elements])[1]
        return bool(free.max(initial=0.0) <= _CLOSED_PERIODIC * np.abs(whole).max())
    return bool(free.max(initial=0.0) <= _CLOSED * np.abs(own).max())


def _drifts(constraints: NodeConstraints, nodes: Index) -> Array:
    """Directions of the uniform velocities that the constraints at some nodes allow, shape (0 to 2, 2)."""
    held = constraints.frames[nodes].transpose(0, 2, 1)[constraints.fixed[nodes]]
    values, vectors = np.linalg.eigh(held.T @ held)
    return np.asarray(vectors.T[values <= _CLOSED * max(1.0, float(values[-1]))])


def _gross_flux(cells: Index, flux: Array, velocity: Array) -> float:
    """Σ |∮ φ n| |u| over the nodes, of the size of ∮ |u|."""
    nodes, total = _nodal_flux(cells, flux)
    return float(np.sum(np.hypot(total[:, 0], total[:, 1]) * np.hypot(velocity[nodes, 0], velocity[nodes, 1])))
