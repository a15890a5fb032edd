"""Drawings of meshes and blocks; curved elements are drawn curved."""

from hoblock.plot.colours import MEASURES
from hoblock.plot.drawing import plot_mesh
from hoblock.plot.outlines import block_outlines, element_outlines, group_outlines

__all__ = ["MEASURES", "block_outlines", "element_outlines", "group_outlines", "plot_mesh"]
