"""``[[mesh.grading]]``: every kind, its keys, and what is wrong with them."""

import tomllib

import numpy as np
import pytest

from hoblock.errors import SceneError
from hoblock.io.scene import read_mesh_scene

HEAD = """
[constants]
h = 1e-4
n = 3
[mesh]
order = 2
[mesh.vertices]
a = [0, 0]
b = [1, 0]
c = [1, 1]
d = [0, 1]
[mesh.blocks]
fluid = [["a", "b", "c", "d"]]
[mesh.edges]
wall = [["a", "b"]]
[[mesh.grading]]
on = "wall"
"""


def grading(text):
    (entry,) = read_mesh_scene(tomllib.loads(HEAD + text), "box.toml").gradings
    return entry


@pytest.mark.parametrize(
    ("text", "kind", "values"),
    [
        ('kind = "uniform"', "uniform", {}),
        ('kind = "quadratic"\nm = "1/2"', "quadratic", {"m": 0.5}),
        ('kind = "cubic"\nm = 0', "cubic", {"m": 0.0}),
        ('kind = "exponential"\na = "-n"', "exponential", {"a": -3.0}),
        ('kind = "geometric"\ntotal = 20', "geometric", {"total": 20.0}),
        ('kind = "geometric"\ngrowth = 0.9', "geometric", {"growth": 0.9}),
        ('kind = "tanh"\nstrength = "2*n"', "tanh", {"strength": 6.0}),
        ('kind = "tanh"\nstrength = 2\nends = "both"', "tanh", {"strength": 2.0, "ends": "both"}),
        ('kind = "tanh"\nfirst = "h"', "tanh", {"first": 1e-4}),
        (
            'kind = "tanh"\nfirst = 0.01\nsecond = 0.1\nunit = "fraction"',
            "tanh",
            {"first": 0.01, "second": 0.1, "unit": "fraction"},
        ),
        ('kind = "cosine"', "cosine", {}),
        ('kind = "cosine"\nends = "second"', "cosine", {"ends": "second"}),
        ('kind = "boundary-layer"\nfirst_height = "h"', "boundary-layer", {"first_height": 1e-4}),
        (
            'kind = "boundary-layer"\nfirst_height = "h"\ngrowth = 1.2\nthickness = "50*h"\nends = "both"',
            "boundary-layer",
            {"first_height": 1e-4, "growth": 1.2, "thickness": 50e-4, "ends": "both"},
        ),
        ('kind = "list"\npositions = [0, "1/10", 0.3, 1]', "list", {"positions": (0.0, 0.1, 0.3, 1.0)}),
        ('kind = "list"\nsizes = [1, "n", 4]', "list", {"sizes": (1.0, 3.0, 4.0)}),
        ('kind = "pieces"', "pieces", {}),
        ('kind = "pieces"\ncounts = [2, 3]', "pieces", {"counts": (2, 3)}),
    ],
)
def test_kinds(text, kind, values):
    entry = grading(text)
    assert (entry.kind, dict(entry.values), entry.place) == (kind, values, "mesh.grading[0]")
    assert entry.on == (("a", "b"),)


