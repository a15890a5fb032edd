"""Block vertices that follow a user's rule: the paper's empirical rules for moderate displacements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import MoverError
from hoblock.movers._roles import VertexRoles
from hoblock.movers.sliding import Sliding

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Rule"]


@dataclass(frozen=True, eq=False)
class Rule:
    """Free vertices go where a function says.

    Parameters
    ----------
    reference : BlockStructure
        The blocks that move (the fluid's alone).
    driven : ndarray of int
        Vertices whose positions are prescribed, ascending, on the boundary or inside.
    function : callable
        (displacement) → displacement: from that of the driven vertices, shape (len(driven), 2), to that of the free
        ones and, after them, the sliding ones, shape (len(free) + len(sliding), 2), all from the reference. Of a
        sliding vertex what matters is the place of the boundary that is closest to where it is sent.
    sliding : ndarray of int, optional
        Boundary vertices that slide along their part of the boundary, ascending.

    Attributes
    ----------
    free : ndarray of int
        Vertices inside that are placed, ascending.

    Examples
    --------
    Every free vertex moves as much as the mean of the driven ones:

    >>> def follow(displacement):
    ...     return np.tile(displacement.mean(axis=0), (len(free), 1))
    """

    reference: BlockStructure
    driven: Index
    function: Callable[[Array], Array]
    sliding: Index | None = field(default=None, kw_only=True)
    free: Index = field(init=False)
    _roles: VertexRoles = field(init=False, repr=False)

    def __post_init__(self) -> None:
        roles = VertexRoles.of(self.reference, self.driven, self.sliding)
        for name, value in (("driven", roles.driven), ("free", roles.free), ("_roles", roles)):
            object.__setattr__(self, name, value)

    @property
    def has_free_vertices(self) -> bool:
        """Whether there is a vertex to place; if not, a move only copies the driven positions."""
        return len(self._roles.movable) > 0

    @property
    def depends_on_state(self) -> bool:
        """Whether a move depends on the last state: no."""
        return False

    @property
    def paths(self) -> Sliding:
        """The sliding vertices with their paths."""
        return self._roles.sliding

    @property
    def tangent_edges(self) -> Index:
        """Edges whose end tangents a move takes into account: none."""
        return np.zeros(0, dtype=np.int64)

    def move(self, current: Array, positions: Array, tangents: Array | None = None) -> Array:
        """Return the vertices for a position of the driven ones; see `Mover.move`. The rest is ignored.

        Raises
        ------
        MoverError
            If a position is not finite, or the function returns something else than finite displacements.
        """
        roles = self._roles
        positions = roles.checked(positions, "positions", self.driven)
        start, slides = self.reference.vertices, roles.sliding.vertices
        free = len(self.free)
        if not free and not slides.size:
            return roles.assembled(positions, np.zeros((0, 2)))
        moved = np.asarray(self.function(positions - start[self.driven]), dtype=float)
        if moved.shape != (free + len(slides), 2):
            raise MoverError(
                f"rule: the function returned shape {moved.shape}; expected {(free + len(slides), 2)}, one "
                "displacement for each free vertex, then for each sliding one."
            )
        places = np.concatenate([self.free, slides])
        if not np.isfinite(moved).all():
            k = int(np.argmin(np.isfinite(moved).all(axis=1)))
            raise MoverError(
                f"rule: the function moves vertex '{roles.names[places[k]]}' by {moved[k].tolist()}; expected finite "
                "numbers. Check the rule."
            )
        along = roles.sliding.coordinates(start[slides] + moved[free:])
        return roles.assembled(positions, start[self.free] + moved[:free], along)
