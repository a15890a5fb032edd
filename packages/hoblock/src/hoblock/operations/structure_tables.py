"""The contents of a block structure as tables to work on: taken from a structure, changed, and put together again."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import count

import numpy as np
from numpy.typing import NDArray

from hoblock.assembly import assemble
from hoblock.blocks import BlockStructure
from hoblock.curves import Curve
from hoblock.edge_tables import Pair
from hoblock.grading import EdgeGrading, Grading

Array = NDArray[np.float64]
Quad = tuple[int, int, int, int]

__all__ = ["StructureTables"]


@dataclass
class StructureTables:
    """Blocks by numbers of vertices, what is said about edges by pairs of them.

    Attributes
    ----------
    names : list of str
    vertices : list of ndarray, shape (2,)
    pieces : list of list of Quad
        What has become of each block; the pieces of all blocks, one after the other, are the blocks of the result.
    block_groups : dict of str to list of int
        Places in ``pieces``; all pieces of a block are in its groups.
    edge_groups : dict of str to list of Pair
    counts, curves, gradings : dict of Pair to int, Curve, Grading
        Each pair in the direction of its curve and grading.
    """

    names: list[str] = field(default_factory=list)
    vertices: list[Array] = field(default_factory=list)
    pieces: list[list[Quad]] = field(default_factory=list)
    block_groups: dict[str, list[int]] = field(default_factory=dict)
    edge_groups: dict[str, list[Pair]] = field(default_factory=dict)
    counts: dict[Pair, int] = field(default_factory=dict)
    curves: dict[Pair, Curve] = field(default_factory=dict)
    gradings: dict[Pair, Grading | EdgeGrading] = field(default_factory=dict)

    @staticmethod
    def of(structure: BlockStructure) -> StructureTables:
        """Return the contents of a structure; vertices and blocks keep their numbers."""
        topology = structure.topology
        pairs: list[Pair] = [(a, b) for a, b in topology.edges.tolist()]
        return StructureTables(
            list(topology.vertex_names),
            list(structure.vertices),
            [[(a, b, c, d)] for a, b, c, d in topology.quads.tolist()],
            {name: blocks.tolist() for name, blocks in topology.block_groups.items()},
            {name: [pairs[edge] for edge in edges] for name, edges in topology.edge_groups.items()},
            dict(zip(pairs, topology.counts.tolist(), strict=True)),
            {pairs[edge]: curve for edge, curve in structure.curves.items()},
            dict(zip(pairs, structure.gradings, strict=True)),
        )

    def structure(self) -> BlockStructure:
        """Put the structure together and check it.

        Raises
        ------
        TopologyError, CurveError, GradingError
            As `BlockStructure.build`.
        """
        ends = np.cumsum([len(pieces) for pieces in self.pieces])
        starts = ends - [len(pieces) for pieces in self.pieces]
        members = {
            name: np.concatenate([np.arange(starts[block], ends[block]) for block in blocks])
            for name, blocks in self.block_groups.items()
        }
        parts = assemble(
            self.names,
            np.array(self.vertices),
            np.array([quad for pieces in self.pieces for quad in pieces], dtype=np.int64),
            members,
            edge_groups=self.edge_groups,
            counts=self.counts,
            curves=self.curves,
            gradings=self.gradings,
        )
        return BlockStructure(*parts)

    def add_vertex(self, name: str, position: Array) -> int:
        """Add a vertex whose name is not taken yet and return its number."""
        self.names.append(name)
        self.vertices.append(np.asarray(position, dtype=float))
        return len(self.names) - 1

    def add_edge(self, pair: Pair, number: int, curve: Curve | None, grading: Grading | EdgeGrading) -> None:
        """Say what there is to say about a new edge."""
        self.counts[pair] = number
        self.gradings[pair] = grading
        if curve is not None:
            self.curves[pair] = curve

    def replace_edge(self, pair: Pair, parts: Sequence[Pair]) -> None:
        """Let parts, which have been added, take the place of an edge in all named groups."""
        for table in (self.counts, self.curves, self.gradings):
            table.pop(pair, None)
        for name, pairs in self.edge_groups.items():
            self.edge_groups[name] = [new for old in pairs for new in (parts if old == pair else (old,))]

    def name_between(self, first: int, second: int) -> str:
        """Return a name that is not taken for a vertex between two: 'a-b:1', 'a-b:2' …, also where they have such."""
        names = self.names[first], self.names[second]
        roots = _root(names[0]), _root(names[1])
        ends = roots[0] or names[0], roots[1] or names[1]
        for whole, end in ((roots[0], ends[1]), (roots[1], ends[0])):
            if whole and (whole == end or whole.startswith(f"{end}-") or whole.endswith(f"-{end}")):
                return unique_name(whole, self.names)  # between parts of one line
        return unique_name("-".join(ends), self.names)


def _root(name: str) -> str:
    """'a-b' of 'a-b:1', the name of a vertex put between a and b; empty for other names."""
    found = re.fullmatch(r"(.+-.+):\d+", name)
    return found[1] if found else ""


def unique_name(root: str, taken: Iterable[str]) -> str:
    """Return the first of 'root:1', 'root:2' … that is not taken."""
    known = set(taken)
    return next(name for name in (f"{root}:{k}" for k in count(1)) if name not in known)
