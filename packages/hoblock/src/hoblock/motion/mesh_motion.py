"""From a position of the driven nodes to a certified mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve, CuttableCurve
from hoblock.errors import CurveError, InvalidMeshError, MoverError
from hoblock.generate import generate, raise_if_invalid, regenerate
from hoblock.grading import EdgeGrading
from hoblock.layout import layout
from hoblock.mesh import QuadMesh
from hoblock.motion.crossings import boundary_crossing
from hoblock.motion.driven_edges import driven_edges
from hoblock.motion.explicit_edges import ExplicitEdges
from hoblock.motion.inherited_shapes import inherited_shapes
from hoblock.motion.mesh_state import MeshState
from hoblock.motion.node_blending import NodeBlending, node_blending
from hoblock.movers import Mover
from hoblock.quality import certify, det_jacobian_bounds

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["MeshMotion"]

_BLENDED_NODES = 40_000
"""Nodes up to which one product with a sparse matrix is faster than blending block by block (measured)."""


class MeshMotion:
    """Generates the mesh that belongs to a position of the driven nodes, and certifies it.

    The mover places the block vertices; driven edges take their nodes as given, edges on curved paths are cut anew
    between vertices that slide, all others keep their shape; transfinite maps fill the blocks. Blocks that cannot move
    are not touched, neither by the mover nor by the generation, nor by the certificate. A motion holds no state.

    Parameters
    ----------
    structure : BlockStructure
        The blocks in the reference.
    order : int
        Order p of the elements.
    edges : sequence of int
        Driven edges.
    mover : Mover
        Made for the same structure and the vertices of the driven edges.
    mesh : QuadMesh, optional
        The mesh of ``structure``, if there is one already.
    inherit : {"auto", "all", "none"}
        Which inner edges take on the shape of the driven edge they face: those across sides of one or two blocks, all,
        or none.
    halvings : int
        How often a motion that fails is halved before it is given up.

    Attributes
    ----------
    reference : MeshState
        The given structure. It need not be what the mover makes of the reference position, see `start`.
    driven : DrivenEdges
    moving_blocks, moving_vertices, moving_nodes : ndarray
        Numbers of those that can move, ascending.

    Raises
    ------
    MoverError
        If an edge does not exist, or the mover was made for other vertices.
    InvalidMeshError
        If the mesh of the reference is not valid.

    Examples
    --------
    >>> motion = MeshMotion(structure, 4, edges, BarrierEnergy(structure, driven))
    >>> state = motion.move(motion.reference, positions)  # state.mesh, state.min_det_J
    """

    def __init__(
        self,
        structure: BlockStructure,
        order: int,
        edges: Sequence[int] | Index,
        mover: Mover,
        *,
        mesh: QuadMesh | None = None,
        inherit: Literal["auto", "all", "none"] = "auto",
        halvings: int = 4,
    ) -> None:
        self.driven = driven = driven_edges(structure, order, edges)
        if not np.array_equal(mover.driven, driven.vertices):
            raise MoverError(
                f"motion: the mover drives the vertices {mover.driven.tolist()}; expected those of the driven edges, "
                f"{driven.vertices.tolist()}."
            )
        if inherit not in ("auto", "all", "none"):
            raise MoverError(f"motion: inherit is {inherit!r}; expected 'auto', 'all' or 'none'.")
        if isinstance(halvings, bool) or not isinstance(halvings, int) or halvings < 0:
            raise MoverError(f"motion: halvings is {halvings!r}; expected an integer >= 0.")
        self._mover, self._halvings = mover, halvings
        self._end_rows = driven.end_rows(mover.tangent_edges)
        self._ends = np.array([rows[[0, -1]] for rows in driven.rows], dtype=np.int64).reshape(-1, 2)
        self._size = float(np.abs(structure.vertices).max())
        mesh = generate(structure, order) if mesh is None else mesh
        self._plan = layout(structure, order)
        positions = mesh.points[driven.nodes]
        shapes = inherited_shapes(structure, driven, positions, inherit)
        self._explicit = ExplicitEdges(structure, self._plan, mesh, driven, mover.paths, shapes)
        self._find_moving(structure, mesh)
        lower = det_jacobian_bounds(mesh)[0]
        if not (lower > 0.0).all():
            raise_if_invalid(mesh, structure)
            lower = certify(mesh).lower
        still = np.setdiff1d(np.arange(len(mesh.cells)), self._cells)
        self._still = float(lower[still].min(initial=np.inf))
        self._part = QuadMesh(mesh.points, mesh.cells[self._cells], order, {}, {})
        bound = float(lower.min())
        self.reference = MeshState(mesh, structure.vertices, positions, bound, structure_of=lambda: structure)

    def start(self) -> MeshState:
        """Return what the mover makes of the reference position: the reference, unless the mover smooths."""
        return self.move(self.reference, self.reference.positions)

    def move(self, current: MeshState, positions: Array) -> MeshState:
        """Generate the mesh for a position of the driven nodes.

        Parameters
        ----------
        current : MeshState
            The last accepted state. It is not changed, and is still there if the motion fails.
        positions : ndarray, shape (k, 2)
            Of ``driven.nodes``.

        Returns
        -------
        MeshState

        Raises
        ------
        MoverError
            If a position is not finite, or the mover finds no place for the vertices.
        InvalidMeshError
            Naming the block, element and place where the mesh would be invalid.
        GradingError
            If a boundary layer does not fit its edge any more.
        """
        positions = self._checked(positions)
        try:
            return self._moved(current, positions)
        except (InvalidMeshError, MoverError) as error:
            way = positions - current.positions
            if not self._halvings or not way.any():
                raise self._explained(error, positions) from error
            failure = error
        done, parts, state, blocks = 0.0, 2, current, 0
        while done < 1.0:
            target = min(1.0, done + 1.0 / parts)
            try:
                state = self._moved(state, current.positions + target * way if target < 1.0 else positions)
            except (InvalidMeshError, MoverError) as error:
                failure, parts = error, 2 * parts
                if parts > 2**self._halvings:
                    raise self._explained(failure, positions) from failure
                continue
            done, blocks = target, blocks + state.regenerated
        amplification = self._amplification(current, state.vertices, positions)
        return replace(state, regenerated=blocks, substeps=parts, amplification=amplification)

    def certified_part(self, mesh: QuadMesh) -> QuadMesh:
        """Return the elements of a mesh of this motion that can move: those that every motion certifies anew."""
        return self._part.with_points(mesh.points)

    def _moved(self, current: MeshState, positions: Array) -> MeshState:
        """Move in one step."""
        driven, reference, mover = self.driven, self.reference, self._mover
        tangents = driven.tangents(positions, self._end_rows) if len(self._end_rows) else None
        vertices = mover.move(current.vertices, positions[driven.vertex_rows], tangents)

        def structure() -> BlockStructure:
            return self._structure(positions, vertices)

        if self._blending is not None:
            points = self._blended(self._blending, positions, vertices)
            mesh = reference.mesh.with_points(points)
        else:
            mesh = regenerate(reference.mesh, structure(), previous=reference.structure)
        part = self.certified_part(mesh)
        lower = float(det_jacobian_bounds(part)[0].min(initial=np.inf))
        if not lower > 0.0:
            certificate = certify(part)
            if not certificate.valid:
                raise_if_invalid(mesh, structure())
            lower = certificate.min_det_J
        return MeshState(
            mesh,
            vertices,
            positions,
            min(lower, self._still),
            len(self.moving_blocks),
            1,
            self._amplification(current, vertices, positions),
            structure,
        )

    def _structure(self, positions: Array, vertices: Array) -> BlockStructure:
        return self.reference.structure.moved(vertices, self._explicit.curves(positions, vertices))

    def with_structure(self, state: MeshState) -> MeshState:
        """Return a state of this motion, read from somewhere without its block structure, with it."""
        return replace(state, structure_of=lambda: self._structure(state.positions, state.vertices))

    def _blended(self, blending: NodeBlending, positions: Array, vertices: Array) -> Array:
        """Points of all nodes by the sparse matrix."""
        reference, driven = self.reference, self.driven
        given = np.empty((len(blending.given), 2))
        given[: len(self._inner_rows)] = (positions - reference.positions)[self._inner_rows]
        if self._explicit.edges:
            given[len(self._inner_rows) :] = self._explicit.displacements(positions, vertices)
        moved = vertices[blending.vertices] - reference.vertices[blending.vertices]
        points = blending.moved(reference.mesh.points, moved, given)
        points[driven.nodes] = positions
        return points

    def _find_moving(self, structure: BlockStructure, mesh: QuadMesh) -> None:
        """Find what can move, and how the nodes follow."""
        driven, paths, topology, plan = self.driven, self._mover.paths, structure.topology, self._plan
        self.moving_vertices = np.unique(np.concatenate([self._mover.free, paths.vertices, driven.vertices]))
        vertices = np.zeros(len(topology.vertex_names), dtype=bool)
        vertices[self.moving_vertices] = True
        moving = vertices[topology.quads].any(axis=1)
        moving |= np.isin(topology.block_edges, [*driven.edges, *self._explicit.edges]).any(axis=1)
        self.moving_blocks = np.flatnonzero(moving)
        starts = plan.numbers.cell_starts
        self._cells = np.concatenate(
            [np.zeros(0, dtype=np.int64), *(np.arange(starts[b], starts[b + 1]) for b in self.moving_blocks)]
        )
        edges = np.unique(topology.block_edges[self.moving_blocks])
        self._inner_rows = np.concatenate([np.zeros(0, dtype=np.int64), *(rows[1:-1] for rows in driven.rows)])
        self._blending: NodeBlending | None = None
        if plan.node_count <= _BLENDED_NODES and self._blends(structure, edges, vertices):
            self._blending = node_blending(plan, topology, self.moving_vertices, (*driven.edges, *self._explicit.edges))
        self.moving_nodes = np.unique(mesh.cells[self._cells]) if self._blending is None else self._blending.nodes

    def _blends(self, structure: BlockStructure, edges: Index, moving: NDArray[np.bool_]) -> bool:
        """Whether all nodes depend linearly on vertices and given nodes."""
        for edge in edges.tolist():
            if isinstance(structure.gradings[edge], EdgeGrading):
                return False
            curve = structure.curves.get(edge)
            explicit = edge in self.driven.edges or edge in self._explicit.edges
            if curve is not None and not explicit and moving[structure.topology.edges[edge]].any() and _cuttable(curve):
                return False
        return True

    def _amplification(self, current: MeshState, vertices: Array, positions: Array) -> float:
        """Largest way of a placed vertex in terms of that of a driven node."""
        placed = self._mover.free
        if not placed.size:
            return 0.0
        driven = float(np.abs(positions - current.positions).max(initial=0.0))
        way = float(np.abs(vertices[placed] - current.vertices[placed]).max())
        return way / driven if driven > 1e-12 * self._size else 0.0

    def _checked(self, positions: Array) -> Array:
        """Return positions of the driven nodes, or raise MoverError."""
        nodes = self.driven.nodes
        positions = np.array(positions, dtype=float)
        if positions.shape != (len(nodes), 2):
            raise MoverError(f"move: positions have shape {positions.shape}; expected {(len(nodes), 2)}.")
        if not np.isfinite(positions).all():
            k = int(np.argmin(np.isfinite(positions).all(axis=1)))
            edge = next(edge for edge, rows in zip(self.driven.edges, self.driven.rows, strict=True) if k in rows)
            x, y = self.reference.positions[k]
            raise MoverError(
                f"move: positions[{k}], the node of the driven edge {self.driven.topology.edge_name(edge)} that was at "
                f"({x:.6g}, {y:.6g}), is {positions[k].tolist()}; expected finite coordinates. Check what drives it."
            )
        chords = positions[self._ends[:, 1]] - positions[self._ends[:, 0]]
        if not chords.any(axis=1).all():
            k = int(np.argmin(chords.any(axis=1)))
            x, y = positions[self._ends[k, 0]]
            name = self.driven.topology.edge_name(self.driven.edges[k])
            raise MoverError(
                f"move: the driven edge {name} has no length: both ends are at ({x:.6g}, {y:.6g}); expected two "
                "places. Check what drives it."
            )
        positions.setflags(write=False)
        return positions

    def _explained(self, error: InvalidMeshError | MoverError, positions: Array) -> InvalidMeshError | MoverError:
        """The error, with the place where the boundary crosses itself if it does."""
        vertices = np.array(self.reference.vertices)
        vertices[self.driven.vertices] = positions[self.driven.vertex_rows]
        try:
            moved = self.reference.structure.moved(vertices, self.driven.curves(positions))
        except CurveError:
            return error
        crossing = boundary_crossing(moved, self.reference.mesh.order)
        if crossing is None:
            return error
        text = f"{crossing} No mesh fits such a boundary. {error}"
        if isinstance(error, InvalidMeshError):
            return InvalidMeshError(text, error.elements, error.certificate)
        return MoverError(text)


def _cuttable(curve: Curve) -> bool:
    """Whether a curve, or the one it is made from, can be cut anew between other ends."""
    inner: object = curve
    while inner is not None:
        if isinstance(inner, CuttableCurve):
            return True
        inner = getattr(inner, "curve", None)
    return False
