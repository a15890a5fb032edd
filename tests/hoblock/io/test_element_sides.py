import numpy as np
import pytest

from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.grading import Exponential
from hoblock.io.element_sides import neighbours, transfinite_deviation


def test_interiors_are_transfinite_unless_both_pairs_of_gradings_differ(layouts):
    bumps = {("a", "b"): layouts.bump((0, 0), (1, 0), 0.1), ("b", "c"): layouts.bump((1, 0), (1, 1), 0.1)}

    def mesh(*edges):
        gradings = {edge: Exponential(1.5) for edge in edges}
        return generate(layouts.square(counts=3, gradings=gradings, curves=bumps), 5)

    for edges in (
        [],
        [("a", "b"), ("d", "c"), ("a", "d"), ("b", "c")],
        [("a", "b")],
        [("a", "b"), ("d", "c"), ("a", "d")],
    ):
        assert transfinite_deviation(mesh(*edges)) < 1e-14
    assert 1e-7 < transfinite_deviation(mesh(("a", "b"), ("a", "d"))) < 1e-2


def test_overlapping_elements_are_refused():
    with pytest.raises(MeshFileError, match="edge between corners 0 and 1 has two elements on the same side"):
        neighbours(np.array([[0, 1, 2, 3], [0, 1, 4, 5]]))
