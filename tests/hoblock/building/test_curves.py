"""Curves of a scene on block edges: every kind, and one curve for a path of several edges."""

import textwrap
from itertools import pairwise

import numpy as np
import pytest

from hoblock.building import build_structure
from hoblock.curves import (
    Arc,
    ArcLength,
    Bezier,
    Ellipse,
    LagrangeEdge,
    Nurbs,
    Parametric,
    Polyline,
    Spline,
    length_table,
)
from hoblock.errors import CurveError
from hoblock.generate import generate
from hoblock.io.scene import load_mesh_scene
from hoblock.quality import certify

SINGLE = """
[constants]
h = 0.25
[mesh]
order = 4
elements = 3
[mesh.vertices]
a = [0, 0]
b = [2, 0]
c = [2, 1]
d = [0, 1]
[mesh.blocks]
fluid = [["a", "b", "c", "d"]]
"""
ENDS = np.array([0.0, 1.0])
T = np.linspace(0.0, 1.0, 21)


def structure_of(tmp_path, curves, scene=SINGLE):
    (tmp_path / "scene.toml").write_text(scene + textwrap.dedent(curves), encoding="utf-8")
    return build_structure(load_mesh_scene(tmp_path / "scene.toml"))


def curve_of(structure, first, second):
    vertex = structure.topology.vertex
    edge, forward = structure.topology.edge(vertex(first), vertex(second))
    curve = structure.curves[edge]
    return curve if forward else curve.curve


POINTS = [(0, 0), (0.5, -0.25), (1.2, 0.1), (2, 0)]
INNER = "points = [[0.5, '-h'], [1.2, 0.1]]"
ALL = "points = [[0, 0], [0.5, '-h'], [1.2, 0.1], [2, 0]]"
KINDS = {
    "kind = 'arc'\ncenter = [1, 2]": Arc.from_center((1, 2), (0, 0), (2, 0)),
    "kind = 'arc'\nthrough = [1, '-h']": Arc.through((0, 0), (1, -0.25), (2, 0)),
    "kind = 'arc'\nangle = '4*h'": Arc.with_angle((0, 0), (2, 0), 1.0),
    "kind = 'ellipse'\ncenter = [1, 1]\nradii = ['sqrt(2)', 'sqrt(2)']": Arc.from_center((1, 1), (0, 0), (2, 0)),
    "kind = 'ellipse'\ncenter = [1, '-0.3']\nradii = [1.25, 0.5]\nlong_way = true": Ellipse.from_center(
        (1, -0.3), (1.25, 0.5), 0.0, (0, 0), (2, 0), long_way=True
    ),
    f"kind = 'polyline'\n{INNER}": Polyline(POINTS),
    f"kind = 'polyline'\n{ALL}\nparameter = 'pieces'": Polyline(POINTS, "pieces"),
    f"kind = 'spline'\n{INNER}": Spline(POINTS),
    f"kind = 'spline'\n{ALL}\nends = 'clamped'\ntangents = [[1, -1], [1, 0]]": Spline(
        POINTS, "clamped", ((1, -1), (1, 0))
    ),
    f"kind = 'lagrange'\n{INNER}": LagrangeEdge(POINTS),
    f"kind = 'lagrange'\n{ALL}\nnodes = 'gll'": LagrangeEdge(POINTS, "gll"),
    f"kind = 'bezier'\n{ALL}\nweights = [1, 2, 3, 1]": Bezier(POINTS, [1, 2, 3, 1]),
    f"kind = 'b-spline'\n{ALL}\ndegree = 2": Nurbs(POINTS, None, 2),
    f"kind = 'nurbs'\n{ALL}\ndegree = 2\nweights = [1, 2, 3, 1]\nknots = [0, 0, 0, 1, 5, 5, 5]": Nurbs(
        POINTS, [1, 2, 3, 1], 2, [0, 0, 0, 1, 5, 5, 5]
    ),
    "kind = 'parametric'\nx = '2*s'\ny = '-h*s*(1 - s)'": Parametric(
        lambda s: np.stack([2 * s, -0.25 * s * (1 - s)], axis=-1)
    ),
    "kind = 'level-set'\nfunction = 'y + h*x*(2 - x)'": Parametric(lambda s: np.stack([2 * s, -s * (1 - s)], axis=-1)),
}


