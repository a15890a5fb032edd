"""Gradings of scenes become those of block edges."""

import tomllib

import numpy as np
import pytest

from hoblock.building import build_structure
from hoblock.errors import ExpressionError, GradingError
from hoblock.generate import generate
from hoblock.grading import (
    BoundaryLayer,
    Cosine,
    Function,
    Geometric,
    Listed,
    Pieces,
    Tanh,
    TanhSpacing,
    reverse,
)
from hoblock.io.scene import read_mesh_scene

HEAD = """
[mesh]
order = 3
elements = 6
[mesh.vertices]
a = [0, 0]
b = [1, 0]
c = [1, 1]
d = [0, 1]
[mesh.blocks]
fluid = [["a", "b", "c", "d"]]
"""


def built(text):
    return build_structure(read_mesh_scene(tomllib.loads(HEAD + text), "box.toml"))


def on(structure, first, second):
    topology = structure.topology
    edge, forward = topology.edge(topology.vertex(first), topology.vertex(second))
    return structure.gradings[edge] if forward else reverse(structure.gradings[edge])


@pytest.mark.parametrize(
    ("keys", "grading"),
    [
        ('kind = "geometric"\ntotal = 20', Geometric(total=20)),
        ('kind = "geometric"\ngrowth = 1.1', Geometric(growth=1.1)),
        ('kind = "tanh"\nstrength = 3', Tanh(3.0)),
        ('kind = "tanh"\nstrength = 3\nends = "second"', Tanh(3.0, "second")),
        ('kind = "tanh"\nsecond = 0.01', TanhSpacing(None, 0.01)),
        ('kind = "tanh"\nfirst = 0.01\nsecond = 0.1\nunit = "fraction"', TanhSpacing(0.01, 0.1, "fraction")),
        ('kind = "cosine"', Cosine("both")),
        ('kind = "boundary-layer"\nfirst_height = 0.01\nends = "second"', BoundaryLayer(0.01, ends="second")),
        (
            'kind = "boundary-layer"\nfirst_height = 0.01\ngrowth = 1.3\nthickness = 0.03',
            BoundaryLayer(0.01, 1.3, 0.03),
        ),
        ('kind = "list"\nsizes = [1, 1, 2, 4, 4, 4]', Listed.of_sizes((1, 1, 2, 4, 4, 4))),
        (
            'kind = "list"\npositions = [0, 0.1, 0.2, 0.4, 0.6, 0.8, 1]',
            Listed((0, 0.1, 0.2, 0.4, 0.6, 0.8, 1)),
        ),
        ('kind = "pieces"\ncounts = [6]', Pieces((6,))),
    ],
)
def test_every_kind_on_edges_in_either_direction(keys, grading):
    structure = built(f'[[mesh.grading]]\non = [["a", "b"], ["c", "d"], ["d", "a"]]\n{keys}\n')
    for first, second in ("ab", "cd", "da"):
        assert on(structure, first, second) == grading
    assert generate(structure, 3).cells.shape == (36, 16)


def test_equal_formulas_are_equal_gradings_wherever_they_stand():
    entry = '[[mesh.grading]]\non = [["{}", "{}"]]\nkind = "function"\nvalue = "{}"\n'
    structure = built(entry.format(*"ab", "s**2") + entry.format(*"dc", "s**2") + entry.format(*"bc", "s**3"))
    assert isinstance(on(structure, "a", "b"), Function)
    assert on(structure, "a", "b") == on(structure, "d", "c")
    assert hash(on(structure, "a", "b")) == hash(on(structure, "d", "c"))
    assert on(structure, "a", "b") != on(structure, "b", "c")
    np.testing.assert_allclose(on(structure, "a", "b")(np.array([0.5])), 0.25)
    mesh = generate(structure, 3)
    assert np.abs(mesh.points - [1 / 36, 0]).sum(axis=1).min() < 1e-15


@pytest.mark.parametrize(
    ("keys", "error", "match"),
    [
        (
            'kind = "function"\nvalue = "1 - s"',
            GradingError,
            r"^mesh\.grading\[0\]: function grading: the value is 1 at",
        ),
        ('kind = "function"\nvalue = "log(s)"', ExpressionError, r"^mesh\.grading\[0\]\.value: .* at s = 0"),
        (
            'kind = "list"\npositions = [0.1, 1]',
            GradingError,
            r"^mesh\.grading\[0\]: listed grading: the positions are \[0\.1, 1\. \]; expected them to begin with 0",
        ),
        (
            'kind = "boundary-layer"\nfirst_height = 0.1\nthickness = 0.2',
            GradingError,
            r"^mesh\.grading\[0\]: boundary layer: a thickness without a growth",
        ),
    ],
)
def test_impossible_gradings_name_their_place(keys, error, match):
    with pytest.raises(error, match=match):
        built(f'[[mesh.grading]]\non = [["a", "b"]]\n{keys}\n')


def test_gradings_that_do_not_fit_their_edge_name_it():
    layer = 'kind = "boundary-layer"\nfirst_height = 1e-4\ngrowth = 1.2'
    with pytest.raises(GradingError, match=r"^edge a–b: boundary layer: 6 elements from 0\.0001 growing by 1\.2 reach"):
        generate(built(f'[[mesh.grading]]\non = [["b", "a"]]\n{layer}\n'), 3)
    with pytest.raises(GradingError, match=r"^edge a–b: the grading lists 3 elements, the edge has 6"):
        generate(built('[[mesh.grading]]\non = [["b", "a"]]\nkind = "list"\nsizes = [1, 2, 3]\n'), 3)
