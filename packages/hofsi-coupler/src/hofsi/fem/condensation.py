"""Static condensation: unknowns inside elements are eliminated, the rest is solved on the element boundaries."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from functools import cached_property, partial

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hofsi.fem.assembly import MatrixPattern, assemble_vector
from hofsi.fem.blocks import block_solver, joined
from hofsi.fem.boundary_unknowns import BoundaryUnknowns
from hofsi.fem.condensed_factor import CondensedFactor, CondensedMatrices
from hofsi.fem.constraints import NodeConstraints
from hofsi.fem.element_matrices import ElementMatrices, batches, maker
from hofsi.linear.checked import CheckedSolver
from hofsi.linear.direct import DirectFactor
from hofsi.linear.lagged import LaggedSolver
from hofsi.linear.multifrontal import EliminationTree, multifrontal_solver
from hofsi.linear.solver import Solver

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["CondensedSystem"]


class CondensedSystem(BoundaryUnknowns):
    """Pattern of condensed systems on the same elements and constraints.

    Parameters
    ----------
    dofs, boundary, size, constraints, pinned, copies, border
        As of `hofsi.fem.boundary_unknowns.BoundaryUnknowns`.
    places : ndarray, shape (e, 2), optional
        Where the elements are: condensed matrices are then factorised front by front (see
        `hofsi.linear.multifrontal`), without places by SuperLU.

    Attributes
    ----------
    exact : bool
        Whether factors solve exactly, so that they can serve another matrix as preconditioner.
    origin : object
        What the pattern was made from, for its owner.
    """

    exact = True

    def __init__(
        self,
        dofs: Index,
        boundary: int,
        size: int,
        constraints: NodeConstraints,
        pinned: tuple[int, ...] = (),
        places: Array | None = None,
        copies: Index | None = None,
        border: Sequence[int] | Index = (),
    ) -> None:
        super().__init__(dofs, boundary, size, constraints, pinned, copies, border)
        self.origin: object = None
        self._solver: Callable[[sp.csc_matrix], Solver] = DirectFactor
        self._places = places

    @cached_property
    def pattern(self) -> MatrixPattern:
        """Pattern of condensed matrices, made when one is asked for."""
        return MatrixPattern(self.skeleton, len(self.unknowns))

    def tells_flexibility(self, unknowns: Index) -> bool:
        """Whether factors have `CondensedFactor.flexibility`: direct ones, where no node has a frame of its own."""
        return self._solver is DirectFactor and not self.turned(unknowns)

    def solved_by(self, solver: Callable[[sp.csc_matrix], Solver]) -> CondensedSystem:
        """Return the same pattern with another solver of condensed matrices."""
        other = copy(self)
        for name in ("_tree", "_tree_with_border"):
            other.__dict__.pop(name, None)
        other._solver, other._places = solver, None
        return other

    def prepare(self) -> None:
        """Make what can be known before the numbers, which the first factorisation would otherwise make."""
        _ = self.pattern if self._tree is None else self._tree

    def factorise(self, A: ElementMatrices, *, tolerance: float | None = None) -> CondensedFactor:
        """Condense and factorise element matrices.

        Parameters
        ----------
        A : ndarray, shape (e, k, k), or callable
            All of them, or what makes some.
        tolerance : float, optional
            For iterative solvers: a residual, relative to the right-hand side, that is small enough.
        """
        return self._solved(A, self._factorised)

    def factorise_with_border(self, A: ElementMatrices) -> CondensedFactor:
        """The same, but so that the effect of the border is known: see `CondensedFactor.border_response`.

        The border's unknowns are carried along to the end of the elimination, which costs about a tenth more.
        """
        tree = self._tree_with_border
        if tree is None or not self.border.size:
            return self.factorise(A)
        return self._solved(A, lambda S: multifrontal_solver(tree, S, lambda: self.pattern.matrix(S)))

    def lagged(self, A: ElementMatrices, factor: CheckedSolver, goal: float, limit: int) -> CondensedFactor:
        """Condense element matrices and solve with the factors of an earlier condensed matrix.

        Parameters
        ----------
        A : ndarray, shape (e, k, k), or callable
        factor : CheckedSolver
            ``factor`` of a `CondensedFactor` of the same unknowns.
        goal, limit
            Norm of the residual, the same in the condensed and in the full system, and iterations; see
            `hofsi.linear.lagged.LaggedSolver`, which becomes the ``factor`` of the result.
        """

        def solver(S: Array) -> LaggedSolver:
            return LaggedSolver(partial(self._product, S), factor, partial(self._exact, S), goal, limit)

        return self._solved(A, solver)

    def _exact(self, S: Array) -> CheckedSolver:
        """Factors of condensed element matrices."""
        if self._tree is None:
            return DirectFactor(self.pattern.matrix(S))
        return multifrontal_solver(self._tree, S, lambda: self.pattern.matrix(S))

    def _solved(self, A: ElementMatrices, solver: Callable[[Array], Solver]) -> CondensedFactor:
        """Condense, and let a solver of condensed element matrices do the rest."""
        condensed = self.condensed(A)
        return CondensedFactor(self, condensed, solver(condensed.S))

    def _product(self, S: Array, x: Array) -> Array:
        """Condensed element matrices times a vector of the free unknowns."""
        local = np.append(x, 0.0)[self.skeleton]  # number -1 reads the zero of a constrained unknown
        return assemble_vector(self.skeleton, (S @ local[:, :, None])[:, :, 0], len(x))

    def _factorised(self, S: Array) -> Solver:
        """What solves with condensed element matrices (e, boundary, boundary)."""
        return self._exact(S) if self._solver is DirectFactor else self._solver(self.pattern.matrix(S))

    @cached_property
    def _tree(self) -> EliminationTree | None:
        """Fronts of the elements, made for the first factorisation."""
        if self._places is None:
            return None
        return EliminationTree(self.skeleton, len(self.unknowns), self._places)

    @cached_property
    def _tree_with_border(self) -> EliminationTree | None:
        """The same with the border's unknowns, which come last and are kept."""
        if self._places is None or self._solver is not DirectFactor:
            return None
        kept = len(self.border)
        return EliminationTree(self.with_border, len(self.unknowns) + kept, self._places, kept=kept)

    def matrix(self, A: ElementMatrices) -> sp.csc_matrix:
        """Return the condensed matrix of element matrices (e, k, k), in the nodes' own frames."""
        return self.pattern.matrix(self.condensed(A).S)

    def condensed(self, A: ElementMatrices) -> CondensedMatrices:
        """Condense element matrices, all of them (e, k, k) or what makes some, batch by batch."""
        count, width, b, make = len(self.dofs), self.dofs.shape[1], self.boundary, maker(A)
        S, coupling = np.empty((count, b, b)), np.empty((count, b, self.inner))
        X = np.empty((count, self.inner, b))
        solvers = []
        for batch in batches(count, width):
            part = make(batch)
            S[batch] = part[:, :b, :b]
            if self.inner:
                coupling[batch] = part[:, :b, b:]
                solvers.append(block_solver(part[:, b:, b:]))
                X[batch] = solvers[-1].solve(part[:, b:, :b])
                S[batch] -= coupling[batch] @ X[batch]
        if self.rotated.size:
            S[self.rotated] = self.rotation.transpose(0, 2, 1) @ S[self.rotated] @ self.rotation
        return CondensedMatrices(S, coupling, joined(solvers) if solvers else None, X)
