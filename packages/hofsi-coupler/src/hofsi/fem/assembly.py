"""Sums of element contributions into global vectors and sparse matrices, with patterns made once."""

from __future__ import annotations

from typing import Any

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

    The pattern is symmetric, so that it serves compressed rows and columns alike.

    Parameters
    ----------
    dofs : ndarray, shape (e, k)
        Row and column numbers; negative ones are dropped.
    size : int
        Number of rows.
    """

    def __init__(self, dofs: Index, size: int) -> None:
        self.size = size
        k = dofs.shape[1]
        index: type[np.signedinteger[Any]] = np.int32 if dofs.size * k < 2**31 - 1 else np.int64
        numbers = np.where(dofs < 0, size, dofs).astype(index)  # one more column takes what is dropped
        lines = numbers.ravel()
        order = np.argsort(lines, kind="stable").astype(index)
        starts = np.concatenate(([0], np.cumsum(np.bincount(lines, minlength=size + 1) * k))).astype(index)
        # One line after the other, with repetitions; the values tell where in (e, line, other) an entry was.
        table = sp.csr_matrix(
            ((order[:, None] * k + np.arange(k, dtype=index)).ravel(), numbers[order // k].ravel(), starts),
            shape=(size + 1, size + 1),
        )
        table.sort_indices()
        stop = int(starts[size])
        found, place = table.indices[:stop], table.data
        kept = np.ones(stop, dtype=bool)
        kept[1:] = found[1:] != found[:-1]
        kept[starts[:size][np.diff(starts[: size + 1]) > 0]] = True
        kept &= found < size
        count = int(np.count_nonzero(kept))
        self._slot = np.full(len(place), count, dtype=index)
        inside = found < size
        self._slot[place[:stop][inside]] = (np.cumsum(kept, dtype=index) - 1)[inside]
        self.indices = found[kept].astype(np.int32)
        entries = np.concatenate(([0], np.cumsum(kept, dtype=np.int64)))
        self.indptr = entries[starts[: size + 1]].astype(np.int32)

    def matrix(self, values: Array) -> sp.csc_matrix:
        """Sum element matrices (e, k, k) into a matrix in compressed columns."""
        return sp.csc_matrix((self._sums(values.transpose(0, 2, 1)), self.indices, self.indptr), shape=(self.size,) * 2)

    def rows(self, values: Array) -> sp.csr_matrix:
        """Sum element matrices (e, k, k) into a matrix in compressed rows."""
        return sp.csr_matrix((self._sums(values), self.indices, self.indptr), shape=(self.size,) * 2)

    def _sums(self, values: Array) -> Array:
        sums = np.bincount(self._slot, weights=values.ravel(), minlength=len(self.indices) + 1)[:-1]
        return np.asarray(sums, dtype=np.float64)