@pytest.mark.parametrize("keys", KINDS)
def test_every_kind_in_both_directions_and_by_arc_length(keys, tmp_path):
    exact = KINDS[keys]
    entry = f'\n[[mesh.curve]]\non = [["a", "b"]]\n{keys}\n'
    curve = curve_of(structure_of(tmp_path, entry), "a", "b")
    np.testing.assert_allclose(curve(T), exact(T), atol=1e-13)
    by_length = curve_of(structure_of(tmp_path, entry + 'distribution = "arc-length"\n'), "a", "b")
    assert isinstance(by_length, ArcLength)
    np.testing.assert_allclose(by_length(T), ArcLength(exact)(T), atol=1e-12)


def test_the_direction_is_that_of_the_path(tmp_path):
    entry = '\n[[mesh.curve]]\non = [["b", "a"]]\nkind = "spline"\npoints = [[1.2, 0.1], [0.5, -0.25]]\n'
    structure = structure_of(tmp_path, entry)
    edge, forward = structure.topology.edge(0, 1)
    assert forward
    np.testing.assert_allclose(structure.curves[edge](T), Spline(POINTS)(T), atol=1e-14)
    assert certify(generate(structure, 4)).valid


WALL = Nurbs([(0, 0), (1, -0.5), (2, 0.7), (3, 0.2), (4, 0)], [1, 2, 1, 1, 1], 3)
KEYS = "points = [[0, 0], [1, -0.5], [2, 0.7], [3, 0.2], [4, 0]]\nweights = [1, 2, 1, 1, 1]"
CUTS = np.array([0.0, 0.3, 0.55, 1.0])


def channel(places):
    below = "\n".join(f"p{k} = [{x!r}, {y!r}]" for k, (x, y) in enumerate(places.tolist()))
    above = "\n".join(f"q{k} = [{x!r}, 2.0]" for k, x in enumerate(places[:, 0].tolist()))
    blocks = ", ".join(f'["p{k}", "p{k + 1}", "q{k + 1}", "q{k}"]' for k in range(len(places) - 1))
    return f"[mesh]\norder = 4\nelements = 2\n[mesh.vertices]\n{below}\n{above}\n[mesh.blocks]\nfluid = [{blocks}]\n"


@pytest.mark.parametrize("path", [["p0", "p1", "p2", "p3"], ["p3", "p2", "p1", "p0"]])
@pytest.mark.parametrize("by_length", [False, True])
def test_one_wall_over_three_blocks_is_cut_at_their_vertices(path, by_length, tmp_path):
    keys = (
        KEYS
        if path[0] == "p0"
        else "points = [[4, 0], [3, 0.2], [2, 0.7], [1, -0.5], [0, 0]]\nweights = [1, 1, 1, 2, 1]"
    )
    entry = f'[[mesh.curve]]\non = {[path]}\nkind = "nurbs"\n{keys}\n' + 'distribution = "arc-length"\n' * by_length
    structure = structure_of(tmp_path, entry, channel(WALL(CUTS)))
    for k, (start, stop) in enumerate(pairwise(CUTS)):
        edge, forward = structure.topology.edge(k, k + 1)
        assert forward
        curve = structure.curves[edge]
        np.testing.assert_allclose(curve(ENDS), WALL(CUTS[k : k + 2]), atol=1e-14)
        if by_length:
            halves = np.hypot(*np.diff(curve(np.array([0.5 - 1e-3, 0.5, 0.5 + 1e-3])), axis=0).T)
            assert halves[0] == pytest.approx(halves[1], rel=1e-4)
            assert length_table(curve).length == pytest.approx(length_table(ArcLength(curve)).length, rel=1e-13)
        else:
            np.testing.assert_allclose(curve(T), WALL(start + (stop - start) * T), atol=1e-13)
    assert certify(generate(structure, 4)).valid


@pytest.mark.parametrize("kind", ["polyline", "spline", "lagrange", "bezier", "b-spline"])
def test_every_kind_with_an_extent_of_its_own_can_be_cut(kind, tmp_path):
    points = [(0, 0), (1, -0.25), (2.5, 0.25), (3, 0.2), (4, 0)]
    curves = {"polyline": Polyline, "spline": Spline, "lagrange": LagrangeEdge, "bezier": Bezier, "b-spline": Nurbs}
    whole = curves[kind](points)
    entry = f'[[mesh.curve]]\non = [["p0", "p1", "p2"]]\nkind = "{kind}"\npoints = {[list(p) for p in points]}\n'
    structure = structure_of(tmp_path, entry, channel(whole(np.array([0.0, 0.6, 1.0]))))
    np.testing.assert_allclose(structure.curves[structure.topology.edge(1, 2)[0]](T), whole(0.6 + 0.4 * T), atol=1e-13)


