"""Which vertices of a block structure are driven, free and fixed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import MoverError

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["VertexRoles"]


@dataclass(frozen=True, eq=False)
class VertexRoles:
    """Driven vertices follow given positions, boundary vertices that are not driven stay, the rest is free.

    Attributes
    ----------
    reference : ndarray, shape (n, 2)
    names : tuple of str
    driven, free : ndarray
        Ascending.
    """

    reference: Array
    names: tuple[str, ...]
    driven: Index
    free: Index

    @staticmethod
    def of(structure: BlockStructure, driven: Index) -> VertexRoles:
        """Sort the vertices of a structure by what happens to them.

        Raises
        ------
        MoverError
            If ``driven`` is not an ascending list of vertices of the structure.
        """
        count = len(structure.vertices)
        driven = np.array(driven)
        if driven.ndim != 1 or (driven.size and not np.issubdtype(driven.dtype, np.integer)):
            raise MoverError(
                f"driven: array of shape {driven.shape} and type {driven.dtype}; expected the numbers of "
                "vertices, shape (k,), integers."
            )
        driven = driven.astype(np.int64)
        if driven.size and (driven[0] < 0 or driven[-1] >= count or (np.diff(driven) <= 0).any()):
            raise MoverError(
                f"driven: {driven.tolist()}; expected ascending vertex numbers from 0 to {count - 1}, "
                "each once. Use np.unique."
            )
        topology = structure.topology
        free = np.setdiff1d(np.arange(count), np.union1d(topology.boundary_vertices, driven))
        for array in (driven, free):
            array.setflags(write=False)
        return VertexRoles(structure.vertices, topology.vertex_names, driven, free)

    def checked(self, array: Array, name: str, vertices: Index) -> Array:
        """Return an argument as positions of some vertices, or raise MoverError."""
        array = np.asarray(array, dtype=float)
        if array.shape != (len(vertices), 2):
            raise MoverError(f"move: {name} has shape {array.shape}; expected {(len(vertices), 2)}.")
        finite = np.isfinite(array).all(axis=1)
        if not finite.all():
            k = int(np.argmin(finite))
            raise MoverError(
                f"move: {name}[{k}], vertex '{self.names[vertices[k]]}', is {array[k].tolist()}; expected "
                "finite coordinates. Check what drives it."
            )
        return array

    def assembled(self, driven: Array, free: Array) -> Array:
        """Positions of all vertices, shape (n, 2), from those of the driven and of the free ones."""
        vertices = self.reference.copy()
        vertices[self.driven], vertices[self.free] = driven, free
        return vertices
