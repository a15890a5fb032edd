"""Linear systems of velocity and pressure that are solved iteratively, without a matrix of the whole."""

from __future__ import annotations

from functools import partial

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hofsi.fem.assembly import assemble_vector
from hofsi.fem.coarsening import scalar_coarsening, skeleton_coarsening
from hofsi.fem.condensation import CondensedFactor, CondensedSystem
from hofsi.fem.constraints import NodeConstraints
from hofsi.fem.spaces import TaylorHood
from hofsi.linear.amg import PatchMultigrid
from hofsi.linear.krylov import flexible_gmres
from hofsi.linear.schur import BlockTriangular, LeastSquaresCommutator, ScaledLaplacian

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["SaddlePointFactor", "SaddlePointSystem"]


class SaddlePointSystem:
    """Pattern of systems [[F, Bᵀ], [B, 0]] on the same elements and constraints, for FGMRES.

    The preconditioner is block-triangular. In its velocity block the unknowns inside elements are eliminated and those
    on the elements' boundaries go through one multigrid cycle: smoothed aggregation of F itself fails at high order.
    Its Schur complement is the mass-scaled least-squares commutator. Used like a `CondensedSystem`.

    Parameters
    ----------
    space : TaylorHood
    constraints : NodeConstraints
        Of the velocity.
    pinned : tuple of int
        Pressure unknowns that are held fixed, numbered as in the space.
    mass : ndarray, shape (velocity nodes,)
        Diagonal of the velocity's mass matrix; a scaling only, so one of another position of the mesh will do.
    tolerance : float
        Of the residual, relative to the right-hand side.

    Attributes
    ----------
    dofs, boundary, unknowns
        As in `CondensedSystem`.
    frames : csr_matrix, shape (all unknowns, free unknowns)
        From free unknowns, velocities first and in the nodes' own frames, to all in x and y.
    velocities : int
        How many free unknowns are velocities.
    velocity_dofs : ndarray, shape (e, 2n)
        Columns of ``dofs`` that are velocities, in the same order.
    """

    def __init__(
        self, space: TaylorHood, constraints: NodeConstraints, pinned: tuple[int, ...], mass: Array, tolerance: float
    ) -> None:
        self.space, self.tolerance = space, tolerance
        self.dofs, self.boundary = space.dofs, space.boundary
        n = 2 * space.velocity_count
        free = np.ones(space.size, dtype=bool)
        free[:n] = ~constraints.fixed.ravel()
        free[list(pinned)] = False
        self.unknowns = np.intersect1d(np.flatnonzero(free), self.dofs[:, : self.boundary])
        self.frames = _frames(constraints, free)
        self.velocities = int(np.count_nonzero(free[:n]))
        self.scaling = np.repeat(mass, 2)[free[:n]]
        local = np.arange(space.dofs.shape[1])
        self._pressure_rows = np.concatenate([local[part] for part in space.rows(2)])
        self._velocity_rows = np.concatenate([local[space.rows(a)[part]] for part in (0, 1) for a in (0, 1)])
        self.velocity_dofs = self.dofs[:, self._velocity_rows]
        on, order = space.velocity_boundary, space.velocity.order
        skeleton = CondensedSystem(self.velocity_dofs, 2 * on, n, constraints)
        coarsening = skeleton_coarsening(space.velocity_cells[:, :on], order, constraints, skeleton.unknowns)
        self._skeleton = skeleton.solved_by(partial(PatchMultigrid, coarsening=coarsening, symmetric=False))
        coarsening = scalar_coarsening(space.pressure_cells, order - 1, np.flatnonzero(free[n:]))
        self._pressure_multigrid = partial(PatchMultigrid, coarsening=coarsening, symmetric=True)
        self._laplacian: tuple[Array, ScaledLaplacian] | None = None

    def factorise(self, A: Array) -> SaddlePointFactor:
        """Prepare the solution of systems with element matrices A of shape (e, k, k), which are kept, not copied."""
        rows = self._velocity_rows
        velocity = self._skeleton.factorise(np.ascontiguousarray(A[:, rows[:, None], rows]))
        return SaddlePointFactor(self, A, velocity, self._pressure_laplacian(A))

    def _pressure_laplacian(self, A: Array) -> ScaledLaplacian:
        """Scaled Laplacian, kept while the divergence does not change."""
        rows = self._pressure_rows
        divergence = A[:, rows[:, None], self._velocity_rows]
        if self._laplacian is None or not np.array_equal(self._laplacian[0], divergence):
            i = np.broadcast_to(self.dofs[:, rows, None], divergence.shape).ravel()
            j = np.broadcast_to(self.velocity_dofs[:, None, :], divergence.shape).ravel()
            n = self.space.size
            B = self.frames.T @ sp.csr_matrix((divergence.ravel(), (i, j)), shape=(n, n)) @ self.frames
            B = B.tocsr()[self.velocities :, : self.velocities]
            self._laplacian = (divergence, ScaledLaplacian(B, self.scaling, self._pressure_multigrid))
        return self._laplacian[1]


