"""Which vertices of a block structure are driven, free, sliding and fixed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import MoverError
from hoblock.movers.sliding import Sliding
from hoblock.topology import BlockTopology, connected

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["VertexRoles"]


@dataclass(frozen=True, eq=False)
class VertexRoles:
    """What happens to each vertex.

    Driven vertices follow given positions; sliding ones are on the boundary and move along it; free ones are inside.
    Free and sliding vertices that no chain of blocks with such vertices joins to a driven one cannot be moved by it:
    they are fixed, as is the rest of the boundary. (If nothing is driven, all are free: a mover then only smooths.)

    Attributes
    ----------
    reference : ndarray, shape (n, 2)
    names : tuple of str
    driven, free : ndarray
        Ascending.
    sliding : Sliding
    """

    reference: Array
    names: tuple[str, ...]
    driven: Index
    free: Index
    sliding: Sliding

    @staticmethod
    def of(structure: BlockStructure, driven: Index, sliding: ArrayLike | None = None) -> VertexRoles:
        """Sort the vertices of a structure by what happens to them.

        Raises
        ------
        MoverError
            If ``driven`` or ``sliding`` is not an ascending list of vertices of the structure, or a sliding vertex is
            not where it can slide.
        """
        count = len(structure.vertices)
        driven = _checked_vertices(driven, count, "driven")
        slides = _checked_vertices(np.zeros(0, dtype=np.int64) if sliding is None else sliding, count, "sliding")
        topology = structure.topology
        every = Sliding.of(structure, slides, driven)  # checks also those that nothing reaches
        inside = np.setdiff1d(np.arange(count), np.union1d(topology.boundary_vertices, driven))
        reached = _reached(topology, driven, np.union1d(inside, slides))
        free = inside[reached[inside]]
        some = slides[reached[slides]]
        paths = every if len(some) == len(slides) else Sliding.of(structure, some, driven)
        for array in (driven, free):
            array.setflags(write=False)
        return VertexRoles(structure.vertices, topology.vertex_names, driven, free, paths)

    @property
    def movable(self) -> Index:
        """Free and sliding vertices, ascending."""
        return np.union1d(self.free, self.sliding.vertices)

    def checked(self, array: Array, name: str, vertices: Index) -> Array:
        """Return an argument as positions of some vertices, or raise MoverError."""
        array = np.asarray(array, dtype=float)
        if array.shape != (len(vertices), 2):
            raise MoverError(f"move: {name} has shape {array.shape}; expected {(len(vertices), 2)}.")
        if not np.isfinite(array).all():
            k = int(np.argmin(np.isfinite(array).all(axis=1)))
            raise MoverError(
                f"move: {name}[{k}], vertex '{self.names[vertices[k]]}', is {array[k].tolist()}; expected "
                "finite coordinates. Check what drives it."
            )
        return array

    def assembled(self, driven: Array, free: Array, along: Array | None = None) -> Array:
        """Positions of all vertices, shape (n, 2), from those of the driven and free ones.

        ``along`` are the coordinates of the sliding ones on their paths; by default those of the reference.
        """
        vertices = self.reference.copy()
        vertices[self.driven], vertices[self.free] = driven, free
        if along is not None and along.size:
            vertices[self.sliding.vertices] = self.sliding.positions(along)
        return vertices


def _checked_vertices(vertices: ArrayLike, count: int, name: str) -> Index:
    """Return an ascending list of vertices, or raise MoverError."""
    given = np.array(vertices)
    if given.ndim != 1 or (given.size and not np.issubdtype(given.dtype, np.integer)):
        raise MoverError(
            f"{name}: array of shape {given.shape} and type {given.dtype}; expected the numbers of "
            "vertices, shape (k,), integers."
        )
    numbers = given.astype(np.int64)
    if numbers.size and (numbers[0] < 0 or numbers[-1] >= count or (np.diff(numbers) <= 0).any()):
        raise MoverError(
            f"{name}: {numbers.tolist()}; expected ascending vertex numbers from 0 to {count - 1}, "
            "each once. Use np.unique."
        )
    return numbers


def _reached(topology: BlockTopology, driven: Index, movable: Index) -> NDArray[np.bool_]:
    """Vertices that blocks with movable corners join to a driven one, shape (n,); all if none is driven."""
    count = len(topology.vertex_names)
    if not driven.size:
        return np.ones(count, dtype=bool)
    moves = np.zeros(count, dtype=bool)
    moves[movable] = moves[driven] = True
    pairs = np.concatenate([topology.quads[:, [i, j]] for i in range(4) for j in range(i)])
    label = connected(count, pairs[moves[pairs].all(axis=1)])
    return np.asarray(np.isin(label, label[driven]))
