"""Meshes for scikit-fem with curved elements of any order and with all names."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.numbering import number_nodes
from hoblock.orientation import orient

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["lagrange_element", "node_dofs", "to_skfem"]

_TURNS = np.array([[0, 1, 2, 3], [1, 2, 3, 0], [2, 3, 0, 1], [3, 0, 1, 2]])


def to_skfem(mesh: QuadMesh) -> Any:
    """Return the mesh for scikit-fem, its curved geometry, boundaries and subdomains included.

    ``Basis(m, element)`` and ``FacetBasis(m, element, facets=m.boundaries["wall"])`` assemble on the curved elements
    without further arguments; ``m.mapping()`` is the map itself. `lagrange_element` gives an element of any order.
    ``m.p`` and ``m.t`` are the corners.

    Parameters
    ----------
    mesh : QuadMesh
        Of any order p.

    Returns
    -------
    skfem.MeshQuad1
        A subclass of it. ``m.boundaries`` holds the groups of element sides; sides inside the mesh are oriented, their
        normals point out of the element that the group names. ``m.subdomains`` holds the groups of elements.

    Raises
    ------
    TopologyError
        If a side belongs to more than two elements.

    Notes
    -----
    Elements that do not walk a common side in the same direction (possible in meshes from files) are turned, so that
    any order of field is continuous; `node_dofs` knows of it.
    """
    from hoblock.io.skfem_mesh import CurvedMeshQuad

    t, count = number_nodes(mesh.corners, 1)
    t = t[:, [0, 1, 3, 2]]  # counter-clockwise
    turns = _turns(t)
    p = np.empty((count, 2))
    p[t] = mesh.points[mesh.corners]
    elements = np.arange(len(t))[:, None]
    curved = CurvedMeshQuad.from_nodes(
        p.T, t[elements, _TURNS[turns]].T, turned(mesh.coordinates, mesh.order, turns), mesh.order, turns
    )
    boundaries = {name: _facets(curved, sides, turns) for name, sides in mesh.edge_groups.items()}
    subdomains = {name: np.unique(members).astype(np.int32) for name, members in mesh.cell_groups.items()}
    return curved.named(boundaries, subdomains)


def lagrange_element(order: int) -> Any:
    """Return the scikit-fem element of order q whose degrees of freedom are values at the (q + 1)² GLL nodes.

    Parameters
    ----------
    order : int
        Order q ≥ 1; it may differ from that of the geometry.

    Raises
    ------
    ValueError
        If the order is below one.

    Notes
    -----
    scikit-fem's own ``ElementQuad1``, ``ElementQuad2`` and ``ElementQuadP`` work on these meshes as well, the last one
    with hierarchical degrees of freedom, which are no nodal values.
    """
    from hoblock.io.skfem_element import ElementQuadGLL

    return ElementQuadGLL(order)


def node_dofs(basis: Any, cells: Index) -> Index:
    """Degrees of freedom at the nodes of a numbering: ``u[node_dofs(basis, mesh.cells)]`` are nodal values.

    Parameters
    ----------
    basis : skfem.Basis
        On a mesh from `to_skfem`, with `lagrange_element` of order q or a vector or composite element of equal parts
        of it (``ElementVector(lagrange_element(q))``).
    cells : ndarray, shape (e, (q + 1)²)
        Nodes of the elements in hoblock's order: ``mesh.cells`` if q is the order of the mesh, else those of
        ``number_nodes(mesh.corners, q)``.

    Returns
    -------
    ndarray, shape (n,), or (n, d) for a vector of d components

    Raises
    ------
    ValueError
        If the element is no Lagrange element, or order or number of elements do not fit the cells.
    """
    element, parts = basis.elem, 1
    while hasattr(element, "elem"):
        parts, element = parts * element.dim, element.elem
    order = _order_of(element)
    if cells.shape != (basis.mesh.nelements, (order + 1) ** 2):
        raise ValueError(
            f"node_dofs: cells have shape {cells.shape}; expected {(basis.mesh.nelements, (order + 1) ** 2)} for "
            f"elements of order {order}. Number the nodes of that order with hoblock.numbering.number_nodes."
        )
    from hoblock.node_order import node_order

    nodes = turned(cells, order, basis.mesh.turns)[:, node_order(order, "skfem")]  # (e, i)
    dofs = basis.dofs.element_dofs.T.reshape(*nodes.shape, parts)
    result = np.empty((int(cells.max()) + 1, parts), dtype=np.int64)
    result[nodes] = dofs
    return result[:, 0] if parts == 1 else result


def _order_of(element: Any) -> int:
    from skfem.element import ElementQuad1, ElementQuad2

    from hoblock.io.skfem_element import ElementQuadGLL

    if isinstance(element, ElementQuadGLL):
        return element.order
    for order, kind in ((1, ElementQuad1), (2, ElementQuad2)):
        if isinstance(element, kind):
            return order
    raise ValueError(
        f"node_dofs: the element is {type(element).__name__}, whose degrees of freedom are no nodal values; expected "
        "one from hoblock.io.skfem.lagrange_element."
    )


def turned(values: NDArray[Any], order: int, turns: Index) -> NDArray[Any]:
    """Values (e, (p + 1)², …) at lexicographic nodes after each element is turned to begin at another corner.

    Parameters
    ----------
    values : ndarray
    order : int
    turns : ndarray, shape (e,)
        The corner, 0 to 3, that becomes corner 0.
    """
    if not turns.any():
        return values
    grid = np.arange((order + 1) ** 2).reshape(order + 1, order + 1)
    # Corner 1 becomes corner 0: the new first row is the old right side, upwards.
    orders = np.stack([np.rot90(grid, k, axes=(0, 1)).ravel() for k in range(4)])
    return np.asarray(values[np.arange(len(values))[:, None], orders[turns]])


def _turns(corners: Index) -> Index:
    """By how many corners each element must be turned so that neighbours walk common sides in the same direction."""
    sides = corners[:, [[0, 1], [1, 2], [3, 2], [0, 3]]].reshape(-1, 2)
    undirected, uses = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    if uses.max() <= 2 and len(np.unique(sides, axis=0)) == len(undirected):
        return np.zeros(len(corners), dtype=np.int64)
    return orient(corners, [str(k) for k in range(int(corners.max()) + 1)])[3]


def _facets(mesh: Any, sides: Index, turns: Index) -> Any:
    """Facets of a group; inside the mesh they are oriented, so that normals point out of the group's elements."""
    from skfem.generic_utils import OrientedBoundary

    element, side = sides.T
    facets, first = np.unique(mesh.t2f[(side - turns[element]) % 4, element], return_index=True)
    second = (mesh.f2t[0, facets] != element[first]).astype(int)
    facets = facets.astype(np.int32)
    return OrientedBoundary(facets, second) if second.any() else facets
