"""Static condensation: unknowns inside elements are eliminated, the rest is solved on the element boundaries."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hofsi.fem.assembly import MatrixPattern, assemble_vector
from hofsi.fem.blocks import BlockSolver, block_solver, joined
from hofsi.fem.constraints import NodeConstraints
from hofsi.fem.element_matrices import ElementMatrices, batches, maker
from hofsi.linear.checked import CheckedSolver
from hofsi.linear.direct import DirectFactor
from hofsi.linear.lagged import LaggedSolver
from hofsi.linear.multifrontal import EliminationTree, MultifrontalFactor, multifrontal_solver
from hofsi.linear.solver import Solver

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["CondensedFactor", "CondensedMatrices", "CondensedSystem"]


@dataclass(frozen=True, eq=False)
class CondensedMatrices:
    """Element matrices without their inner unknowns, and what finds these again.

    Attributes
    ----------
    S : ndarray, shape (e, boundary, boundary)
        In the nodes' own frames.
    coupling : ndarray, shape (e, boundary, inner)
        The blocks beside those of the inner unknowns.
    inner : BlockSolver or None
        Solves with the matrices of the inner unknowns; None if there are none.
    X : ndarray, shape (e, inner, boundary)
        Its solutions for the blocks below.
    """

    S: Array
    coupling: Array
    inner: BlockSolver | None
    X: Array


class CondensedSystem:
    """Pattern of condensed systems on the same elements and constraints.

    Parameters
    ----------
    dofs : ndarray, shape (e, k)
        Global numbers of the local unknowns of each element; those on the element's boundary first. Unknowns of a
        vector field come first: node n has 2n and 2n + 1.
    boundary : int
        How many local unknowns lie on the element's boundary.
    size : int
        Number of global unknowns.
    constraints : NodeConstraints
        Of the vector field.
    pinned : sequence of int
        Further unknowns that are held fixed, for example one pressure of an enclosed flow.
    places : ndarray, shape (e, 2), optional
        Where the elements are: condensed matrices are then factorised front by front (see
        `hofsi.linear.multifrontal`), without places by SuperLU.
    copies : ndarray, shape (c, 2), optional
        Unknowns of no element, and those whose values they get in a solution.
    border : sequence of int
        Constrained unknowns of the vector field, both of each node, whose effect on all others can be asked for.

    Attributes
    ----------
    unknowns : ndarray
        Free unknowns on the elements' boundaries, in global numbers.
    skeleton : ndarray, shape (e, boundary)
        Numbers of these of each element, among ``unknowns``; -1 where constrained.
    with_border : ndarray, shape (e, boundary)
        The same, but the border's unknowns numbered in their order after all others.
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
        self.border = np.asarray(border, dtype=np.int64)
        self.dofs, self.boundary, self.size = dofs, boundary, size
        self.origin: object = None
        self.copies = copies
        self._solver: Callable[[sp.csc_matrix], Solver] = DirectFactor
        self._places = places
        self.inner = dofs.shape[1] - boundary
        free = np.zeros(size, dtype=bool)
        free[dofs[:, :boundary]] = True
        vector = constraints.fixed.size
        free[:vector] &= ~constraints.fixed.ravel()
        free[list(pinned)] = False
        self.unknowns = np.flatnonzero(free)
        number = np.full(size, -1)
        number[self.unknowns] = np.arange(len(self.unknowns))
        self.skeleton = number[dofs[:, :boundary]]
        number[self.border] = len(self.unknowns) + np.arange(len(self.border))
        self.with_border = number[dofs[:, :boundary]]
        self._rotated, self._rotation = self._rotations(constraints)
        self._turned_nodes = constraints.rotated

    @cached_property
    def pattern(self) -> MatrixPattern:
        """Pattern of condensed matrices, made when one is asked for."""
        return MatrixPattern(self.skeleton, len(self.unknowns))

    def _rotations(self, constraints: NodeConstraints) -> tuple[Index, Array]:
        """Elements with nodes in a frame of their own, and their local rotation matrices."""
        if not constraints.rotated.size:
            return np.zeros(0, dtype=np.int64), np.zeros((0, 0, 0))
        dofs = self.dofs[:, : self.boundary]
        vector = dofs < constraints.fixed.size
        nodes = np.where(vector, dofs // 2, 0)
        turned = vector & np.isin(nodes, constraints.rotated)
        elements = np.flatnonzero(turned.any(axis=1))
        R = np.zeros((len(elements), self.boundary, self.boundary))
        R[:, np.arange(self.boundary), np.arange(self.boundary)] = 1.0
        # In ascending order x and y of a node follow each other; where an element has a node twice, by periodic sides,
        # both x come first, then both y.
        order = np.argsort(dofs[elements], axis=1, kind="stable")
        row, column = np.nonzero(np.take_along_axis(turned[elements], order, axis=1))
        local = order[row, column]
        is_x = dofs[elements][row, local] % 2 == 0
        pair, row = (local[is_x], local[~is_x]), row[is_x]
        frames = constraints.frames[nodes[elements][row, pair[0]]]
        for a in range(2):
            for b in range(2):
                R[row, pair[a], pair[b]] = frames[:, a, b]
        return elements, R

    def tells_flexibility(self, unknowns: Index) -> bool:
        """Whether factors have `CondensedFactor.flexibility`: direct ones, where no node has a frame of its own."""
        return self._solver is DirectFactor and not np.isin(unknowns // 2, self._turned_nodes).any()

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
        if self._rotated.size:
            S[self._rotated] = self._rotation.transpose(0, 2, 1) @ S[self._rotated] @ self._rotation
        return CondensedMatrices(S, coupling, joined(solvers) if solvers else None, X)

    def rotate_back(self, x: Array) -> Array:
        """Element vectors (e, boundary) from the nodes' own frames to x and y."""
        if self._rotated.size:
            x[self._rotated] = (self._rotation @ x[self._rotated][:, :, None])[:, :, 0]
        return x

    def rotate(self, r: Array) -> Array:
        """Element vectors (e, boundary) from x and y to the nodes' own frames."""
        if self._rotated.size:
            r[self._rotated] = (self._rotation.transpose(0, 2, 1) @ r[self._rotated][:, :, None])[:, :, 0]
        return r


class CondensedFactor:
    """A factorised condensed system; made by `CondensedSystem.factorise`."""

    def __init__(self, system: CondensedSystem, condensed: CondensedMatrices, factor: Solver) -> None:
        self.system, self.factor = system, factor
        self._condensed = condensed
        self._flexibility: tuple[Index, Array] | None = None

    def solve(self, r: Array) -> Array:
        """Solve for all unknowns.

        Parameters
        ----------
        r : ndarray, shape (e, k)
            Right-hand side, element by element.

        Returns
        -------
        ndarray, shape (size,)
            In x and y components; zero where constrained.
        """
        loads, z = self._condensed_loads(r)
        x_b = self._solved(loads)
        return self._everywhere(self.system.rotate_back(x_b), z)

    def solve_and_balance(self, r: Array) -> tuple[Array, Array]:
        """The same, and what the solution leaves of the right-hand side, r - A x of each element, shape (e, k).

        As far as the factors are exact: that of the inner unknowns is taken to be zero.
        """
        loads, z = self._condensed_loads(r)
        x_b = self._solved(loads)
        left = np.zeros_like(r)
        on_boundary = loads - (self._condensed.S @ x_b[:, :, None])[:, :, 0]
        left[:, : self.system.boundary] = self.system.rotate_back(on_boundary)
        return self._everywhere(self.system.rotate_back(x_b), z), left

    def _condensed_loads(self, r: Array) -> tuple[Array, Array | None]:
        """Loads (e, boundary) without the inner unknowns, in the nodes' own frames, and what they do to these."""
        b, parts = self.system.boundary, self._condensed
        on_boundary = r[:, :b].copy()
        z = None
        if parts.inner is not None:
            z = parts.inner.solve(r[:, b:, None])[:, :, 0]
            on_boundary -= (parts.coupling @ z[:, :, None])[:, :, 0]
        return self.system.rotate(on_boundary), z

    def _solved(self, loads: Array) -> Array:
        """Unknowns (e, boundary) for condensed loads, both in the nodes' own frames."""
        skeleton = self.system.skeleton
        solution = self.factor.solve(assemble_vector(skeleton, loads, len(self.system.unknowns)))
        return np.asarray(np.append(solution, 0.0)[skeleton])  # number -1 reads the zero of a constrained unknown

    def flexibility(self, unknowns: Index) -> Array:
        """What loads on some unknowns do to these unknowns, shape (k, k): their part of the inverse.

        Only where the system has it, see `CondensedSystem.tells_flexibility`.

        Parameters
        ----------
        unknowns : ndarray, shape (k,)
            Global numbers, on the elements' boundaries. Constrained ones do not move.
        """
        kept = self._flexibility
        if kept is None or not np.array_equal(kept[0], unknowns):
            kept = self._flexibility = unknowns, self._inverse_at(unknowns)
        return kept[1]

    def _inverse_at(self, unknowns: Index) -> Array:
        system = self.system
        assert isinstance(self.factor, CheckedSolver)
        place = np.searchsorted(system.unknowns, unknowns)
        free = place < len(system.unknowns)
        free[free] = system.unknowns[place[free]] == unknowns[free]
        own, k = place[free], np.flatnonzero(free)
        loads = np.zeros((len(system.unknowns), len(own)))
        loads[own, np.arange(len(own))] = 1.0
        self.factor.solve(loads.sum(axis=1))  # with a look at the residual: poor factors are replaced
        result = np.zeros((len(unknowns), len(unknowns)))
        result[np.ix_(k, k)] = self.factor.substitute(loads)[own]
        return result

    @property
    def border_response(self) -> Array | None:
        """Matrix (k, k) that makes of the border's unknowns their own rows of A x, while all other rows are zero.

        None if the factors do not have it.
        """
        factors = self.factor.factor if isinstance(self.factor, CheckedSolver) else None
        has_it = isinstance(factors, MultifrontalFactor) and len(factors.complement)
        return factors.complement if has_it and isinstance(factors, MultifrontalFactor) else None

    def extended(self, border: Array) -> Array:
        """All unknowns, shape (size,), for those of the border (k,), while all other rows of A x are zero.

        Only for factors that have `border_response`.
        """
        assert isinstance(self.factor, CheckedSolver)
        assert isinstance(self.factor.factor, MultifrontalFactor)
        padded = np.append(self.factor.factor.extended(border), 0.0)
        return self._everywhere(self.system.rotate_back(padded[self.system.with_border]), None)

    def _everywhere(self, x_b: Array, z: Array | None) -> Array:
        """All unknowns from those on the elements' boundaries (e, boundary), and what loads do to the others."""
        system = self.system
        b = system.boundary
        x = np.zeros(system.size)
        x[system.dofs[:, :b]] = x_b
        if system.inner:
            inner = (self._condensed.X @ x_b[:, :, None])[:, :, 0]
            x[system.dofs[:, b:]] = -inner if z is None else z - inner
        if system.copies is not None:
            x[system.copies[:, 0]] = x[system.copies[:, 1]]
        return x
