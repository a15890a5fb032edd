"""How far the interface may end from where it was predicted."""

import numpy as np
import pytest

from hoblock import BlockStructure, generate
from hofsi.coupling.gap import InterfaceGap
from hofsi.errors import CouplingError


def channel():
    """Elements of 0.5 × 0.08 above the interface y = 0."""
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.16), (0.0, 0.16)]
    structure = BlockStructure.build(corners, {"fluid": [(0, 1, 2, 3)]}, counts=2, edges={"bottom": [(0, 1)]})
    mesh = generate(structure, 3)
    return mesh, mesh.edge_nodes("bottom")


def test_a_gap_below_half_of_the_elements_is_a_matter_of_accuracy():
    mesh, nodes = channel()
    gap = np.zeros((len(nodes), 2))
    gap[2] = [0.06, -0.07]  # 0.092; the elements are sqrt(0.5 · 0.08) = 0.2
    InterfaceGap(mesh, nodes).check(gap, "here")


def test_a_larger_one_is_an_error_that_says_where():
    mesh, nodes = channel()
    gap = np.zeros((len(nodes), 2))
    k = int(np.argmin(np.abs(mesh.points[nodes, 0] - 0.5)))
    gap[k] = [0.0, 0.11]
    with pytest.raises(
        CouplingError, match=r"ends 0.11 from where .* at \(0.5, 0\); expected less than half .* 0\.2\."
    ) as e:
        InterfaceGap(mesh, nodes).check(gap, "coupling, t = 3")
    assert e.value.reason == "geometry"
