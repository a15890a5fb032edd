"""A factorised system without the unknowns inside elements, and what it tells of these."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.fem.assembly import assemble_vector
from hofsi.fem.blocks import BlockSolver
from hofsi.fem.boundary_unknowns import BoundaryUnknowns
from hofsi.linear.checked import CheckedSolver
from hofsi.linear.multifrontal import MultifrontalFactor
from hofsi.linear.solver import Solver

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["CondensedFactor", "CondensedMatrices"]


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


class CondensedFactor:
    """A factorised condensed system; made by `hofsi.fem.condensation.CondensedSystem.factorise`."""

    def __init__(self, system: BoundaryUnknowns, condensed: CondensedMatrices, factor: Solver) -> None:
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

        Only where the system has it, see `hofsi.fem.condensation.CondensedSystem.tells_flexibility`.

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
