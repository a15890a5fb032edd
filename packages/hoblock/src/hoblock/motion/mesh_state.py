"""A position of a moving mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.mesh import QuadMesh

Array = NDArray[np.float64]

__all__ = ["MeshState"]

SNAP = 5.0
"""Amplification from which a motion is likely to have jumped to another branch of the mover's solutions."""


@dataclass(frozen=True, eq=False)
class MeshState:
    """A position of a moving mesh, certified.

    Attributes
    ----------
    mesh : QuadMesh
    vertices : ndarray, shape (n, 2)
        Block vertices.
    positions : ndarray, shape (k, 2)
        Driven nodes.
    min_det_J : float
        Certified lower bound of det J over all elements.
    regenerated : int
        Blocks whose nodes were generated anew, counted once for every mesh made on the way from the state before.
    substeps : int
        Parts in which the motion from the state before was made.
    amplification : float
        Largest way of a vertex that is placed, as a multiple of the largest way of a driven node, both from the state
        before. 1 to 3 in smooth motions; see `snapped`.
    structure_of : callable or None
        Makes the moved structure.
    """

    mesh: QuadMesh
    vertices: Array
    positions: Array
    min_det_J: float
    regenerated: int = 0
    substeps: int = 1
    amplification: float = 0.0
    structure_of: Callable[[], BlockStructure] | None = field(default=None, repr=False)

    @cached_property
    def structure(self) -> BlockStructure:
        """The moved block structure; made when it is asked for.

        Raises
        ------
        ValueError
            If the state was made without one.
        """
        if self.structure_of is None:
            raise ValueError("mesh state: it was made without a block structure.")
        return self.structure_of()

    @property
    def snapped(self) -> bool:
        """Whether the amplification is above 5: the mover has probably jumped to another mesh."""
        return self.amplification > SNAP