class SaddlePointFactor:
    """A system that is ready to be solved; made by `SaddlePointSystem.factorise`.

    Attributes
    ----------
    iterations : int
        Of the last solution.
    """

    def __init__(
        self, system: SaddlePointSystem, A: Array, velocity: CondensedFactor, laplacian: ScaledLaplacian
    ) -> None:
        self.iterations = 0
        self._system, self._matrix = system, _Matrix(system, A)
        schur = LeastSquaresCommutator(self._matrix.velocity_product, laplacian)
        self._preconditioner = BlockTriangular(_Velocity(system, velocity), schur, laplacian.BT)

    def solve(self, r: Array, /) -> Array:
        """Solve for all unknowns.

        Parameters
        ----------
        r : ndarray, shape (e, k)
            Right-hand side, element by element.

        Returns
        -------
        ndarray, shape (size,)
            In x and y components; zero where constrained.

        Raises
        ------
        LinearSolverError
            If the tolerance is not reached.
        """
        system = self._system
        b = system.frames.T @ assemble_vector(system.dofs, r, system.space.size)
        x, self.iterations = flexible_gmres(self._matrix.product, self._preconditioner.solve, b, system.tolerance)
        return np.asarray(system.frames @ x)


class _Matrix:
    """The matrix of the free unknowns, velocities in their own frames; never assembled."""

    def __init__(self, system: SaddlePointSystem, A: Array) -> None:
        self._A, self._dofs, self._frames = A, system.dofs, system.frames
        self._back = system.frames.T.tocsr()

    def product(self, x: Array) -> Array:
        """A x."""
        local = (self._frames @ x)[self._dofs]
        products = (self._A @ local[:, :, None])[:, :, 0]
        return np.asarray(self._back @ assemble_vector(self._dofs, products, self._frames.shape[0]))

    def velocity_product(self, v: Array) -> Array:
        """F v."""
        x = np.zeros(self._frames.shape[1])
        x[: len(v)] = v
        return self.product(x)[: len(v)]


class _Velocity:
    """Approximate inverse of F on the free velocity unknowns, in the nodes' own frames."""

    def __init__(self, system: SaddlePointSystem, factor: CondensedFactor) -> None:
        n = 2 * system.space.velocity_count
        self._frames = system.frames[:n, : system.velocities]
        self._back = self._frames.T.tocsr()
        self._dofs, self._factor = system.velocity_dofs, factor
        self._share = 1.0 / np.maximum(np.bincount(self._dofs.ravel(), minlength=n), 1)

    def solve(self, r: Array, /) -> Array:
        """Approximate v in F v = r."""
        shared = (self._frames @ r) * self._share
        return np.asarray(self._back @ self._factor.solve(shared[self._dofs]))


def _frames(constraints: NodeConstraints, free: NDArray[np.bool_]) -> sp.csr_matrix:
    """Matrix from the free unknowns, velocities in their own frames, to all in x and y."""
    count = len(constraints.fixed)
    turned = sp.bsr_matrix((constraints.frames, np.arange(count), np.arange(count + 1)))
    T = sp.block_diag([turned, sp.identity(len(free) - 2 * count)], format="csr")[:, np.flatnonzero(free)]
    T.eliminate_zeros()
    return T
