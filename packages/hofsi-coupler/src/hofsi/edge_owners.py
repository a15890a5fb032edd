"""Block edges by the materials they belong to: outer edges, edges inside, edges shared by two materials."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise

from hoblock.scene import MeshScene, Quad

__all__ = [
    "Edge",
    "EdgeOwners",
    "FLUID",
    "components",
    "edges_of",
    "in_words",
    "named_edges",
    "quad_edges",
    "solid_label",
]

Edge = tuple[str, str]
"""Two vertices by name, in alphabetical order."""

FLUID = "the fluid"
"""Label of the fluid among the owners of an edge."""


def solid_label(name: str) -> str:
    """Label of a solid among the owners of an edge."""
    return f"solid {name!r}"


@dataclass(frozen=True)
class EdgeOwners:
    """The materials on both sides of every block edge.

    Attributes
    ----------
    of : mapping of Edge to tuple of str
        Labels of the materials of the blocks at the edge: one label for an outer edge, two for one between blocks.
    """

    of: Mapping[Edge, tuple[str, ...]]

    @staticmethod
    def build(mesh: MeshScene, groups: Mapping[str, Iterable[str]]) -> EdgeOwners:
        """Collect the owners of all edges.

        Parameters
        ----------
        mesh : MeshScene
        groups : mapping of str to iterable of str
            Block groups of every material, by its label.
        """
        of: dict[Edge, tuple[str, ...]] = {}
        for label, names in groups.items():
            for name in names:
                for quad in mesh.blocks[name]:
                    for edge in quad_edges(quad):
                        of[edge] = (*of.get(edge, ()), label)
        return EdgeOwners(of)

    def outer(self, label: str) -> tuple[Edge, ...]:
        """Edges with one block only, of that material."""
        return tuple(edge for edge, owners in self.of.items() if owners == (label,))

    def is_wet(self, edge: Edge) -> bool:
        """Whether the edge lies between the fluid and a solid."""
        return len(set(self.of.get(edge, ()))) == 2 and FLUID in self.of[edge]

    def where(self, edge: Edge) -> str:
        """Say where the edge lies, for messages: "is inside the fluid"."""
        owners = self.of.get(edge, ())
        if not owners:
            return "is not an edge of a block with a material"
        if len(owners) == 1:
            return f"belongs to {owners[0]} alone"
        first, second = owners[:2]
        return f"is inside {first}" if first == second else f"is shared by {first} and {second}"


def quad_edges(quad: Quad) -> tuple[Edge, ...]:
    """The four edges of a block."""
    return tuple(_edge(quad[k], quad[(k + 1) % 4]) for k in range(4))


def named_edges(mesh: MeshScene, name: str) -> tuple[Edge, ...]:
    """Edges along the paths of a name in ``[mesh.edges]``."""
    pairs = (pair for path in mesh.edges[name] for pair in pairwise(path))
    return tuple(_edge(first, second) for first, second in pairs)


def edges_of(mesh: MeshScene, names: Iterable[str]) -> tuple[tuple[str, Edge], ...]:
    """Pairs of name and edge for all edges of several names."""
    return tuple((name, edge) for name in names for edge in named_edges(mesh, name))


def components(quads: Iterable[Quad], ties: Iterable[frozenset[Edge]] = ()) -> tuple[frozenset[Edge], ...]:
    """Edges of the parts into which blocks fall if only common edges, and sets of tied edges, hold them together."""
    left = [frozenset(quad_edges(quad)) for quad in quads]
    left += ties
    parts: list[frozenset[Edge]] = []
    while left:
        part = left.pop(0)
        while touching := [edges for edges in left if edges & part]:
            part = part.union(*touching)
            left = [edges for edges in left if not edges <= part]
        parts.append(part)
    return tuple(parts)


def in_words(edges: Iterable[Edge]) -> str:
    """Edges by the names of their vertices, at most eight of them: "i0–i1, i1–i2"."""
    listed = [f"{first}–{second}" for first, second in edges]
    more = f", … ({len(listed)} edges)" if len(listed) > 8 else ""
    return ", ".join(listed[:8]) + more


def _edge(first: str, second: str) -> Edge:
    return (first, second) if first <= second else (second, first)
