"""Multiplicative Schwarz sweeps: the unknowns of one patch after the other are solved for together."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hofsi.errors import LinearSolverError
from hofsi.linear.extra import pyamg_module

__all__ = ["PatchSmoother"]

Array = NDArray[np.float64]
Values: TypeAlias = NDArray[np.floating[Any]]

_AT_ONCE = 2_000_000  # entries of patch matrices that are inverted together
_SINGULAR = 1e12  # condition above which a patch is solved in the sense of least squares
_CUT = 1e-10  # singular values, relative to the largest, that are left out then


class PatchSmoother:
    """Gauss–Seidel by blocks that may overlap, with the kernels of pyamg.

    Parameters
    ----------
    matrix : csr_matrix, shape (n, n)
    patches : csr_matrix, shape (k, n)
        The entries of a row are the unknowns of one patch; a row without any is skipped.
    precision : dtype, optional
        In which the matrix, the inverses and the sweeps are. Single precision needs half the memory, and as a
        preconditioner serves as well.
    pseudo : bool, optional
        Whether a patch whose matrix is singular may be solved in the sense of least squares.

    Raises
    ------
    LinearSolverError
        If the matrix of a patch is singular and must not be.
    MissingExtraError
        If pyamg is not installed.

    References
    ----------
    Vanka, J. Comput. Phys. 65 (1986) 138–158, doi:10.1016/0021-9991(86)90008-2 (patches of a saddle-point problem).
    """

    def __init__(
        self,
        matrix: sp.csr_matrix,
        patches: sp.csr_matrix,
        *,
        precision: type[np.floating[Any]] = np.float64,
        pseudo: bool = False,
    ) -> None:
        self._kernels: Any = pyamg_module("pyamg.amg_core")
        matrix.sort_indices()
        patches = patches.sorted_indices()
        sizes = np.diff(patches.indptr)
        sizes = sizes[sizes > 0]
        self._unknowns = patches.indices.astype(np.int32)
        self._starts = np.concatenate(([0], np.cumsum(sizes))).astype(np.int32)
        block_starts = np.concatenate(([0], np.cumsum(sizes.astype(np.int64) ** 2)))
        if block_starts[-1] >= 2**31:
            raise LinearSolverError(
                f"the patches of multigrid have {block_starts[-1]} entries; its kernels can number {2**31}. "
                'Use linear.solver = "direct" or a coarser mesh.'
            )
        self._block_starts = block_starts.astype(np.int32)
        self._inverses = np.empty(int(block_starts[-1]), dtype=precision)
        self._invert(matrix, pseudo)
        self._A = sp.csr_matrix((matrix.data.astype(precision), matrix.indices, matrix.indptr), shape=matrix.shape)

    def _invert(self, matrix: sp.csr_matrix, pseudo: bool) -> None:
        """Inverses of the patch matrices, some patches at a time."""
        starts, blocks = self._starts, self._block_starts
        first = 0
        while first < len(starts) - 1:
            last = max(first + 1, int(np.searchsorted(blocks, blocks[first] + _AT_ONCE, side="right")) - 1)
            own = (blocks[first : last + 1] - blocks[first]).astype(np.int32)
            members = self._unknowns[starts[first] : starts[last]]
            entries = np.zeros(int(own[-1]))
            self._kernels.extract_subblocks(
                matrix.indptr,
                matrix.indices,
                matrix.data,
                entries,
                own,
                members,
                (starts[first : last + 1] - starts[first]).astype(np.int32),
                last - first,
                matrix.shape[0],
            )
            sizes = np.diff(starts[first : last + 1])
            for size in np.unique(sizes):
                places = own[:-1][sizes == size][:, None] + np.arange(size * size)
                found = _inverses(entries[places].reshape(-1, size, size), pseudo)
                self._inverses[blocks[first] + places] = found.reshape(places.shape)
            first = last

    def residual(self, x: Values, b: Values) -> Values:
        """b - A x."""
        return np.asarray(b - self._A @ x)

    def sweep(self, x: Values, b: Values, *, backward: bool = False) -> None:
        """One sweep over all patches, in their order or backwards.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Improved in place.
        b : ndarray, shape (n,)
            Both in the precision of the smoother.
        backward : bool
        """
        count = len(self._starts) - 1
        self._kernels.overlapping_schwarz_csr(
            self._A.indptr,
            self._A.indices,
            self._A.data,
            x,
            b,
            self._inverses,
            self._block_starts,
            self._unknowns,
            self._starts,
            count,
            self._A.shape[0],
            *((count - 1, -1, -1) if backward else (0, count, 1)),
        )


def _inverses(blocks: Array, pseudo: bool) -> Array:
    """Inverses of matrices (k, n, n); of singular ones, if they may be, the pseudo-inverses."""
    try:
        inverses = np.linalg.inv(blocks)
    except np.linalg.LinAlgError as error:
        if not pseudo:
            raise LinearSolverError(
                f"the matrix of a patch of {blocks.shape[-1]} unknowns is singular; multigrid needs a regular "
                'one. Use linear.solver = "direct".',
                "singular",
            ) from error
        return np.asarray(np.linalg.pinv(blocks, rcond=_CUT), dtype=np.float64)
    if pseudo:
        condition = np.abs(blocks).sum(axis=2).max(axis=1) * np.abs(inverses).sum(axis=2).max(axis=1)
        poor = ~(condition < _SINGULAR)
        if poor.any():
            inverses[poor] = np.linalg.pinv(blocks[poor], rcond=_CUT)
    return np.asarray(inverses)
