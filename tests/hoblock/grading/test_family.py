"""What holds for every grading with any parameters and any number of elements."""

import numpy as np
import pytest

pytest.importorskip("hypothesis")

from hypothesis import given, settings
from hypothesis import strategies as st

from hoblock.grading import (
    BoundaryLayer,
    Cosine,
    Cubic,
    EdgeGrading,
    Exponential,
    Geometric,
    Listed,
    Part,
    Pieces,
    Quadratic,
    Tanh,
    TanhSpacing,
    Uniform,
    element_corners,
    node_parameters,
    reverse,
)


class Edge:
    """An edge of some length whose speed at the second end is ``speed`` times that at the first, with breaks."""

    def __init__(self, length, speed, breaks=()):
        self.length = length
        self.breaks = np.array(breaks, dtype=float)
        self._c = (speed - 1.0) / 2.0

    def lengths(self, t):
        t = np.asarray(t)
        return self.length * (t + self._c * t * t) / (1.0 + self._c)

    def parameters(self, lengths):
        x = np.asarray(lengths) / self.length * (1.0 + self._c)
        return 2.0 * x / (1.0 + np.sqrt(1.0 + 4.0 * self._c * x))


ENDS = st.sampled_from(["first", "second", "both"])
COUNTS = st.integers(1, 60)


def numbers(low, high):
    return st.floats(low, high, allow_nan=False)


PLAIN = st.one_of(
    st.just(Uniform()),
    numbers(-0.999, 0.999).map(Quadratic),
    numbers(0.0, 0.999).map(Cubic),
    numbers(-20.0, 20.0).map(Exponential),
    st.builds(Tanh, numbers(0.0, 15.0), ENDS),
    st.builds(Cosine, ENDS),
)
PARTS = st.builds(Part, PLAIN, numbers(0.0, 0.45), numbers(0.55, 1.0))


@st.composite
def edges_with_gradings(draw):
    """A count, an edge, and a grading that can be met on it."""
    count = draw(st.integers(4, 60))
    length = draw(numbers(0.1, 50.0))
    speed = draw(numbers(0.3, 4.0))
    pieces = draw(st.integers(1, 4))
    breaks = np.cumsum(draw(st.lists(numbers(0.05, 1.0), min_size=pieces, max_size=pieces)))
    edge = Edge(length, speed, breaks[:-1] / breaks[-1])
    small = draw(numbers(1e-5, 0.4)) * length
    other = draw(numbers(1e-5, 0.4)) * length
    even = length / count
    growth = draw(numbers(1.0, 2.5))
    grading = draw(
        st.sampled_from(
            [
                Geometric(total=draw(numbers(1e-4, 1e4))),
                Geometric(growth=draw(numbers(0.75, 1.3))),
                TanhSpacing(small),
                TanhSpacing(None, small),
                TanhSpacing(small, other),
                TanhSpacing(small / length, other / length, "fraction"),
                BoundaryLayer(min(small, 2.0 * even), ends="first"),
                BoundaryLayer(min(small, even), ends=draw(ENDS)),
                BoundaryLayer(even / growth, 2.0 * growth, ends=draw(ENDS)),
                Pieces(),
            ]
        )
    )
    return grading, edge, count


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.one_of(PLAIN, PARTS), COUNTS)
def test_plain_gradings(grading, count):
    corners = element_corners(grading, count)
    assert len(corners) == count + 1
    assert (corners[0], corners[-1]) == (0.0, 1.0)
    assert np.all(np.diff(corners) > 0)
    np.testing.assert_allclose(element_corners(reverse(grading), count), 1 - corners[::-1], atol=1e-14)
    assert reverse(reverse(grading)) == grading
    assert np.all(np.diff(node_parameters(grading, count, 5)) > 0)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(edges_with_gradings())
def test_gradings_on_edges(case):
    grading, edge, count = case
    assert isinstance(grading, EdgeGrading)
    resolved = grading.resolved(edge, count)
    assert not isinstance(resolved, EdgeGrading)
    assert resolved == grading.resolved(edge, count)
    assert hash(resolved) == hash(grading.resolved(edge, count))
    corners = element_corners(resolved, count)
    assert np.all(np.diff(corners) > 0)
    sizes = np.diff(edge.lengths(corners))
    close = {"rel": 1e-11, "abs": 1e-13 * edge.length}
    match grading:
        case Geometric(total=None, growth=growth):
            ratios = np.diff(corners)[1:] / np.diff(corners)[:-1]
            np.testing.assert_allclose(ratios, growth, rtol=1e-6)
        case Geometric(total=total):
            assert np.diff(corners)[-1] / np.diff(corners)[0] == pytest.approx(total, rel=1e-8)
        case TanhSpacing(first, second, unit):
            scale = edge.length if unit == "fraction" else 1.0
            assert first is None or sizes[0] == pytest.approx(first * scale, **close)
            assert second is None or sizes[-1] == pytest.approx(second * scale, **close)
        case BoundaryLayer(first, growth, _, ends):
            assert ends == "second" or sizes[0] == pytest.approx(first, **close)
            assert ends == "first" or sizes[-1] == pytest.approx(first, **close)
            ratios = sizes[1:] / sizes[:-1]
            assert growth is None or np.all(np.maximum(ratios, 1 / ratios) <= growth * (1 + 1e-6))
        case Pieces():
            assert set(edge.breaks) <= set(corners)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(st.lists(numbers(1e-3, 1.0), min_size=1, max_size=60))
def test_listed_sizes(sizes):
    grading = Listed.of_sizes(sizes)
    corners = element_corners(grading, len(sizes))
    np.testing.assert_allclose(np.diff(corners) * sum(sizes), sizes, rtol=1e-9)
    np.testing.assert_allclose(element_corners(reverse(grading), len(sizes)), 1 - corners[::-1], atol=1e-14)
    assert reverse(reverse(grading)) == grading
