"""From a block structure to a mesh, and again after the structure has moved."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve, NodalCurve
from hoblock.errors import CurveError, InvalidMeshError
from hoblock.layout import Layout, layout
from hoblock.mesh import QuadMesh
from hoblock.quality import invalid_elements
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
    mesh = QuadMesh(points, plan.cells, order, plan.cell_groups, plan.edge_groups)
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
            np.array_equal(same.cells, plan.cells) and np.array_equal(same.edge_parameters, plan.edge_parameters)
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
    """Write the nodes of all edges and of the changed blocks into ``points``."""
    first, second = (structure.vertices[structure.topology.edges[:, k]][plan.edge_of_entry] for k in range(2))
    t = plan.edge_parameters[:, None]
    on_edges = (1.0 - t) * first + t * second
    for edge, curve in structure.curves.items():
        start, stop = plan.edge_offsets[edge], plan.edge_offsets[edge + 1]
        if isinstance(curve, NodalCurve):
            on_edges[start:stop] = _nodal_points(curve, plan, structure.topology, edge)
        else:
            on_edges[start:stop] = _curve_points(curve, plan.edge_parameters[start:stop], structure.topology, edge)
            on_edges[start], on_edges[stop - 1] = structure.vertices[structure.topology.edges[edge]]
    points[plan.edge_nodes] = on_edges
    for batch in plan.batches:
        part = batch
        if changed is not None:
            some = np.flatnonzero(changed[batch.blocks])
            part = batch if len(some) == len(batch.blocks) else batch.select(some)
        if part.inner.size:
            bottom, top, left, right = (points[nodes] for nodes in part.sides)
            _scatter(points, part.inner, interior_points(part.weights, bottom, top, left, right))


def _scatter(points: Array, nodes: Index, values: Array) -> None:
    """Set ``points[nodes] = values``; points as complex numbers are written ten times faster than as pairs."""
    if points.flags.c_contiguous:
        points.view(np.complex128)[:, 0][nodes.ravel()] = values.view(np.complex128).ravel()
    else:
        points[nodes] = values


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
    """Raise if det J of an element is not certainly positive.

    Raises
    ------
    InvalidMeshError
        Names how many elements are bad, the worst one, its block, (ξ, η) and (x, y).
    """
    bad = invalid_elements(mesh)
    if not len(bad):
        return
    plan = layout(structure, mesh.order)
    worst = bad[0]
    block = structure.topology.block_name(int(plan.block_of_cell[worst.element]))
    raise InvalidMeshError(
        f"{len(bad)} of {len(mesh.cells)} elements have det J <= 0 somewhere. Worst: element {worst.element} in "
        f"{block}, det J = {worst.det_J:.3g} at (xi, eta) = ({worst.xi:.3g}, {worst.eta:.3g}), "
        f"(x, y) = ({worst.x:.6g}, {worst.y:.6g}). {worst.reason}"
    )