def test_functions_are_expressions_in_s():
    (value,) = grading('kind = "function"\nvalue = "s**n"').values.values()
    assert value.place == "mesh.grading[0].value"
    np.testing.assert_allclose(value.evaluate(s=[0.0, 0.5, 1.0]), [0, 0.125, 1])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('kind = "boundary_layer"', r"\.kind: got 'boundary_layer'\. Did you mean 'boundary-layer'\? Expected one of"),
        ('kind = "boundary-layer"', r"\.first_height: the required key is missing"),
        ('kind = "boundary-layer"\nheight = 1', r"\.first_height: the required key is missing\. Is it misspelt as 'he"),
        ('kind = "boundary-layer"\nfirst_height = 0', r"\.first_height: got 0; expected a number above 0"),
        ('kind = "boundary-layer"\nfirst_height = "-h"', r"\.first_height: got -0\.0001; expected a number above 0"),
        ('kind = "boundary-layer"\nfirst_height = "H"', r"\.first_height: expression \"H\": the name 'H' is not known"),
        ('kind = "boundary-layer"\nfirst_height = true', r"\.first_height: got the boolean true; expected a number"),
        (
            'kind = "boundary-layer"\nfirst_height = 1\ngrowth = 0.9',
            r"\.growth: got 0.9; expected a number of at least 1",
        ),
        (
            'kind = "boundary-layer"\nfirst_height = 1\nends = "left"',
            r"\.ends: got 'left'\. Expected one of 'first', 's",
        ),
        (
            'kind = "geometric"',
            r": a grading with none of 'total', 'growth'; expected exactly one of 'total', 'growth'",
        ),
        (
            'kind = "geometric"\ntotal = 2\ngrowth = 2',
            r": a grading with 'total' and 'growth'; expected exactly one of",
        ),
        ('kind = "geometric"\nratio = 2', r": a grading with none of 'total', 'growth'"),
        ('kind = "tanh"', r": a tanh grading with neither 'strength' nor 'first' or 'second'; expected its strength"),
        ('kind = "tanh"\nstrength = 1\nsecond = 1', r": a tanh grading with both 'strength' and 'second'"),
        ('kind = "tanh"\nstrength = 31', r"\.strength: got 31; expected a number of at least 0 and of at most 30"),
        (
            'kind = "tanh"\nfirst = 1\nends = "both"',
            r"\.ends: unknown key\. .*Known keys: leaving, on, kind, first, second, stre",
        ),
        ('kind = "tanh"\nfirst = 1\nunit = "fraction"', r"\.first: got 1; expected a number above 0 and below 1"),
        ('kind = "cosine"\nends = 2', r"\.ends: got the number 2; expected one of 'first', 'second', 'both'"),
        ('kind = "list"', r": a grading with none of 'positions', 'sizes'"),
        ('kind = "list"\nsizes = 3', r"\.sizes: got the number 3; expected a list of numbers, at least one"),
        ('kind = "list"\nsizes = []', r"\.sizes: got an empty list; expected a list of numbers"),
        ('kind = "list"\nsizes = [1, 0]', r"\.sizes\[1\]: got 0; expected a number above 0"),
        (
            'kind = "list"\npositions = [0, "n", 1]',
            r"\.positions\[1\]: got 3\.0; expected a number of at least 0 and of a",
        ),
        ('kind = "function"', r"\.value: the required key is missing"),
        ('kind = "function"\nvalue = "x"', r"\.value: expression \"x\": the name 'x' has no meaning here"),
        ('kind = "pieces"\ncounts = [1, 2.5]', r"\.counts\[1\]: got the number 2.5; expected an integer"),
        ('kind = "pieces"\ncounts = [0]', r"\.counts\[0\]: got 0; expected an integer of at least 1"),
        ('kind = "uniform"\nends = "both"', r"\.ends: unknown key"),
    ],
)
def test_mistakes_have_a_place(text, message):
    with pytest.raises(SceneError, match=rf"^box\.toml: mesh\.grading\[0\]{message}"):
        grading(text)


WALL = (
    HEAD[: HEAD.index("[[mesh.grading]]")]
    .replace("[mesh.blocks]", "e = [2, 0]\nf = [2, 1]\n[mesh.blocks]")
    .replace('[["a", "b", "c", "d"]]', '[["a", "b", "c", "d"], ["b", "e", "f", "c"]]')
)


def test_edges_that_leave_a_wall_begin_there():
    text = '[[mesh.grading]]\nleaving = "wall"\nkind = "boundary-layer"\nfirst_height = 0.01\n'
    scene = read_mesh_scene(tomllib.loads(WALL + text + '[[mesh.count]]\nleaving = "wall"\nelements = 5\n'), "box.toml")
    assert set(scene.gradings[0].on) == {("a", "d"), ("b", "c"), ("b", "e")}
    assert scene.counts[0].on == scene.gradings[0].on


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('leaving = "wal"', r"mesh\.grading\[0\]\.leaving: got 'wal'\. Did you mean 'wall'"),
        ('leaving = "wall"\non = "wall"', r"mesh\.grading\[0\]: got both 'on' and 'leaving'"),
        ('leaving = "all"', r"mesh\.grading\[0\]\.leaving: no block edge has just one end on 'all'"),
    ],
)
def test_mistakes_with_leaving(text, message):
    every = WALL.replace("[mesh.edges]", '[mesh.edges]\nall = [["a", "b", "e", "f", "c", "d"]]')
    with pytest.raises(SceneError, match=message):
        read_mesh_scene(tomllib.loads(f'{every}[[mesh.grading]]\n{text}\nkind = "uniform"\n'), "box.toml")
