"""Elements, blocks and groups of sides as polygons and polylines that follow their curves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.layout import layout
from hoblock.mesh import QuadMesh
from hoblock.numbering import side_nodes
from hoblock.reference import gauss_lobatto, lagrange

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["block_outlines", "boundary_sides", "element_outlines", "group_outlines", "side_outlines"]


def element_outlines(mesh: QuadMesh, samples: int | None = None) -> Array:
    """Closed outlines of all elements as polygons.

    Parameters
    ----------
    mesh : QuadMesh
    samples : int, optional
        Straight pieces a side; default 1 for order 1 and 4p above.

    Returns
    -------
    ndarray, shape (e, 4 samples, 2)
        Counter-clockwise.
    """
    values = _side_basis(mesh.order, samples)
    sides = side_nodes(mesh.order)
    walk = np.stack([sides[0], sides[1], sides[2][::-1], sides[3][::-1]])
    nodes = mesh.points[mesh.cells[:, walk]]  # (e, 4, p + 1, 2)
    return np.asarray((values[:-1] @ nodes).reshape(len(mesh.cells), -1, 2))


def block_outlines(mesh: QuadMesh, structure: BlockStructure, samples: int | None = None) -> list[Array]:
    """Block edges as polylines (k, 2), one for each edge of the structure that the mesh was made from."""
    plan = layout(structure, mesh.order)
    values = _side_basis(mesh.order, samples)
    lines = []
    for edge in range(len(structure.topology.edges)):
        nodes = mesh.points[plan.nodes_of_edge(edge)]
        elements = nodes[np.arange(0, len(nodes) - 1, mesh.order)[:, None] + np.arange(mesh.order + 1)]
        lines.append(np.concatenate([(values[:-1] @ elements).reshape(-1, 2), nodes[-1:]]))
    return lines


def side_outlines(mesh: QuadMesh, sides: Index, samples: int | None = None) -> Array:
    """Element sides (k, 2), given as (element, side), as polylines of shape (k, samples + 1, 2)."""
    nodes = mesh.points[mesh.cells[sides[:, 0, None], side_nodes(mesh.order)[sides[:, 1]]]]
    return np.asarray(_side_basis(mesh.order, samples) @ nodes)


def group_outlines(mesh: QuadMesh, samples: int | None = None) -> dict[str, Array]:
    """Return the sides of every named group as polylines, each of shape (k, samples + 1, 2)."""
    return {name: side_outlines(mesh, sides, samples) for name, sides in mesh.edge_groups.items()}


def boundary_sides(mesh: QuadMesh) -> Index:
    """Sides (k, 2), as (element, side), that belong to one element only."""
    corners = mesh.corners
    pairs = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    _, first, uses = np.unique(pairs, axis=0, return_index=True, return_counts=True)
    sides = np.sort(first[uses == 1])
    return np.stack([sides // 4, sides % 4], axis=1)


def _side_basis(order: int, samples: int | None) -> Array:
    count = (1 if order == 1 else 4 * order) if samples is None else samples
    return lagrange(gauss_lobatto(order), np.linspace(-1.0, 1.0, count + 1))
