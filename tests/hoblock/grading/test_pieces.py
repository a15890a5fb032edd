import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import Pieces, Uniform, element_corners


def corners(grading, shape, count):
    return element_corners(grading.resolved(shape, count), count)


def test_corners_stand_on_the_breaks_exactly(edge):
    rng = np.random.default_rng(1234)
    for _ in range(50):
        breaks = np.sort(rng.random(rng.integers(1, 8)))
        count = int(rng.integers(len(breaks) + 1, 40))
        found = corners(Pieces(), edge(3.0, breaks), count)
        assert set(breaks) <= set(found)
        assert np.all(np.diff(found) > 0)


def test_elements_are_shared_out_by_arc_length(edge):
    shape = edge(10.0)
    shape = edge(10.0, shape.parameters(np.array([1.0, 4.0])))
    found = corners(Pieces(), shape, 10)
    inner = np.searchsorted(found, shape.breaks)
    assert np.diff([0, *inner, 10]).tolist() == [1, 3, 6]


def test_every_piece_gets_an_element_and_equal_pieces_are_no_lottery(straight):
    shape = straight(1.0, np.array([0.001, 0.002]))
    np.testing.assert_allclose(corners(Pieces(), shape, 4), [0, 0.001, 0.002, 0.501, 1], atol=1e-15)
    for noise in (-1e-12, 0.0, 1e-12):
        found = corners(Pieces(), straight(1.0, np.array([0.5 + noise])), 3)
        np.testing.assert_allclose(found, [0, 0.25, 0.5, 1], atol=1e-11)


def test_given_counts(straight):
    found = corners(Pieces((1, 3)), straight(1.0, np.array([0.4])), 4)
    np.testing.assert_allclose(found, [0, 0.4, 0.6, 0.8, 1], atol=1e-15)
    assert Pieces([1, 3]) == Pieces((1, 3))


def test_a_smooth_curve_is_one_piece(straight):
    assert Pieces().resolved(straight(), 7) == Uniform()
    np.testing.assert_array_equal(corners(Pieces((4,)), straight(), 4), np.arange(5) / 4)


@pytest.mark.parametrize(
    ("counts", "count", "match"),
    [
        (None, 2, "pieces: the curve has 3 pieces, the edge 2 elements; take at least 3 elements, or another grading"),
        ((2, 3), 5, r"counts \(2, 3\) are for 2 pieces and 5 elements; the curve has 3 pieces, the edge 5 elements"),
        ((1, 1, 1), 4, r"counts \(1, 1, 1\) are for 3 pieces and 3 elements; the curve has 3 pieces, the edge 4 elem"),
    ],
)
def test_pieces_that_do_not_fit(straight, counts, count, match):
    with pytest.raises(GradingError, match=match):
        Pieces(counts).resolved(straight(1.0, np.array([0.2, 0.4])), count)


@pytest.mark.parametrize("counts", [(), (0, 1), (1.5,), (True,)])
def test_impossible_counts_are_refused(counts):
    with pytest.raises(GradingError, match=r"pieces: counts are .*; expected whole numbers of at least 1, one a piece"):
        Pieces(counts)
