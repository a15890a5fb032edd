"""Matching nodes of fluid and solid."""

import numpy as np
import pytest

from hoblock import Arc, BlockStructure, Exponential, generate
from hofsi.coupling.interface import match_interface


@pytest.mark.parametrize("order", [2, 3, 5])
def test_matched_nodes_coincide(order):
    vertices = {"a": (0, 0), "b": (2, 0), "c": (2, 1), "d": (0, 1), "e": (2, 2), "f": (0, 2), "g": (3, 0), "h": (3, 1)}
    blocks = {"fluid": [("d", "c", "e", "f")], "solid": [("b", "c", "d", "a"), ("g", "h", "c", "b")]}
    arc = Arc.through(np.array([2.0, 1.0]), np.array([1.0, 1.2]), np.array([0.0, 1.0]))
    whole = BlockStructure.build(
        vertices,
        blocks,
        counts={("c", "d"): 3, ("g", "b"): 2},
        curves={("c", "d"): arc},
        gradings={("d", "c"): Exponential(1.2)},
    )
    fluid, solid = whole.restricted(["fluid"]), whole.restricted(["solid"])
    interface = match_interface(fluid, solid, order)
    x, y = generate(fluid, order).points[interface.fluid], generate(solid, order).points[interface.solid]
    assert len(x) == 3 * order + 1
    assert len(interface.fluid_edges) == 1
    np.testing.assert_array_equal(x, y)
    assert (np.diff(interface.fluid) > 0).all()
