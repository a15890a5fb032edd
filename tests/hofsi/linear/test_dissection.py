"""Nested dissection of elements."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi.linear.dissection import dissect


def grid(nx, ny, drop=()):
    """Unknowns at the corners of nx × ny elements; some corners are none."""
    k = np.arange((nx + 1) * (ny + 1)).reshape(ny + 1, nx + 1)
    cells = np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]], axis=-1).reshape(-1, 4)
    cells = np.where(np.isin(cells, drop), -1, cells)
    x, y = np.meshgrid(np.arange(nx) + 0.5, np.arange(ny) + 0.5)
    return cells, np.stack([x.ravel(), y.ravel()], axis=-1)


@pytest.mark.parametrize("leaf", [1, 3, 8, 1000])
def test_every_unknown_is_eliminated_once_where_all_its_elements_are(leaf):
    cells, places = grid(9, 7, drop=(0, 11))
    fronts = dissect(cells, places, leaf)
    assert sorted(np.concatenate([f.unknowns[: f.eliminated] for f in fronts])) == sorted(set(range(80)) - {0, 11})
    assert sorted(np.concatenate([f.elements for f in fronts])) == list(range(63))
    inside = []
    for k, front in enumerate(fronts):
        assert all(child < k for child in front.children)
        assert len(front.elements) <= leaf
        members = np.concatenate([front.elements, *(inside[child] for child in front.children)]).astype(int)
        inside.append(members)
        outside = np.setdiff1d(np.arange(63), members)
        assert not np.isin(front.unknowns[: front.eliminated], cells[outside]).any()
        left = front.unknowns[front.eliminated :]
        assert np.isin(left, cells[outside]).all()
        assert np.isin(left, cells[members]).all()
    assert len(fronts[-1].unknowns) == fronts[-1].eliminated


def test_what_is_left_is_in_the_order_of_elimination():
    cells, places = grid(12, 12)
    fronts = dissect(cells, places, 4)
    order = {int(u): k for k, u in enumerate(np.concatenate([f.unknowns[: f.eliminated] for f in fronts]))}
    for front in fronts:
        positions = [order[int(u)] for u in front.unknowns]
        assert positions[front.eliminated :] == sorted(positions[front.eliminated :])
        assert positions[: front.eliminated] == sorted(positions[: front.eliminated])


def test_cuts_go_across_a_long_channel():
    cells, places = grid(64, 4)
    fronts = dissect(cells, places, 4)
    assert fronts[-1].eliminated == 5  # the corners of one line across
    assert max(len(front.unknowns) for front in fronts) <= 20


def test_cuts_follow_a_ring():
    """Elements around a hole, a cut of which is two radial lines."""
    cells, places = grid(40, 3)
    cells = np.where(cells % 41 == 40, cells - 40, cells)  # the last column is the first
    angle, radius = 2.0 * np.pi * places[:, 0] / 40.0, 1.0 + places[:, 1]
    fronts = dissect(cells, np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1), 4)
    assert fronts[-1].eliminated == 8


def test_parts_that_do_not_touch_are_joined_by_an_empty_front():
    cells, places = grid(3, 3)
    both = np.concatenate([cells, cells + 16])
    fronts = dissect(both, np.concatenate([places, places + np.array([10.0, 0.0])]), 9)
    assert [len(front.elements) for front in fronts] == [9, 9, 0]
    assert fronts[-1].eliminated == 0
    assert fronts[-1].children == (0, 1)


def test_one_element_and_none():
    (front,) = dissect(np.array([[2, 0, 1]]), np.zeros((1, 2)), 6)
    assert sorted(front.unknowns) == [0, 1, 2]
    (nothing,) = dissect(np.zeros((0, 3), dtype=np.int64), np.zeros((0, 2)), 6)
    assert not nothing.unknowns.size
