"""Inner vertices of a path moved onto the curve that follows it."""

import math

import numpy as np
import pytest

from hoblock.building import build_structure
from hoblock.curves import Spline, closest_parameters
from hoblock.errors import CurveError, SceneError
from hoblock.generate import generate
from hoblock.io.scene import load_mesh_scene
from hoblock.quality import certify

SCENE = """
[mesh]
order = 4
elements = 3
[mesh.vertices]
a = [0, 0]
b = [1.1, 0.2]
c = [1.9, -0.1]
d = [3, 0]
A = [0, 1]
B = [1, 1]
C = [2, 1]
D = [3, 1]
[mesh.blocks]
fluid = [["a", "b", "B", "A"], ["b", "c", "C", "B"], ["c", "d", "D", "C"]]
[mesh.edges]
wall = [["a", "b", "c", "d"]]
"""
CURVE = """
[[mesh.curve]]
on = "wall"
kind = "spline"
points = [[0.5, 0.2], [1.5, 0], [2.5, -0.2]]
project = true
"""
WHOLE = Spline([(0, 0), (0.5, 0.2), (1.5, 0), (2.5, -0.2), (3, 0)])
ISOLINE = """
[[mesh.curve]]
on = [["b", "B"]]
kind = "level-set"
function = "x - 1 - 0.01*y"
project = true
"""


def build(tmp_path, curves, scene=SCENE):
    (tmp_path / "scene.toml").write_text(scene + curves, encoding="utf-8")
    return build_structure(load_mesh_scene(tmp_path / "scene.toml"))


def places(structure, names):
    return structure.vertices[[structure.topology.vertex(name) for name in names]]


@pytest.mark.parametrize("distribution", ["parameter", "arc-length"])
def test_vertices_go_to_the_nearest_points(distribution, tmp_path):
    structure = build(tmp_path, CURVE + f'distribution = "{distribution}"\n')
    before = np.array([(1.1, 0.2), (1.9, -0.1)])
    after = places(structure, "bc")
    np.testing.assert_array_equal(places(structure, "ad"), [(0, 0), (3, 0)])
    _, distances = closest_parameters(WHOLE, before)
    np.testing.assert_allclose(np.hypot(*(after - before).T), distances, atol=1e-12)
    assert distances.min() > 1e-3
    mesh = generate(structure, 4)
    assert certify(mesh).valid
    wall = mesh.points[mesh.edge_nodes("wall")]
    assert closest_parameters(WHOLE, wall)[1].max() < 1e-12


@pytest.mark.parametrize(
    "keys",
    [
        'kind = "polyline"\npoints = [[1.3, 0.2]]',
        'kind = "bezier"\npoints = [[0, 0], [1, 0.5], [2, -0.3], [3, 0]]',
        'kind = "b-spline"\ndegree = 2\npoints = [[0, 0], [1, 0.5], [2, -0.3], [3, 0]]',
        'kind = "nurbs"\ndegree = 2\npoints = [[0, 0], [1, 0.5], [2, -0.3], [3, 0]]\nweights = [1, 2, 1, 1]',
        'kind = "lagrange"\npoints = [[1, 0.3], [2, -0.1]]',
    ],
)
def test_every_kind_that_follows_a_path(keys, tmp_path):
    structure = build(tmp_path, f'[[mesh.curve]]\non = "wall"\nproject = true\n{keys}\n')
    assert len(structure.curves) == 3
    assert certify(generate(structure, 3)).valid


def test_a_closed_path_is_one_smooth_curve(tmp_path):
    angles = np.pi * np.arange(0.25, 2.0, 0.5)
    vertices = [f"{n} = [{math.cos(t)!r}, {math.sin(t)!r}]" for n, t in zip("abcd", angles.tolist(), strict=True)]
    vertices += [
        f"{n} = [{2 * math.cos(t)!r}, {2 * math.sin(t)!r}]" for n, t in zip("ABCD", angles.tolist(), strict=True)
    ]
    blocks = ", ".join(f'["{p}", "{p.upper()}", "{q.upper()}", "{q}"]' for p, q in ("ab", "bc", "cd", "da"))
    scene = "\n".join(["[mesh]", "order = 4", "elements = 4", "[mesh.vertices]", *vertices, "[mesh.blocks]"])
    angles = 0.25 * np.pi + 2.0 * np.pi * np.arange(1, 24) / 24
    radii = 1.0 + 0.1 * (1.0 - np.cos(3.0 * (angles - 0.25 * np.pi)))
    points = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=-1).tolist()
    curve = f'[[mesh.curve]]\non = [["a", "b", "c", "d", "a"]]\nkind = "spline"\nends = "periodic"\npoints = {points}\n'
    structure = build(tmp_path, f"{curve}project = true\n", f"{scene}\nfluid = [{blocks}]\n")
    assert certify(generate(structure, 4)).valid
    first, last = (structure.curves[structure.topology.edge(*pair)[0]] for pair in ((0, 1), (3, 0)))
    leaving, arriving = first(np.array([0.0, 1e-6])), last(np.array([1.0 - 1e-6, 1.0]))
    slopes = [np.diff(part, axis=0)[0] for part in (leaving, arriving)]
    assert abs(np.cross(*[np.append(slope / np.hypot(*slope), 0.0) for slope in slopes])[2]) < 1e-5


@pytest.mark.parametrize(
    ("curves", "error", "match"),
    [
        (CURVE.replace("project = true", ""), CurveError, r"mesh\.curve\[0\] on a–b–c–d: 'b' at .* off the curve"),
        (
            CURVE.replace("[1.5, 0]", "[1.5, -2]"),
            CurveError,
            r"mesh\.curve\[0\]\.project: vertex 'c' is 0\.521 away from the curve, .* expected at most 0\.427, half of",
        ),
        (
            CURVE + CURVE.replace('"wall"', '[["B", "b", "a"]]').replace("points", "points = [[1, 0.5]] #"),
            CurveError,
            r"mesh\.curve\[1\]\.project: vertex 'b' is to be moved onto this curve and onto that of mesh\.curve\[0\]",
        ),
        (
            ISOLINE + CURVE,
            CurveError,
            r"curve\[1\]\.project: vertex 'b' .* onto that of mesh\.curve\[0\]; expected one",
        ),
        (
            CURVE.replace('"wall"', '[["a", "b"], ["c", "d"]]'),
            CurveError,
            r"mesh\.curve\[0\]: the curve is given for 2 paths; expected one",
        ),
        (
            CURVE.replace("true", "1"),
            SceneError,
            r"mesh\.curve\[0\]\.project: got the number 1; expected true or false",
        ),
        (
            '[[mesh.curve]]\non = [["a", "b"]]\nkind = "arc"\nangle = 1\nproject = true',
            SceneError,
            r"mesh\.curve\[0\]\.project: unknown key",
        ),
        (
            CURVE + 'ends = "periodic"',
            CurveError,
            r"curve\[0\] on a–b–c–d: spline: ends = 'periodic', but it runs from \(0\.0, 0\.0\) to \(3\.0, 0\.0\)",
        ),
    ],
)
def test_errors(curves, error, match, tmp_path):
    with pytest.raises(error, match=match):
        build(tmp_path, curves)
