import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import (
    BoundaryLayer,
    Cosine,
    Cubic,
    Exponential,
    Function,
    Geometric,
    Listed,
    Part,
    Pieces,
    Quadratic,
    Reversed,
    Tanh,
    TanhSpacing,
    Uniform,
    restrict,
    reverse,
)

S = np.linspace(0.0, 1.0, 101)
PLAIN = [
    Uniform(),
    Quadratic(0.7),
    Cubic(0.9),
    Exponential(-3.0),
    Tanh(3.0, "both"),
    Tanh(3.0, "second"),
    Cosine("first"),
    Function(np.expm1),
    Function(np.square),
    Part(Function(np.square), 0.2, 0.9),
]
ON_EDGES = [
    Geometric(total=4.0),
    Geometric(growth=0.8),
    TanhSpacing(0.01, 0.2),
    BoundaryLayer(0.01),
    BoundaryLayer(0.01, 1.5, ends="second"),
    BoundaryLayer(0.01, 1.2, 0.05, "both"),
    Pieces(),
    Pieces((5, 5, 2)),
]


@pytest.mark.parametrize("grading", [*PLAIN, *ON_EDGES, Listed((0, 0.3, 1))], ids=str)
def test_reversed_twice_is_the_grading(grading):
    twice = reverse(reverse(grading))
    assert twice == grading
    assert hash(twice) == hash(grading)


@pytest.mark.parametrize("grading", PLAIN, ids=str)
def test_reversed_is_the_grading_from_the_other_end(grading):
    np.testing.assert_allclose(reverse(grading)(S), 1.0 - grading(1.0 - S), atol=2e-15)
    np.testing.assert_allclose(Reversed(grading)(S), 1.0 - grading(1.0 - S), atol=2e-15)


@pytest.mark.parametrize("grading", ON_EDGES, ids=str)
def test_reversed_on_an_edge_is_the_grading_on_the_reversed_edge(edge, straight, grading):
    count = 12
    shape = edge(2.0, np.array([0.3, 0.8]))

    class Turned(straight):
        def parameters(self, lengths):
            return 1.0 - shape.parameters(2.0 - lengths)

    turned = Turned(2.0, 1.0 - shape.breaks[::-1])
    k = np.arange(count + 1) / count
    here = reverse(grading).resolved(shape, count)(k)
    there = grading.resolved(turned, count)(k)
    np.testing.assert_allclose(here, 1.0 - there[::-1], atol=1e-14)


def test_a_grading_on_an_edge_cannot_be_wrapped_as_a_plain_one():
    with pytest.raises(
        GradingError, match=r"reversed grading: Geometric.* depends on its edge; use reverse\(grading\)"
    ):
        Reversed(Geometric(growth=1.2))
    with pytest.raises(
        GradingError, match=r"part of a grading: Pieces.* its whole edge; use its resolved\(shape, count"
    ):
        Part(Pieces(), 0.0, 0.5)


@pytest.mark.parametrize("grading", PLAIN, ids=str)
def test_a_part_keeps_the_corners_of_the_whole(grading):
    whole = grading(np.arange(11) / 10)
    part = restrict(grading, 0.2, 0.7)
    np.testing.assert_allclose(part(np.arange(6) / 5), (whole[2:8] - whole[2]) / (whole[7] - whole[2]), atol=1e-14)
    np.testing.assert_allclose(Part(grading, 0.2, 0.7)(S), part(S), atol=1e-13)
    assert restrict(grading, 0.0, 1.0) == grading


def test_a_part_of_a_part_is_one_of_the_whole():
    part = Part(Part(Quadratic(0.5), 0.5, 1.0), 0.0, 0.5)
    assert part == Part(Quadratic(0.5), 0.5, 0.75)
    assert hash(part) == hash(Part(Quadratic(0.5), 0.5, 0.75))
    assert Part(Part(Quadratic(0.5), 0.1, 0.7), 0.5, 1.0).stop == 0.7


@pytest.mark.parametrize("ends", [(0.5, 0.5), (-0.1, 0.5), (0.5, 1.1), (0.7, 0.2), (float("nan"), 1.0)])
def test_parts_of_nothing_are_refused(ends):
    with pytest.raises(GradingError, match=r"part of a grading: from .*; expected 0 <= start < stop <= 1"):
        restrict(Quadratic(0.3), *ends)
