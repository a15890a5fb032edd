"""What every mover offers."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Mover"]


class Mover(Protocol):
    """Places the free vertices of a block structure when others are driven.

    A mover holds no state: what it returns depends on its arguments alone, and a rejected step is the old state used
    again. It acts on vertices only and does not check the elements; that is left to whoever generates the mesh.
    """

    @property
    def driven(self) -> Index:
        """Vertices whose positions are prescribed, ascending."""
        ...

    @property
    def free(self) -> Index:
        """Vertices the mover places, ascending: inside the structure and not driven."""
        ...

    def move(self, current: Array, positions: Array) -> Array:
        """Return the vertices that belong to a position of the driven ones.

        Parameters
        ----------
        current : ndarray, shape (n, 2)
            Vertices of the last accepted state. Movers whose result depends on the driven positions alone ignore it.
        positions : ndarray, shape (len(driven), 2)
            Positions of the driven vertices.

        Returns
        -------
        ndarray, shape (n, 2)
            A new array. Vertices neither driven nor free are exactly those of the reference.

        Raises
        ------
        MoverError
            If a position is not finite.
        """
        ...
