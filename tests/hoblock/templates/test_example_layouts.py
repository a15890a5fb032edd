"""`flag_in_channel` and the example scenes that spell out the same layouts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hoblock.building import build_structure
from hoblock.curves import Arc
from hoblock.io.scene import load_mesh_scene
from hoblock.templates import cylinder_in_channel, flag_in_channel

EXAMPLES = Path(__file__).parents[3] / "examples"


def example(name):
    path = EXAMPLES / f"{name}.toml"
    if not path.exists():
        pytest.skip("the examples are not beside these tests")
    return build_structure(load_mesh_scene(path))


def edges_of(structure):
    """Count, positions of the grading at three places and kind of geometry of every edge, by sorted names."""
    topology, places = structure.topology, np.array([0.2, 0.5, 0.9])
    found = {}
    for edge, ends in enumerate(topology.edges):
        first, second = (topology.vertex_names[v] for v in ends)
        grading = structure.gradings[edge]
        positions = grading(places) if first < second else 1.0 - grading(1.0 - places)
        curve = structure.curves.get(edge)
        circle = isinstance(getattr(curve, "curve", curve), Arc)
        found[min(first, second), max(first, second)] = (int(topology.counts[edge]), positions, circle)
    return found


def compare(structure, known, *, same_mesh):
    at = {name: structure.vertices[k] for k, name in enumerate(structure.topology.vertex_names)}
    for name, place in zip(known.topology.vertex_names, known.vertices, strict=True):
        np.testing.assert_allclose(at[name], place, rtol=1e-14, atol=1e-16, err_msg=name)
    assert set(structure.topology.edge_groups) == set(known.topology.edge_groups)
    found, expected = edges_of(structure), edges_of(known)
    assert set(found) == set(expected)
    for pair, (count, positions, circle) in expected.items():
        assert found[pair][2] == circle
        if same_mesh:
            assert found[pair][0] == count, pair
            np.testing.assert_allclose(found[pair][1], positions, atol=1e-14, err_msg=str(pair))


def test_wall_ramm():
    compare(flag_in_channel(body="square"), example("wall_ramm"), same_mesh=True)


def test_turek_hron():
    """The example has more elements at the clamp."""
    compare(flag_in_channel(), example("fsi1"), same_mesh=False)


def test_dfg_cylinder():
    compare(cylinder_in_channel(), example("dfg_2d_1"), same_mesh=True)
