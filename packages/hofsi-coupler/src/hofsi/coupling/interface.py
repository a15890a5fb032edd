"""The wet interface: matching nodes of the fluid and the solid mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock import BlockStructure
from hoblock.layout import layout

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Interface", "match_interface"]


@dataclass(frozen=True)
class Interface:
    """Nodes on the interface; row k of both arrays is the same point.

    Attributes
    ----------
    fluid, solid : ndarray, shape (k,)
        Node numbers in the two meshes; ``fluid`` ascends.
    fluid_edges : tuple of int
        Block edges of the fluid's structure.
    """

    fluid: Index
    solid: Index
    fluid_edges: tuple[int, ...]


def match_interface(fluid: BlockStructure, solid: BlockStructure, order: int) -> Interface:
    """Match the nodes on the block edges that two parts of one structure share.

    Parameters
    ----------
    fluid, solid : BlockStructure
        Made by `BlockStructure.restricted` from one structure, so that shared edges have the same direction.
    order : int
    """
    pairs = []
    edges = []
    plans = layout(fluid, order), layout(solid, order)
    number = {name: k for k, name in enumerate(solid.topology.vertex_names)}
    for edge, (first, second) in enumerate(fluid.topology.edges):
        ends = [number.get(fluid.topology.vertex_names[v]) for v in (first, second)]
        if ends[0] is None or ends[1] is None:
            continue
        other = solid.topology.find_edge(ends[0], ends[1])
        if other is not None:
            edges.append(edge)
            pairs.append(np.stack([plans[0].nodes_of_edge(edge), plans[1].nodes_of_edge(other)]))
    nodes = np.unique(np.concatenate(pairs, axis=1), axis=1)
    return Interface(nodes[0], nodes[1], tuple(edges))
