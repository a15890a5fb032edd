"""Sums of element contributions into global vectors and sparse matrices, with patterns made once."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["MatrixPattern", "assemble_vector"]


def assemble_vector(dofs: Index, values: Array, size: int) -> Array:
    """Sum element vectors (e, k) into a vector; entries with a negative number are dropped.

    Parameters
    ----------
    dofs : ndarray, shape (e, k)
    values : ndarray, shape (e, k)
    size : int
    """
    return np.asarray(np.bincount(dofs.ravel() + 1, weights=values.ravel(), minlength=size + 1)[1:], dtype=float)


class MatrixPattern:
    """Sparsity pattern of element matrices on the same degrees of freedom, and where each entry goes.

    Parameters
    ----------
    dofs : ndarray, shape (e, k)
        Row and column numbers; negative ones are dropped.
    size : int
        Number of rows.
    """

    def __init__(self, dofs: Index, size: int) -> None:
        self.size = size
        rows = np.broadcast_to(dofs[:, :, None], (*dofs.shape, dofs.shape[1]))
        columns = np.broadcast_to(dofs[:, None, :], rows.shape)
        keep = (rows >= 0) & (columns >= 0)
        keys = np.where(keep, columns.astype(np.int64) * size + rows, -1).ravel()
        unique, slot = np.unique(keys, return_inverse=True)
        self._dropped = int(len(unique) > 0 and unique[0] < 0)
        unique = unique[self._dropped :]
        self._slot = slot.astype(np.int32 if len(unique) < 2**31 - 2 else np.int64)
        self.indices = (unique % size).astype(np.int32)
        counts = np.bincount(unique // size, minlength=size)
        self.indptr = np.concatenate(([0], np.cumsum(counts))).astype(np.int32)

    def matrix(self, values: Array) -> sp.csc_matrix:
        """Sum element matrices (e, k, k) into a matrix in compressed columns."""
        data = np.bincount(self._slot, weights=values.ravel(), minlength=len(self.indices) + self._dropped)
        return sp.csc_matrix((data[self._dropped :], self.indices, self.indptr), shape=(self.size, self.size))
