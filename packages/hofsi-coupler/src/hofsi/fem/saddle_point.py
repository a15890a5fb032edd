"""Linear systems of velocity and pressure that are solved iteratively, without factors of the whole."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hofsi.counts import Counts
from hofsi.errors import LinearSolverError
from hofsi.fem.assembly import assemble_vector
from hofsi.fem.condensation import CondensedSystem
from hofsi.fem.condensed_factor import CondensedFactor
from hofsi.fem.constraints import NodeConstraints
from hofsi.fem.element_matrices import ElementMatrices, origin_of
from hofsi.fem.multigrid import GridCycle, GridLevel, grid_levels
from hofsi.fem.spaces import TaylorHood
from hofsi.linear.krylov import flexible_gmres
from hofsi.linear.solver import Solver

Array = NDArray[np.float64]

__all__ = ["CycleMemory", "SaddlePointSystem"]

_SETUP = 10
"""Iterations that cost about as much as a new preconditioner."""


@dataclass(frozen=True, eq=False)
class CycleMemory:
    """What a preconditioner was made from, and how it has served.

    Attributes
    ----------
    origin : object
        Of its matrix, see `hofsi.fem.element_matrices.origin_of`.
    taken : tuple of int
        Iterations of the solutions with it.
    """

    origin: object
    taken: tuple[int, ...]


class SaddlePointSystem(CondensedSystem):
    """Pattern of condensed systems that are solved by FGMRES with one multigrid cycle as preconditioner.

    Meshes and patterns are made once, for the first matrix. The preconditioner of one matrix serves the following
    ones, as long as the iterations of a solution beyond those of the first are fewer than the average of what it has
    cost so far, its making included.

    Parameters
    ----------
    space : TaylorHood
    constraints : NodeConstraints
        Of the velocity.
    pinned : tuple of int
        Pressure unknowns at vertices that are held fixed, numbered as in the space.
    places : ndarray, shape (e, 2)
        Where the elements are.
    lengths : ndarray, shape (e, 2)
        Of the elements along ξ and η, to choose the coarser meshes.
    tolerance : float
        Of the residual, relative to the right-hand side, both after condensation.
    counts : Counts, optional
        Where iterations and preconditioners are counted.
    """

    exact = False

    def __init__(
        self,
        space: TaylorHood,
        constraints: NodeConstraints,
        pinned: tuple[int, ...],
        places: Array,
        lengths: Array,
        tolerance: float,
        counts: Counts | None = None,
    ) -> None:
        super().__init__(space.dofs, space.boundary, space.size, constraints, pinned, places)
        self.tolerance = tolerance
        self.counts = Counts() if counts is None else counts
        self._parts = space, constraints, pinned, places, lengths
        self._cycle: Solver | None = None
        self._cycle_of: object = None
        self._taken: list[int] = []  # iterations of the solutions with it

    @cached_property
    def levels(self) -> tuple[GridLevel, ...]:
        """The mesh and coarser ones, made for the first factorisation."""
        return grid_levels(*self._parts)

    def prepare(self) -> None:
        """Make the coarser meshes and all patterns."""
        for level in self.levels[:-1]:
            _ = level.system.pattern
        self.levels[-1].system.prepare()

    def factorise(self, A: ElementMatrices, *, tolerance: float | None = None) -> CondensedFactor:
        """Condense element matrices and prepare their solution.

        Parameters
        ----------
        A : ndarray, shape (e, k, k), or callable
            Kept, not copied.
        tolerance : float, optional
            If the residual need not be smaller; by default that of the system.
        """
        if self.levels[0].transfer is None:
            return super().factorise(A)
        condensed = self.condensed(A)
        tolerance = max(self.tolerance, tolerance or 0.0)
        return CondensedFactor(self, condensed, _Iteration(self, A, condensed.S, tolerance))

    def preconditioner(self, A: ElementMatrices, S: Array, *, renew: bool = False) -> tuple[Solver, bool]:
        """The preconditioner that is kept, or a new one; and which it is."""
        if self._cycle is not None and not renew and self._pays():
            return self._cycle, False
        self._cycle = None
        self._cycle = GridCycle(self.levels, A, S)
        self._cycle_of, self._taken = origin_of(A), []
        self.counts.preconditioners += 1
        return self._cycle, True

    def memory(self) -> CycleMemory | None:
        """What the preconditioner at hand can be made again from; None if there is none."""
        if self._cycle is None or self._cycle_of is None:
            return None
        return CycleMemory(self._cycle_of, tuple(self._taken))

    def recall(self, memory: CycleMemory, A: ElementMatrices) -> None:
        """Make the preconditioner of a memory again, from its matrices."""
        self.preconditioner(A, self.condensed(A).S, renew=True)
        self._taken = list(memory.taken)

    @property
    def patience(self) -> int:
        """Iterations that a preconditioner of another matrix may take: more cost more than a new one."""
        return (self._taken[0] if self._taken else 0) + 2 * _SETUP

    def _pays(self) -> bool:
        """Whether the preconditioner that is kept is worth more than a new one."""
        if not self._taken:
            return True
        beyond = np.maximum(0, np.array(self._taken) - self._taken[0])
        return bool(beyond[-1] <= (_SETUP + beyond.sum()) / len(beyond))

    def count(self, iterations: int) -> None:
        """Remember how many iterations a solution took."""
        self.counts.linear_iterations += iterations
        self._taken.append(iterations)


class _Iteration:
    """Solves with one condensed matrix.

    Attributes
    ----------
    iterations : int
        Of the last solution.
    """

    def __init__(self, system: SaddlePointSystem, A: ElementMatrices, S: Array, tolerance: float) -> None:
        self._system, self._A, self._S, self._tolerance = system, A, S, tolerance
        self.iterations = 0

    def solve(self, b: Array, /) -> Array:
        """Solve S x = b.

        Raises
        ------
        LinearSolverError
            If the tolerance is not reached.
        """
        cycle, new = self._system.preconditioner(self._A, self._S)
        if not new:
            try:
                return self._solved(b, cycle, restart=self._system.patience, cycles=1)
            except LinearSolverError as error:
                if error.reason != "max_iterations":
                    raise
                del cycle  # its memory is free before the new one needs some
                cycle, _ = self._system.preconditioner(self._A, self._S, renew=True)
        return self._solved(b, cycle)

    def _solved(self, b: Array, cycle: Solver, **limits: int) -> Array:
        system = self._system
        x, self.iterations = flexible_gmres(self._product, cycle.solve, b, self._tolerance, **limits)
        system.count(self.iterations)
        return x

    def _product(self, x: Array) -> Array:
        """S x, element by element."""
        skeleton = self._system.skeleton
        local = np.append(x, 0.0)[skeleton]  # number -1 reads the zero
        return assemble_vector(skeleton, (self._S @ local[:, :, None])[:, :, 0], len(x))
