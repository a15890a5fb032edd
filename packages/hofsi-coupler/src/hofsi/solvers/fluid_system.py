"""The linear systems of the fluid, direct or iterative as the case asks for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hofsi.case import LinearSettings
from hofsi.counts import Counts
from hofsi.fem.condensation import CondensedSystem
from hofsi.fem.constraints import NodeConstraints
from hofsi.fem.element_matrices import ElementMatrices
from hofsi.fem.saddle_point import SaddlePointSystem
from hofsi.fem.spaces import TaylorHood
from hofsi.linear.choice import choose_solver
from hofsi.linear.solver import Solver

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["FluidSystem", "SystemOrigin", "factorised", "fluid_system"]


@dataclass(frozen=True, eq=False)
class SystemOrigin:
    """What the pattern of a linear system was made from.

    Attributes
    ----------
    constraints : ndarray, shape (n, 2)
        Node positions at which its constraints were made.
    places : ndarray, shape (n, 2)
        Node positions by which its elements are ordered.
    """

    constraints: Array
    places: Array


class FluidSystem(Protocol):
    """Pattern of linear systems on the same elements and constraints.

    Attributes
    ----------
    dofs : ndarray, shape (e, k)
        Global numbers of the local unknowns of each element; those on the element's boundary first.
    boundary : int
        How many local unknowns lie on the element's boundary.
    unknowns : ndarray
        Free unknowns on the elements' boundaries.
    origin : object
        What it was made from.
    """

    dofs: Index
    boundary: int
    unknowns: Index
    origin: object

    def prepare(self) -> None:
        """Make what can be known before the numbers."""
        ...

    def factorise(self, A: ElementMatrices, *, tolerance: float | None = None) -> Solver:
        """Make what solves, from element vectors (e, k) to all unknowns, with element matrices.

        Iteration may end at the given tolerance of the residual, relative to the right-hand side.
        """
        ...


def fluid_system(
    space: TaylorHood,
    constraints: NodeConstraints,
    pinned: tuple[int, ...],
    linear: LinearSettings,
    points: Array,
    counts: Counts,
    interface: Index,
) -> FluidSystem:
    """Choose the linear systems of a fluid.

    Parameters
    ----------
    space : TaylorHood
    constraints : NodeConstraints
        Of the velocity.
    pinned : tuple of int
        Pressure unknowns that are held fixed.
    linear : LinearSettings
    points : ndarray, shape (n, 2)
        Where the nodes are.
    counts : Counts
        Where iterations and preconditioners are counted.
    interface : ndarray
        Nodes whose velocity a solid prescribes.
    """
    places = points[space.velocity_cells].mean(axis=1)
    kept = space.size - (space.dofs.shape[1] - space.boundary) * len(space.dofs)
    periodic = space.same is not None
    if choose_solver(linear.solver, kept, periodic=periodic).solver == "direct":
        copies = space.copies if periodic else None
        # Where a pressure is held, velocities of the interface take sources that balance them: not a matter of the
        # matrix alone. Periodic sides have nodes that stand for others.
        border = () if pinned or periodic else (2 * interface[:, None] + np.arange(2)).ravel()
        return CondensedSystem(space.dofs, space.boundary, space.size, constraints, pinned, places, copies, border)
    return SaddlePointSystem(
        space, constraints, pinned, places, _lengths(points[space.corners]), linear.tolerance, counts
    )


def factorised(system: FluidSystem, A: ElementMatrices, *, responding: bool) -> Solver:
    """Make what solves with element matrices; with ``responding`` it tells, if it can, how the interface responds."""
    if responding and isinstance(system, CondensedSystem) and system.exact:
        return system.factorise_with_border(A)
    return system.factorise(A)


def _lengths(X: Array) -> Array:
    """Lengths along ξ and η, shape (e, 2), of quads with corners X (e, 4, 2)."""
    middles = 0.5 * (X + np.roll(X, -1, axis=1))  # of sides 0, η = -1, to 3, ξ = -1
    return np.asarray(np.linalg.norm(middles[:, [1, 2]] - middles[:, [3, 0]], axis=2))
