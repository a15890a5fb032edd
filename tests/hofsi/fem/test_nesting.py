from __future__ import annotations

import numpy as np
import pytest

from hofsi.fem.nesting import nested

NONE = np.zeros(0, dtype=np.int64)


def grid(columns, rows, turns=None):
    """Corners of a grid of quads, row by row; ``turns`` says where each begins to count."""
    number = np.arange((columns + 1) * (rows + 1)).reshape(rows + 1, columns + 1)
    corners = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
    if turns is not None:
        corners = np.stack([np.roll(quad, turn) for quad, turn in zip(corners, turns, strict=True)])
    return corners


def test_even_grid_is_halved():
    nesting = nested(grid(4, 2), NONE)
    np.testing.assert_array_equal(nesting.parent, [0, 0, 1, 1, 0, 0, 1, 1])
    np.testing.assert_array_equal(nesting.part, [[1, 1], [2, 1], [1, 1], [2, 1], [1, 2], [2, 2], [1, 2], [2, 2]])
    np.testing.assert_array_equal(nesting.turn, 0)
    np.testing.assert_array_equal(nesting.corners, [[0, 2, 12, 10], [2, 4, 14, 12]])


@pytest.mark.parametrize(("columns", "elements"), [(1, 1), (2, 1), (3, 2), (5, 3), (6, 3), (7, 4), (10, 5)])
def test_pairs_are_as_many_as_possible_in_each_direction(columns, elements):
    nesting = nested(grid(columns, 2), NONE)
    assert len(nesting.corners) == elements
    assert set(nesting.corners.ravel()) <= {*range(columns + 1), *range(2 * columns + 2, 3 * columns + 3)}


def test_single_element_remains():
    assert nested(grid(1, 1), NONE) is None


def test_orientation_of_the_elements_does_not_matter():
    turns = np.random.default_rng(17).integers(0, 4, 24)
    nesting = nested(grid(6, 4, turns), NONE)
    assert len(nesting.corners) == 6
    corners = grid(6, 4, turns)
    for element, (parent, part, turn) in enumerate(zip(nesting.parent, nesting.part, nesting.turn, strict=True)):
        corner = {(1, 1): 0, (2, 1): 1, (2, 2): 2, (1, 2): 3}[tuple(part)]
        assert corners[element, (corner + turn) % 4] == nesting.corners[parent, corner]
    assert {frozenset(quad) for quad in nesting.corners} == {
        frozenset(quad) for quad in nested(grid(6, 4), NONE).corners
    }


def test_wanted_vertices_stay_corners():
    corners = grid(4, 4)
    nesting = nested(corners, np.array([1]))  # on the boundary, between two coarse vertices otherwise
    assert 1 in nesting.corners
    nesting = nested(corners, np.array([6]))
    assert 6 in nesting.corners
    assert len(nesting.corners) == 9


def test_irregular_vertices_stay_corners():
    """Three blocks of 2 x 2 elements round a vertex."""
    outer = np.array([np.exp(2j * np.pi * k / 6) for k in range(6)])
    places, corners = {}, []

    def number(z):
        return places.setdefault((round(z.real, 6), round(z.imag, 6)), len(places))

    for k in range(3):
        a, b, c = outer[2 * k], outer[2 * k + 1], outer[(2 * k + 2) % 6]
        points = [
            [(1 - s) * (1 - t) * 0 + s * (1 - t) * a + s * t * b + (1 - s) * t * c for s in (0, 0.5, 1)]
            for t in (0, 0.5, 1)
        ]
        for j in range(2):
            for i in range(2):
                quad = points[j][i], points[j][i + 1], points[j + 1][i + 1], points[j + 1][i]
                corners.append([number(z) for z in quad])
    nesting = nested(np.array(corners), NONE)
    assert len(nesting.corners) == 3
    assert (nesting.corners == number(0j)).sum() == 3


@pytest.mark.parametrize(("sectors", "coarse"), [(8, 4), (6, 3), (5, 3), (4, 4), (3, 3)])
def test_closed_rings_keep_three_elements(sectors, coarse):
    circle = np.arange(sectors)
    rings = [np.stack([k + circle, k + sectors + circle], axis=-1) for k in (0, sectors)]
    corners = np.concatenate(
        [np.stack([r[:, 0], r[:, 1], np.roll(r[:, 1], -1), np.roll(r[:, 0], -1)], axis=-1) for r in rings]
    )
    nesting = nested(corners, NONE)
    assert len(nesting.corners) == coarse
    sides = {frozenset(pair) for quad in nesting.corners for pair in zip(quad, np.roll(quad, -1), strict=True)}
    assert len(sides) == 3 * coarse


def test_only_the_shorter_lengths_of_thin_elements_are_doubled():
    lengths = np.tile([1.0, 0.1], (16, 1))
    nesting = nested(grid(4, 4), NONE, lengths)
    assert len(nesting.corners) == 8
    np.testing.assert_array_equal(nesting.part[:, 0], 0)
    turned = nested(grid(4, 4, np.ones(16, dtype=int)), NONE, lengths[:, ::-1])
    assert {frozenset(quad) for quad in turned.corners} == {frozenset(quad) for quad in nesting.corners}
    assert len(nested(grid(4, 4), NONE, np.tile([1.0, 0.5], (16, 1))).corners) == 4
