"""What every mover offers."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hoblock.movers.sliding import Sliding

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Mover"]


class Mover(Protocol):
    """Places the vertices of a block structure that are not prescribed when others are driven.

    A mover holds no state: what it returns depends on its arguments alone, and a rejected step is the old state used
    again. It acts on vertices only and does not check the elements; `hoblock.motion.MeshMotion` makes the mesh, and
    certifies it.
    """

    @property
    def driven(self) -> Index:
        """Vertices whose positions are prescribed, ascending."""
        ...

    @property
    def free(self) -> Index:
        """Vertices the mover places, ascending: inside the structure, not driven, and within reach of those."""
        ...

    @property
    def paths(self) -> Sliding:
        """Vertices of the boundary that slide, with the paths they slide on."""
        ...

    @property
    def tangent_edges(self) -> Index:
        """Driven edges whose end tangents `move` takes into account."""
        ...

    @property
    def depends_on_state(self) -> bool:
        """Whether a move depends on the last state, not on the driven positions alone: such meshes drift."""
        ...

    def move(self, current: Array, positions: Array, tangents: Array | None = None) -> Array:
        """Return the vertices that belong to a position of the driven ones.

        Parameters
        ----------
        current : ndarray, shape (n, 2)
            Vertices of the last accepted state. Movers whose result depends on the driven positions alone ignore it, or
            use it as a start.
        positions : ndarray, shape (len(driven), 2)
            Positions of the driven vertices.
        tangents : ndarray, shape (len(tangent_edges), 2, 2), optional
            Unit end tangents of these edges, in their direction; without them they turn with the edges' chords.

        Returns
        -------
        ndarray, shape (n, 2)
            A new array. Vertices neither driven, free nor sliding are exactly those of the reference.

        Raises
        ------
        MoverError
            If a position is not finite, or the mover finds no place for the vertices.
        """
        ...
