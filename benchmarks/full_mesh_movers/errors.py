"""What goes wrong when a mesh is moved."""

from __future__ import annotations

__all__ = ["MotionFailed"]


class MotionFailed(Exception):  # noqa: N818 - an outcome that a comparison counts, not a mistake of the caller
    """A mover has no mesh for the given positions.

    Either its equations have no solution that was found, or they cannot be set up, because the mesh they are set up on
    has an element that is turned over. That a mesh is *returned* does not mean that it is valid.
    """
