"""Level sets of a scene on block edges."""

import numpy as np
import pytest

from hoblock.building import build_structure
from hoblock.curves import LevelSet
from hoblock.errors import CurveError, ExpressionError
from hoblock.fields import GridField, MeshField
from hoblock.generate import generate
from hoblock.io.field_file import write_field
from hoblock.io.scene import load_mesh_scene
from hoblock.quality import certify

SCENE = """
[constants]
r = 0.4
[mesh]
order = 5
elements = 2
[mesh.vertices]
a = [0.3, 0.3]
b = [-0.3, 0.3]
c = [-0.3, -0.3]
d = [0.3, -0.3]
A = [1, 1]
B = [-1, 1]
C = [-1, -1]
D = [1, -1]
[mesh.blocks]
fluid = [["a", "A", "B", "b"], ["b", "B", "C", "c"], ["c", "C", "D", "d"], ["d", "D", "A", "a"]]
[mesh.edges]
hole = [["a", "b", "c", "d", "a"]]
"""
CURVE = """
[[mesh.curve]]
on = "hole"
kind = "level-set"
function = "x**4 + 2*y**4 - r**4"
project = true
"""


def phi(points):
    return points[:, 0] ** 4 + 2.0 * points[:, 1] ** 4 - 0.4**4


def build(tmp_path, curve, scene=SCENE):
    (tmp_path / "scene.toml").write_text(scene + curve, encoding="utf-8")
    scene = load_mesh_scene(tmp_path / "scene.toml")
    return generate(build_structure(scene), scene.order)


def hole(mesh):
    return mesh.points[mesh.edge_nodes("hole")]


def test_vertices_are_moved_onto_the_isoline_and_the_edges_follow_it(tmp_path):
    mesh = build(tmp_path, CURVE)
    assert certify(mesh).valid
    np.testing.assert_allclose(phi(hole(mesh)), 0.0, atol=1e-16)
    corner = mesh.points[np.argmin(np.hypot(*(mesh.points - 0.3).T))]
    assert 1e-3 < np.hypot(*(corner - 0.3)) < 0.01


def test_the_same_isoline_may_be_stated_edge_by_edge(tmp_path):
    parts = "".join(CURVE.replace('"hole"', f'[["{a}", "{b}"]]') for a, b in ("ab", "bc", "cd", "da"))
    np.testing.assert_allclose(hole(build(tmp_path, parts)), hole(build(tmp_path, CURVE)), atol=1e-15)


def test_values_on_grids_and_meshes(tmp_path):
    x, y = np.linspace(-1.2, 1.2, 41), np.linspace(-1.1, 1.1, 38)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    write_field(tmp_path / "grid.npz", GridField(x, y, phi(points).reshape(41, 38)))
    square = SCENE.split("[mesh.blocks]")[0] + '[mesh.blocks]\nall = [["A", "B", "C", "D"]]\n'
    for name in "abcd":
        square = square.replace(f"\n{name} = ", f"\n#{name} = ")
    mesh = build(tmp_path, "", square)
    write_field(tmp_path / "mesh.npz", MeshField(mesh, phi(mesh.points)))
    formula = 'function = "x**4 + 2*y**4 - r**4"'
    for values, error in (('"grid.npz"\ndegree = 5', 1e-15), ('"mesh.npz"\nreach = 0.2', 1e-15)):
        found = build(tmp_path, CURVE.replace(formula, f"values = {values}"))
        assert np.abs(phi(hole(found))).max() < error


def test_level_and_distribution(tmp_path):
    curve = CURVE.replace(" - r**4", "").replace("project", 'distribution = "arc-length"\nlevel = "r**4"\nproject')
    mesh = build(tmp_path, curve)
    np.testing.assert_allclose(phi(hole(mesh)), 0.0, atol=1e-16)


def sides(top, left, first="b", second="c"):
    """Level sets on the edge from a to b and on another one."""
    tables = [("a", "b", top), (first, second, left)]
    return "".join(
        CURVE.replace('"hole"', f'[["{p}", "{q}"]]').replace("x**4 + 2*y**4 - r**4", function)
        for p, q, function in tables
        if function
    )


def test_a_vertex_of_two_level_sets_is_put_where_they_cross(tmp_path):
    mesh = build(tmp_path, sides("y + 0.1*x**2 - 0.3", "x - 0.1*sin(9*y) + 0.35"))
    corner = mesh.points[np.argmin(np.hypot(*(mesh.points - (-0.3, 0.3)).T))]
    np.testing.assert_allclose(corner[1] + 0.1 * corner[0] ** 2, 0.3, atol=1e-15)
    np.testing.assert_allclose(corner[0] - 0.1 * np.sin(9.0 * corner[1]), -0.35, atol=1e-15)
    assert certify(mesh).valid


@pytest.mark.parametrize(
    ("curve", "error", "match"),
    [
        (CURVE.replace("project = true", ""), CurveError, r"mesh\.curve\[0\] on a–b: .* is 0\.00538 away"),
        (CURVE + "reach = 0.005", CurveError, r"\[0\]\.project, vertex 'a': .*none found within 0\.003 of it"),
        (CURVE + "level = -1", CurveError, r"mesh\.curve\[0\]\.project, vertex 'a': nearest point .* none found"),
        (CURVE.replace("x**4", "log(x - 1)"), ExpressionError, r"mesh\.curve\[0\]\.function: .* is nan"),
        (
            sides("y - 0.2", "x + 0.2") + sides("", "y - x", "b", "B"),
            CurveError,
            r"mesh\.curve\[2\]\.project: vertex 'b' is on more than two level sets, which do not meet",
        ),
        (
            sides("y - 0.2", "y - 0.21"),
            CurveError,
            r"mesh\.curve\[1\]\.project, vertex 'b', which is on mesh\.curve\[0\] too: crossing of .* are parallel",
        ),
    ],
)  # fmt: skip
def test_errors(tmp_path, curve, error, match):
    with pytest.raises(error, match=match):
        build(tmp_path, curve)


def test_the_curves_are_level_sets(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE + CURVE, encoding="utf-8")
    structure = build_structure(load_mesh_scene(tmp_path / "scene.toml"))
    assert len(structure.curves) == 4
    curves = [getattr(curve, "curve", curve) for curve in structure.curves.values()]  # some are walked backwards
    assert all(isinstance(curve, LevelSet) for curve in curves)
