"""From a block structure to a mesh, and again after the structure has moved."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve, NodalCurve
from hoblock.diagnosis import diagnose, invalid_mesh_message
from hoblock.errors import CurveError, InvalidMeshError
from hoblock.layout import Batch, Layout, layout
from hoblock.mesh import QuadMesh
from hoblock.quality import certify
from hoblock.reference import gauss_lobatto
from hoblock.topology import BlockTopology
from hoblock.transfinite import interior_points

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["changed_blocks", "generate", "raise_if_invalid", "regenerate"]


def generate(structure: BlockStructure, order: int, *, check: bool = True) -> QuadMesh:
    """Generate the mesh of a block structure.

    Parameters
    ----------
    structure : BlockStructure
    order : int
        Order p of the elements.
    check : bool
        Refuse a mesh whose det J is not certainly positive everywhere.

    Returns
    -------
    QuadMesh

    Raises
    ------
    InvalidMeshError
        Naming the worst element, its block and place.
    """
    plan = layout(structure, order)
    points = np.empty((plan.node_count, 2))
    _fill(plan, structure, points, None)
    mesh = QuadMesh(points, plan.cells, order, plan.numbers.cell_groups, plan.numbers.edge_groups)
    if check:
        raise_if_invalid(mesh, structure)
    return mesh


def regenerate(
    mesh: QuadMesh, structure: BlockStructure, *, out: Array | None = None, previous: BlockStructure | None = None
) -> QuadMesh:
    """Generate the points of a moved structure on the connectivity of a mesh of the same structure.

    Parameters
    ----------
    mesh : QuadMesh
        Made by `generate` or `regenerate` from a structure that shares ``structure``'s topology.
    structure : BlockStructure
        The moved structure.
    out : ndarray, shape (n, 2), optional
        Buffer for the points; owned by the caller, who must not write to it while the returned mesh is in use.
    previous : BlockStructure, optional
        The structure ``mesh`` was made from. If given, only the blocks that differ are generated, the rest is copied.

    Returns
    -------
    QuadMesh
        Not checked; see `raise_if_invalid`.

    Raises
    ------
    ValueError
        If the mesh or ``previous`` belongs to another structure, or ``out`` cannot take the points.
    """
    plan = layout(structure, mesh.order)
    if plan.cells is not mesh.cells and not np.array_equal(plan.cells, mesh.cells):
        raise ValueError("regenerate: the mesh was made from another block structure; use generate.")
    points = np.empty((plan.node_count, 2)) if out is None else out
    if not isinstance(points, np.ndarray):
        raise ValueError(f"regenerate: out is a {type(points).__name__}; expected an array.")
    if points.shape != (plan.node_count, 2) or points.dtype != np.float64:
        raise ValueError(
            f"regenerate: out has shape {points.shape}, type {points.dtype}; expected {(plan.node_count, 2)}, float64."
        )
    if not points.flags.writeable:
        raise ValueError("regenerate: out is read-only, as the points of meshes are; use np.empty_like(mesh.points).")
    changed = None
    if previous is not None:
        same = layout(previous, mesh.order)
        if same is not plan and not (
            np.array_equal(same.cells, plan.cells) and previous.gradings == structure.gradings
        ):
            raise ValueError(
                "regenerate: previous has other blocks, counts or gradings than the structure; expected the one that "
                "the mesh was made from. Leave it out."
            )
        if np.may_share_memory(points, mesh.points):
            raise ValueError("regenerate: out is the buffer of the mesh that is to be kept; use another.")
        points[:] = mesh.points
        changed = changed_blocks(previous, structure)
        if not changed.any():
            return mesh.with_points(points)
    _fill(plan, structure, points, changed)
    return mesh.with_points(points)


def changed_blocks(previous: BlockStructure, structure: BlockStructure) -> NDArray[np.bool_]:
    """Blocks with a moved vertex or an edge of another geometry, shape (b,)."""
    topology = structure.topology
    moved = (previous.vertices != structure.vertices).any(axis=1)
    changed = np.asarray(moved[topology.quads].any(axis=1))
    edges = [
        edge
        for edge in previous.curves.keys() | structure.curves.keys()
        if previous.curves.get(edge) is not structure.curves.get(edge)
    ]
    if edges:
        changed |= np.isin(topology.block_edges, edges).any(axis=1)
    return changed


def _fill(plan: Layout, structure: BlockStructure, points: Array, changed: NDArray[np.bool_] | None) -> None:
    """Write the nodes of all edges and of the changed blocks into ``points``.

    Vertices that are not finite make nodes that are not, without warnings: the certificate tells.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        points[plan.edge_nodes] = _edge_points(plan, structure)
        _fill_batches(plan, points, changed)


