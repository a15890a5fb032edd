import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.plot import block_outlines, element_outlines, group_outlines
from hoblock.plot.outlines import boundary_sides


def shoelace(polygons):
    x, y = polygons[..., 0], polygons[..., 1]
    return 0.5 * (x * np.roll(y, -1, axis=-1) - y * np.roll(x, -1, axis=-1)).sum(axis=-1)


def test_outlines_are_curved_and_counter_clockwise(layouts):
    mesh = generate(layouts.annulus(4), 5)
    outlines = element_outlines(mesh)
    assert outlines.shape == (4, 80, 2)
    assert shoelace(outlines).sum() == pytest.approx(3 * np.pi, rel=2e-3)
    chords = element_outlines(mesh, samples=1)
    assert shoelace(chords).sum() == pytest.approx(6.0)  # the squares through the vertices
    radius = np.hypot(*np.moveaxis(outlines, -1, 0))
    assert np.sum(np.abs(radius - 1) < 1e-4) == 4 * 21
    assert element_outlines(generate(layouts.square(counts=2), 1)).shape == (4, 4, 2)


def test_block_outlines_follow_the_edges(layouts):
    structure = layouts.annulus(3, counts=2)
    mesh = generate(structure, 4)
    lines = block_outlines(mesh, structure)
    assert len(lines) == 9
    for edge, line in enumerate(lines):
        assert line.shape == (33, 2)
        np.testing.assert_allclose(line[[0, -1]], structure.vertices[structure.topology.edges[edge]], atol=1e-14)
        if edge in structure.curves:
            radius = np.hypot(*line.T)
            np.testing.assert_allclose(radius, radius[0], rtol=2e-3)


def test_group_outlines_follow_the_curve(layouts):
    mesh = generate(layouts.annulus(4, counts=2), 5)
    lines = group_outlines(mesh, samples=6)
    assert lines["outer"].shape == (8, 7, 2)
    np.testing.assert_allclose(np.hypot(*np.moveaxis(lines["outer"], -1, 0)), 2.0, atol=1e-5)


def test_boundary_sides(layouts):
    mesh = generate(layouts.annulus(4, counts=2), 2)
    found = {tuple(side) for side in boundary_sides(mesh).tolist()}
    assert found == {tuple(side) for sides in mesh.edge_groups.values() for side in sides.tolist()}
