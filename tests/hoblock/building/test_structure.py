from dataclasses import replace

import numpy as np
import pytest

from hoblock.building import build_structure
from hoblock.curves import Arc
from hoblock.errors import CurveError, ExpressionError, GradingError, TopologyError
from hoblock.expressions import compile_expression
from hoblock.generate import generate
from hoblock.grading import Exponential, Uniform, reverse
from hoblock.io.scene import load_mesh_scene
from hoblock.layout import layout
from hoblock.scene import ArcAbout, ArcThrough, CountScene, CurveScene, Formula, GradingScene, MeshScene

# A strip of three blocks: 0–1–2–3 below, 4–5–6–7 above.
VERTICES = {"abcdefgh"[k]: (float(k % 4), float(k // 4)) for k in range(8)}
STRIP = MeshScene(
    order=3,
    vertices=VERTICES,
    blocks={"left": (("a", "b", "f", "e"), ("b", "c", "g", "f")), "right": (("c", "d", "h", "g"),)},
    edges={"bottom": (("a", "b", "c", "d"),), "ends": (("a", "e"), ("h", "d"))},
    elements=2,
)


def formula(x, y, place="mesh.curve[0]"):
    return Formula(compile_expression(x, ["s"], {}, f"{place}.x"), compile_expression(y, ["s"], {}, f"{place}.y"))


def curve(on, shape, number=0):
    return CurveScene(tuple(map(tuple, on)), shape, f"mesh.curve[{number}]")


def grading(on, kind, parameter=None, number=0):
    key = {"exponential": "a", "uniform": None}.get(kind, "m")
    values = {} if key is None else {key: parameter}
    return GradingScene(tuple(map(tuple, on)), kind, values, f"mesh.grading[{number}]")


def count(on, elements, number=0):
    return CountScene(tuple(map(tuple, on)), elements, f"mesh.count[{number}]")


def edge_of(structure, first, second):
    return structure.topology.edge(structure.topology.vertex(first), structure.topology.vertex(second))


def test_names_and_default_counts():
    topology = build_structure(STRIP).topology
    assert topology.vertex_names == tuple("abcdefgh")
    assert {name: len(blocks) for name, blocks in topology.block_groups.items()} == {"left": 2, "right": 1}
    assert {topology.edge_name(k) for k in topology.edge_groups["bottom"]} == {"a–b", "b–c", "c–d"}
    assert {topology.edge_name(k) for k in topology.edge_groups["ends"]} == {"a–e", "d–h"}
    assert set(topology.counts) == {2}


def test_counts_of_paths_spread_along_chains():
    scene = replace(STRIP, counts=(count(["hd"], 4), count(["efg", "dc"], 3, 1), count(["ab"], 3, 2)))
    topology = build_structure(scene).topology
    counts = {topology.edge_name(k): int(n) for k, n in enumerate(topology.counts)}
    assert {counts[name] for name in ("a–b", "b–c", "c–d", "e–f", "f–g", "g–h")} == {3}
    assert {counts[name] for name in ("a–e", "b–f", "c–g", "d–h")} == {4}


def test_arcs_along_a_path_follow_each_edge():
    vertices = {name: (np.cos(t), np.sin(t)) for name, t in zip("pqrs", (0.0, 1.0, 2.0, 3.0), strict=True)}
    outer = {name.upper(): (2 * x, 2 * y) for name, (x, y) in vertices.items()}
    blocks = {"ring": tuple((a, a.upper(), b.upper(), b) for a, b in ("pq", "qr", "rs"))}
    shapes = (
        curve(["pqrs"], ArcAbout((0.0, 0.0))),
        curve(["SR", "PQ"], ArcAbout((0.0, 0.0)), 1),
        curve(["QR"], ArcThrough((2 * np.cos(1.3), 2 * np.sin(1.3))), 2),
    )
    structure = build_structure(MeshScene(4, {**vertices, **outer}, blocks, {"in": (tuple("pqrs"),)}, shapes))
    mesh = generate(structure, 6)
    radius = np.hypot(*mesh.points.T)
    assert np.sum(np.abs(radius - 1) < 1e-13) == 19
    assert np.sum(np.abs(radius - 2) < 1e-13) == 19


def test_parametric_curves_and_gradings_run_along_the_path():
    shape = formula("3 - s", "-0.3*s*(1 - s)**2")  # from d to c
    scene = replace(STRIP, curves=(curve(["dc"], shape),), gradings=(grading(["dc"], "exponential", 1.5),))
    structure = build_structure(scene)
    edge, forward = edge_of(structure, "d", "c")
    nodes = generate(structure, 3).points[layout(structure, 3).nodes_of_edge(edge)]
    nodes = nodes if forward else nodes[::-1]
    np.testing.assert_allclose(nodes[3, 0], 3 - Exponential(1.5)(0.5), atol=1e-14)
    s = 3 - nodes[:, 0]
    np.testing.assert_allclose(nodes[:, 1], -0.3 * s * (1 - s) ** 2, atol=1e-14)


def test_gradings_of_each_kind():
    gradings = (
        grading(["ab"], "quadratic", 0.3),
        grading(["bc"], "cubic", 0.4, 1),
        grading(["hd", "ae"], "exponential", 2.0, 2),
        grading(["ef"], "uniform", 0.0, 3),
    )
    structure = build_structure(replace(STRIP, gradings=gradings))
    s = np.linspace(0, 1, 7)
    for first, second, expected in (
        ("a", "b", s + 0.3 * ((2 * s - 1) ** 2 - 1) / 4),
        ("b", "c", (1.2 * (2 * s - 1) - 0.2 * (2 * s - 1) ** 3 + 1) / 2),
        ("h", "d", np.expm1(2 * s) / np.expm1(2)),
        ("a", "e", np.expm1(2 * s) / np.expm1(2)),
    ):
        edge, forward = edge_of(structure, first, second)
        found = structure.gradings[edge] if forward else reverse(structure.gradings[edge])
        np.testing.assert_allclose(found(s), expected, atol=1e-14)
    assert structure.gradings[edge_of(structure, "e", "f")[0]] == Uniform()


@pytest.mark.parametrize(
    ("changes", "error", "match"),
    [
        (
            {"edges": {"wall": (("a", "c"),)}},
            TopologyError,
            r"^mesh\.edges\.wall: no block has a side from 'a' to 'c'; a path walks along block edges, naming every",
        ),
        (
            {"curves": (curve(["af"], ArcAbout((0, 0)), 3),)},
            TopologyError,
            r"^mesh\.curve\[3\]: no block has a side from 'a' to 'f'",
        ),
        ({"counts": (count(["ag"], 2, 1),)}, TopologyError, r"^mesh\.count\[1\]: no block has a side from 'a' to 'g'"),
        ({"gradings": (grading(["bd"], "cubic", 0.2, 5),)}, TopologyError, r"^mesh\.grading\[5\]: no block has a side"),
        (
            {"curves": (curve(["ab"], ArcAbout((0.4, 1)), 2),)},
            CurveError,
            r"^mesh\.curve\[2\] on a–b: arc about \(0.4, 1\): the end points are .* away from the centre",
        ),
        (
            {"curves": (curve(["abc"], ArcThrough((1.5, 0)), 1),)},
            CurveError,
            r"^mesh\.curve\[1\] on a–b: arc through \(1.5, 0\): the three points lie on a line",
        ),
        (
            {"curves": (curve(["ab"], formula("s", "0.1")),)},
            CurveError,
            r"^mesh\.curve\[0\] on a–b: curve: end point \(0, 0.1\) is 0.1 away from vertex 'a' at \(0, 0\); must "
            r"coincide within 3e-09\. Check the curve's direction",
        ),
        (
            {"curves": (curve(["ba"], formula("s", "0")),)},
            CurveError,
            r"^mesh\.curve\[0\] on b–a: .* away from vertex 'b'",
        ),
        (
            {"curves": (curve(["ab"], formula("s", "0"), 4), curve(["ba"], formula("1 - s", "0"), 6))},
            TopologyError,
            r"^mesh\.curve\[6\]: edge b–a has a second curve: mesh\.curve\[4\] gives one already. Remove one",
        ),
        (
            {"gradings": (grading(["abc"], "cubic", 0.2), grading(["cb"], "cubic", 0.2, 1))},
            TopologyError,
            r"^mesh\.grading\[1\]: edge c–b has a second grading: mesh\.grading\[0\] gives one already",
        ),
        ({"gradings": (grading(["ab", "ba"], "cubic", 0.2),)}, TopologyError, "the same entry gives it twice"),
        (
            {"gradings": (grading(["ab"], "quadratic", 1.0, 7),)},
            GradingError,
            r"^mesh\.grading\[7\]: quadratic grading: m is 1",
        ),
        (
            {"counts": (count(["ab"], 2), count(["ef"], 3, 1))},
            TopologyError,
            r"^mesh\.count\[1\]: 3 elements on edge e–f, but mesh\.count\[0\] asks for 2 on edge a–b\. Both belong to "
            r"one chain of opposite edges \(.*\), which needs one number",
        ),
        (
            {"blocks": {"body": (("a", "b", "f", "e"), ("b", "f", "g", "c"), ("c", "d", "h", "g"))}},
            TopologyError,
            r"^mesh: blocks\.body\[1\] \(b, f, g, c\) is clockwise or inverted \(signed area .*\)\. List its vert",
        ),
        ({"vertices": {**VERTICES, "f": (3.5, 0.5)}}, TopologyError, r"^mesh: blocks\.left\[\d\] \(.*\)"),
        ({"vertices": {**VERTICES, "z": (9.0, 9.0)}}, TopologyError, r"^mesh: vertices 'z' belong to no block"),
    ],
)
def test_errors_name_the_place_in_the_scene(changes, error, match):
    with pytest.raises(error, match=match):
        build_structure(replace(STRIP, **changes))


def test_expressions_that_are_not_finite_name_their_own_place():
    bad = formula("s", "s*(1 - s)*log(s - 0.5)", "mesh.curve[8]")
    with pytest.raises(ExpressionError, match=r"^mesh\.curve\[8\]\.y: expression .* at s = 0"):
        build_structure(replace(STRIP, curves=(curve(["ab"], bad, 8),)))


def test_one_count_given_twice_is_no_conflict():
    counts = (count(["ab"], 5), count(["fe"], 5, 1))
    assert build_structure(replace(STRIP, counts=counts)).topology.counts.max() == 5


def test_scene_files(tmp_path):
    path = tmp_path / "quarter.toml"
    path.write_text(
        """
        [constants]
        r = 0.5
        [mesh]
        order = 4
        elements = 3
        [mesh.vertices]
        a = ["r", 0]
        b = [2, 0]
        c = [0, 2]
        d = [0, "r"]
        [mesh.blocks]
        fluid = [["a", "b", "c", "d"]]
        [mesh.edges]
        hole = [["a", "d"]]
        [[mesh.curve]]
        on = "hole"
        kind = "arc"
        center = [0, 0]
        [[mesh.curve]]
        on = [["b", "c"]]
        kind = "parametric"
        x = "2*cos(pi/2*s)"
        y = "2*sin(pi/2*s)"
        [[mesh.grading]]
        on = [["a", "b"], ["d", "c"]]
        kind = "exponential"
        a = 1
    """,
        encoding="utf-8",
    )
    structure = build_structure(load_mesh_scene(path, ["constants.r=0.75"]))
    assert isinstance(structure.curves[structure.topology.edge_groups["hole"][0]], Arc)
    mesh = generate(structure, 4)
    np.testing.assert_allclose(np.hypot(*mesh.points[mesh.edge_nodes("hole")].T), 0.75, atol=1e-14)