def _fill_batches(plan: Layout, points: Array, changed: NDArray[np.bool_] | None) -> None:
    """Write the inner nodes of the changed blocks, or of all."""
    for batch in plan.batches:
        part = batch
        if changed is not None:
            some = np.flatnonzero(changed[batch.blocks])
            part = batch if len(some) == len(batch.members) else batch.select(some)
        if len(part.members) and part.patch.stop > part.patch.start:
            _fill_interiors(part, points)


def _edge_points(plan: Layout, structure: BlockStructure) -> Array:
    """Nodes of all block edges, in the order of ``plan.edge_nodes``."""
    edges = structure.topology.edges
    lengths = np.diff(plan.edge_offsets)
    first, second = (np.repeat(structure.vertices[edges[:, k]], lengths, axis=0) for k in range(2))
    t = plan.edge_parameters[:, None]
    points = (1.0 - t) * first + t * second
    for edge, curve in structure.curves.items():
        start, stop = plan.edge_offsets[edge], plan.edge_offsets[edge + 1]
        if isinstance(curve, NodalCurve):
            points[start:stop] = _nodal_points(curve, plan, structure.topology, edge)
        else:
            points[start:stop] = _curve_points(curve, plan.edge_parameters[start:stop], structure.topology, edge)
            points[start], points[stop - 1] = structure.vertices[edges[edge]]
    return points


def _fill_interiors(batch: Batch, points: Array) -> None:
    """Write the inner nodes of a batch; in place where its blocks follow one another."""
    patch, members = batch.patch, batch.members
    bottom, top, left, right = (points[nodes[members]] for nodes in patch.sides)
    block_size = patch.rows * patch.columns
    contiguous = int(members[-1]) - int(members[0]) == len(members) - 1
    if contiguous and points.flags.c_contiguous:
        start = patch.start + int(members[0]) * block_size
        target = points[start : start + len(members) * block_size]
        interior_points(batch.weights, bottom, top, left, right, target.reshape(-1, patch.rows, patch.columns, 2))
    else:
        inner = interior_points(batch.weights, bottom, top, left, right)
        nodes = patch.start + members[:, None] * block_size + np.arange(block_size)
        points[nodes] = inner.reshape(len(members), block_size, 2)


def _curve_points(curve: Curve, t: Array, topology: BlockTopology, edge: int) -> Array:
    """Nodes of a curved edge, or an error that names the edge."""
    try:
        points = np.asarray(curve(t), dtype=float)
    except CurveError as error:
        raise CurveError(f"edge {topology.edge_name(edge)}: {error}") from error
    if points.shape != (len(t), 2):
        raise CurveError(
            f"edge {topology.edge_name(edge)}: the curve returned shape {points.shape} for {len(t)} parameters; "
            f"expected {(len(t), 2)}."
        )
    return points


def _nodal_points(curve: NodalCurve, plan: Layout, topology: BlockTopology, edge: int) -> Array:
    """Nodes of an interface edge: taken as they are for the same order, evaluated element by element for another."""
    count = int(topology.counts[edge])
    if curve.count != count:
        raise CurveError(
            f"edge {topology.edge_name(edge)}: the nodal curve has {curve.count} elements; the edge has {count}."
        )
    if curve.order == plan.order:
        return curve.points
    inner = (gauss_lobatto(plan.order)[:-1] + 1.0) / 2.0
    uniform = np.append(((np.arange(count)[:, None] + inner) / count).ravel(), 1.0)
    return curve(uniform)


def raise_if_invalid(mesh: QuadMesh, structure: BlockStructure) -> None:
    """Raise if det J > 0 is not proven for every element.

    Parameters
    ----------
    mesh : QuadMesh
    structure : BlockStructure
        What the mesh was made from.

    Raises
    ------
    InvalidMeshError
        Says how many elements are invalid or undecided, and of the worst ones the block, (ξ, η), (x, y) and the
        reason. Its ``elements`` are these as `hoblock.quality.BadElement`, its ``certificate`` that of the mesh.
    """
    certificate = certify(mesh)
    if certificate.valid:
        return
    worst = diagnose(mesh, structure, certificate)
    raise InvalidMeshError(invalid_mesh_message(certificate, worst), worst, certificate)