@pytest.mark.parametrize("kind", ["polyline", "spline", "lagrange"])
def test_without_points_between_them_the_vertices_are_joined_by_a_line(kind, tmp_path):
    curve = curve_of(
        structure_of(tmp_path, f'\n[[mesh.curve]]\non = [["a", "b"]]\nkind = "{kind}"\npoints = []\n'), "a", "b"
    )
    np.testing.assert_allclose(curve(T), np.stack([2 * T, 0 * T], axis=-1), atol=1e-15)


def test_an_airfoil_from_a_file(tmp_path):
    x = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 41))) / 2.0
    y = 0.3 * np.sqrt(x) * (1.0 - x)
    (tmp_path / "upper.csv").write_text(
        "x,y\n" + "\n".join(f"{a!r},{b!r}" for a, b in zip(x.tolist(), y.tolist(), strict=True))
    )
    scene = SINGLE.replace("b = [2, 0]", "b = [1, 0]").replace("c = [2, 1]", "c = [1, 1]")
    entry = '[[mesh.curve]]\non = [["a", "b"]]\nkind = "spline"\nparameter = "centripetal"\nfile = "upper.csv"\n'
    curve = curve_of(structure_of(tmp_path, entry, scene), "a", "b")
    assert len(curve.points) == 41  # both ends are among them, and are not taken twice
    np.testing.assert_allclose(curve.points, np.stack([x, y], axis=-1), atol=1e-15)


def entry_on(path, keys):
    return f"[[mesh.curve]]\non = {[path]}\n{keys}\n"


@pytest.mark.parametrize(
    ("curves", "match"),
    [
        (
            entry_on(["a", "b"], f"kind = 'bezier'\n{ALL.replace('[2, 0]', '[2, 0.1]')}"),
            r"^mesh\.curve\[0\] on a–b: curve: end point \(2, 0\.1\) is 0\.1 away from vertex 'b' at \(2, 0\); must "
            r"coincide within .*Check the curve's direction",
        ),
        (
            entry_on(["b", "a"], f"kind = 'nurbs'\n{ALL}"),
            r"on b–a: curve: end point \(0, 0\) is 2 away from vertex 'b'",
        ),
        (
            entry_on(["d", "a", "b"], f"kind = 'bezier'\n{ALL.replace('[0, 0]', '[0, 1]')}"),
            r"mesh\.curve\[0\] on d–a–b: 'a' at \(0, 0\) is 0\.\d+ off the curve, whose closest point is \(0\..*; must "
            "lie on it within .* Move it there",
        ),
        (
            "[[mesh.curve]]\non = [['a', 'b'], ['c', 'd']]\nkind = 'spline'\npoints = [[1, 1]]\n",
            r"mesh\.curve\[0\]: the curve is given for 2 paths; expected one, since it has two ends of its own",
        ),
        (
            entry_on(["a", "b"], "kind = 'spline'\npoints = [[1e-7, 1e-7], [1, 0.1]]"),
            r"mesh\.curve\[0\] on a–b: the first point \(1e-07, 1e-07\) is only 1\.4e-07 away from vertex 'a'",
        ),
        (
            entry_on(["a", "b"], "kind = 'lagrange'\npoints = [[1, 0.1], [2, 1e-4]]"),
            r"the last point \(2, 0\.0001\) is only 0\.0001 away from vertex 'b', .*must coincide with it",
        ),
        (
            entry_on(["b", "a"], "kind = 'spline'\npoints = [[0, 0], [1, 0.1], [2, 0]]"),
            r"mesh\.curve\[0\] on b–a: the points run from 'a' to 'b', the path from 'b' to 'a'\. Turn one",
        ),
        (
            entry_on(["a", "b"], "kind = 'arc'\nangle = 7"),
            r"mesh\.curve\[0\] on a–b: arc of angle 7: expected an angle",
        ),
        (
            entry_on(["a", "b"], "kind = 'ellipse'\ncenter = [1, 1]\nradii = [1, 2]"),
            r"on a–b: ellipse about \(1, 1\): the point \(0, 0\) is at 1\.11803399 of the radius in its direction",
        ),
        (
            entry_on(["a", "b"], "kind = 'nurbs'\npoints = [[0, 0], [2, 0]]\nweights = [1, 1]"),
            r"on a–b: NURBS: degree 3 with 2 control points; expected a degree from 1 to 1",
        ),
        (
            entry_on(["a", "b"], "kind = 'polyline'\npoints = [[1, 0.1], [1, 0.1]]"),
            r"on a–b: polyline: points\[1\] and points\[2\] are both \(1, 0\.1\)",
        ),
    ],
)
def test_errors_name_the_entry_the_edge_and_the_way_out(curves, match, tmp_path):
    with pytest.raises(CurveError, match=match):
        structure_of(tmp_path, curves)
