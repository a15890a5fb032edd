"""Blocks put into a block: an inner one and a ring of four, without touching its neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import TopologyError
from hoblock.grading import EdgeGrading, Grading, Uniform
from hoblock.operations.block_lines import block_line
from hoblock.operations.isolines import resolved_isoline_grading
from hoblock.operations.structure_tables import StructureTables, unique_name
from hoblock.topology_checks import element_count

Array = NDArray[np.float64]

__all__ = ["split_block"]

_CORNERS = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def split_block(
    structure: BlockStructure,
    block: int | str,
    *,
    inset: float = 0.5,
    count: int = 1,
    grading: Grading | EdgeGrading | None = None,
) -> BlockStructure:
    """Put an inner block and a ring of four around it in the place of a block (an O-grid inside it).

    The edges of the block, and with them its neighbours, remain as they are; so do the numbers of elements along them.
    Lines that left the block on the opposite side now turn round the inner block where the ring takes them.

    Parameters
    ----------
    structure : BlockStructure
    block : int or str
        Its number, or the name of a group that is this block alone.
    inset : float
        How far the corners of the inner block are on the way from those of the block (0) to its centre (1).
    count : int
        Elements across the ring.
    grading : Grading or EdgeGrading, optional
        Across the ring, from the block's edges inwards; uniform without one.

    Returns
    -------
    BlockStructure
        All five blocks belong to the groups of the block. The new vertex beside 'a' is named 'a:1'.

    Raises
    ------
    TopologyError
        If there is no such block, or ``inset`` or ``count`` are out of range.
    """
    topology = structure.topology
    number = topology.block(block)
    place = f"split_block, {topology.block_name(number)}"
    if isinstance(inset, bool) or not isinstance(inset, int | float | np.number) or not 0.0 < inset < 1.0:
        raise TopologyError(f"{place}: inset={inset!r}; expected a number between 0 (corners) and 1 (centre).")
    count = element_count(count, place)
    tables = StructureTables.of(structure)
    f = 0.5 * float(inset)
    outer, sides = topology.quads[number].tolist(), topology.block_edges[number].tolist()
    curved = any(side in structure.curves for side in sides)
    places = ((f, f), (1.0 - f, f), (1.0 - f, 1.0 - f), (f, 1.0 - f))
    inner: list[int] = []
    for vertex, corner, place_inside in zip(outer, _CORNERS, places, strict=True):
        diagonal = block_line(structure, number, corner, place_inside)
        name = unique_name(topology.vertex_names[vertex], tables.names)
        inner.append(tables.add_vertex(name, diagonal(np.ones(1))[0]))
        across = grading if grading is not None else Uniform()
        tables.add_edge((vertex, inner[-1]), count, diagonal if curved else None, across)
    for side, (first, second) in enumerate(((0, 1), (1, 2), (3, 2), (0, 3))):
        line = block_line(structure, number, places[first], places[second])
        elements = int(topology.counts[sides[side]])
        along = resolved_isoline_grading(structure, (sides[side], sides[side - 2]), (f, f))
        tables.add_edge((inner[first], inner[second]), elements, line if curved else None, along)
    ring = [(outer[k], outer[k - 3], inner[k - 3], inner[k]) for k in range(4)]
    a, b, c, d = inner
    tables.pieces[number] = [(a, b, c, d), *ring]
    return tables.structure()
