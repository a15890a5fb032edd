"""From the mesh part of a scene to a block structure."""

from hoblock.building.structure import build_structure

__all__ = ["build_structure"]
