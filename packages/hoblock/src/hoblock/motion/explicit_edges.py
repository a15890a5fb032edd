"""Edges that do more than blend the displacements of their ends: on curved paths, or with inherited shapes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve, NodalCurve
from hoblock.layout import Layout
from hoblock.mesh import QuadMesh
from hoblock.motion.driven_edges import DrivenEdges
from hoblock.motion.inherited_shapes import InheritedShapes
from hoblock.movers import Sliding

Array = NDArray[np.float64]

__all__ = ["ExplicitEdges"]


@dataclass(frozen=True, eq=False)
class ExplicitEdges:
    """Geometry of these edges, and of the driven ones, for positions of the driven nodes and of all block vertices.

    Attributes
    ----------
    structure : BlockStructure
        The reference.
    plan : Layout
    mesh : QuadMesh
        Of the reference.
    driven : DrivenEdges
    paths : Sliding
    shapes : InheritedShapes
    """

    structure: BlockStructure
    plan: Layout
    mesh: QuadMesh
    driven: DrivenEdges
    paths: Sliding
    shapes: InheritedShapes

    @property
    def edges(self) -> tuple[int, ...]:
        """Edges on curved paths, then those with inherited shapes."""
        return (*self.paths.curved_edges, *self.shapes.edges)

    def displacements(self, positions: Array, vertices: Array) -> Array:
        """Displacements (k, 2) of the inner nodes of ``edges``, edge after edge.

        Parameters
        ----------
        positions : ndarray
            Of the driven nodes.
        vertices : ndarray, shape (n, 2)
        """
        plan, points = self.plan, self.mesh.points
        curves = self.paths.curves(vertices)
        result = [
            np.asarray(curves[edge](plan.parameters_of_edge(edge)[1:-1])) - points[plan.nodes_of_edge(edge)[1:-1]]
            for edge in self.paths.curved_edges
        ]
        extra = self.shapes.displacements(self.driven, positions, vertices)
        for edge, shape in zip(self.shapes.edges, extra, strict=True):
            result.append(self._blended(edge, vertices) + shape)
        return np.concatenate([np.zeros((0, 2)), *result])

    def curves(self, positions: Array, vertices: Array) -> Mapping[int, Curve]:
        """New geometry of ``edges`` and of the driven ones."""
        curves = {**self.paths.curves(vertices), **self.driven.curves(positions)}
        plan, points = self.plan, self.mesh.points
        extra = self.shapes.displacements(self.driven, positions, vertices)
        for edge, shape in zip(self.shapes.edges, extra, strict=True):
            nodes = points[plan.nodes_of_edge(edge)].copy()
            nodes[1:-1] += self._blended(edge, vertices) + shape
            nodes[0], nodes[-1] = vertices[self.structure.topology.edges[edge]]
            curves[edge] = NodalCurve(nodes, self.mesh.order)
        return curves

    def _blended(self, edge: int, vertices: Array) -> Array:
        """Displacements of the inner nodes of an edge that blends those of its ends."""
        t = self.plan.parameters_of_edge(edge)[1:-1, None]
        first, second = (vertices - self.structure.vertices)[self.structure.topology.edges[edge]]
        return np.asarray((1.0 - t) * first + t * second)
