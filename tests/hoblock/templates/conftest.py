"""What the tests of templates measure."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock.mesh import QuadMesh
from hoblock.quality import det_jacobian
from hoblock.reference import tensor_quadrature


def area(mesh, group=None):
    """Area of a mesh or of one of its groups, exact for its element maps."""
    points, weights = tensor_quadrature(2 * mesh.order)
    det_J = det_jacobian(mesh, points)
    members = slice(None) if group is None else mesh.cell_groups[group]
    return float((det_J[members] @ weights).sum())


def first_heights(mesh: QuadMesh, name: str):
    """Lengths of the straight lines that leave a named boundary, at every node of it: (sides, p + 1)."""
    grid = mesh.points[mesh.cells].reshape(len(mesh.cells), mesh.order + 1, mesh.order + 1, 2)
    lines = []
    for element, side in mesh.edge_groups[name]:
        nodes = grid[element] if side in (0, 2) else grid[element].transpose(1, 0, 2)
        wall, opposite = (nodes[0], nodes[-1]) if side in (0, 3) else (nodes[-1], nodes[0])
        lines.append(np.hypot(*(opposite - wall).T))
    return np.array(lines)


@pytest.fixture(scope="session")
def measure_area():
    return area


@pytest.fixture(scope="session")
def measure_first_heights():
    return first_heights
