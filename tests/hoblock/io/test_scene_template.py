"""`[mesh.template]` in scene files."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

from hoblock.building import build_structure
from hoblock.errors import SceneError, TopologyError
from hoblock.generate import generate
from hoblock.grading import Exponential
from hoblock.io.scene import load_mesh_scene, read_mesh_scene
from hoblock.io.template_scene import template_scene
from hoblock.scene import Formula
from hoblock.templates import TEMPLATES, annulus, flag_in_channel, nozzle

RING = """
[constants]
R = 1.5
[mesh]
order = 3
[mesh.template]
name = "annulus"
inner_radius = "R - 0.5"
outer_radius = "2*R"
center = ["R", 1]
sectors = "3 + 1"
"""


def scene(text=RING, **replaced):
    for old, new in replaced.items():
        text = text.replace(old, new)
    return read_mesh_scene(tomllib.loads(text), "ring.toml")


def built(text=RING):
    return build_structure(scene(text))


def test_parameters_are_numbers_or_expressions():
    found = scene()
    assert found.template.name == "annulus"
    assert dict(found.template.values) == {
        "inner_radius": 1.0,
        "outer_radius": 3.0,
        "center": (1.5, 1.0),
        "sectors": 4,
    }
    expected = annulus(inner_radius=1.0, outer_radius=3.0, center=(1.5, 1.0))
    np.testing.assert_array_equal(generate(build_structure(found), 3).points, generate(expected, 3).points)


def test_the_scene_knows_the_names_of_the_template():
    found = scene()
    assert set(found.vertices) == {f"{ring}{k}" for ring in "ab" for k in range(4)}
    assert {group: len(quads) for group, quads in found.blocks.items()} == {"domain": 4}
    assert {name: len(paths) for name, paths in found.edges.items()} == {"inner": 4, "outer": 4}


REFINED = """
[mesh.edges]
rim = [["b0", "b1"]]
[[mesh.count]]
on = [["a0", "b0"]]
elements = 7
[[mesh.grading]]
on = [["a1", "b1"]]
kind = "exponential"
a = 2.0
[[mesh.curve]]
on = "rim"
kind = "arc"
through = [4.0, 3.3]
"""


def test_counts_gradings_curves_and_names_refine_it():
    structure = built(RING + REFINED)
    topology = structure.topology

    def edge(first, second):
        return topology.edge(topology.vertex(first), topology.vertex(second))

    assert topology.counts[edge("a0", "b0")[0]] == 7
    assert topology.counts[edge("b0", "b1")[0]] == 4
    assert topology.edge_groups["rim"].tolist() == [edge("b0", "b1")[0]]
    half = np.array([0.5])
    for first, second, a in (("a0", "b0", 0.0), ("a1", "b1", 2.0)):
        number, forward = edge(first, second)
        place = structure.gradings[number](half)
        np.testing.assert_allclose(place if forward else 1.0 - place, Exponential(a)(half))
    center = np.array([1.5, 1.0])
    for first, second, on_circle in (("b0", "b1", False), ("b1", "b2", True)):
        middle = structure.curves[edge(first, second)[0]](half)[0]
        assert (abs(np.hypot(*(middle - center)) - 3.0) < 1e-12) == on_circle
    generate(structure, 3)


def test_a_name_of_the_template_can_be_given_to_other_edges():
    found = scene(RING + '[mesh.edges]\nouter = [["b0", "b1", "b2"]]\n')
    assert len(generate(build_structure(found), 1).edge_groups["outer"]) == 8


def test_walls_as_expressions():
    text = """
[mesh]
order = 2
[mesh.template]
name = "nozzle"
upper = ["3*s", "1 + 0.2*sin(4*s)"]
half = true
"""
    found = scene(text)
    assert isinstance(found.template.values["upper"], Formula)
    expected = nozzle(upper=lambda t: np.stack([3.0 * t, 1.0 + 0.2 * np.sin(4.0 * t)], axis=-1), half=True)
    mesh = generate(build_structure(found), 5)
    np.testing.assert_allclose(mesh.points, generate(expected, 5).points, atol=1e-15)


def test_text_and_choice():
    text = '[mesh]\norder = 1\n[mesh.template]\nname = "flag_in_channel"\nbody = "square"\n'
    expected = flag_in_channel(body="square")
    np.testing.assert_array_equal(built(text).vertices, expected.vertices)


@pytest.mark.parametrize("name", TEMPLATES)
def test_written_scenes_are_complete(name, tmp_path):
    """Every parameter is in the file, those without a default as comments; it gives the default mesh."""
    path = tmp_path / "scene.toml"
    text = template_scene(TEMPLATES[name])
    path.write_text(text, encoding="utf-8")
    found = load_mesh_scene(path)
    lines = text.splitlines()
    for parameter in TEMPLATES[name].parameters.values():
        mark = "# " if parameter.default is None else ""
        assert any(line.startswith(f"{mark}{parameter.name} = ") for line in lines), parameter.name
    assert max(len(line) for line in lines) <= 120
    default = TEMPLATES[name].function()
    np.testing.assert_array_equal(generate(build_structure(found), 2).points, generate(default, 2).points)


@pytest.mark.parametrize("name", TEMPLATES)
def test_commented_lines_of_written_scenes_work(name):
    lines = template_scene(TEMPLATES[name]).splitlines()
    start = lines.index("[mesh.template]")
    code = [line.removeprefix("# ") if " = " in line or "[[" in line else line for line in lines[start:]]
    code = [line for line in code if not line.startswith("#") and (" = " in line or line.startswith("["))]
    code = [line for line in code if tomllib_accepts(line)]
    text = "\n".join([*lines[:start], *code])
    if name == "nozzle":
        text = text.replace("half = true", "half = false")
    structure = build_structure(scene(text))
    assert 8 in structure.topology.counts
    generate(structure, 2)


def tomllib_accepts(line):
    try:
        tomllib.loads(line)
    except tomllib.TOMLDecodeError:
        return False
    return True


@pytest.mark.parametrize(
    ("replaced", "message"),
    [
        ({'"annulus"': '"anulus"'}, "mesh.template.name: got 'anulus'. Did you mean 'annulus'?"),
        ({'name = "annulus"\n': ""}, "mesh.template.name: the required key is missing"),
        ({"sectors": "sector"}, "mesh.template.sector: unknown key. Did you mean 'sectors'?"),
        ({'"3 + 1"': "4.0"}, "mesh.template.sectors: got the number 4; expected an integer >= 1"),
        ({'"3 + 1"': '"R"'}, "mesh.template.sectors: got the text 'R'; expected an integer >= 1"),
        ({'"3 + 1"': "0"}, "mesh.template.sectors: got 0; expected an integer >= 1"),
        ({'"3 + 1"': "2"}, "mesh.template.sectors: got 2 for an opening of 360 degrees"),
        ({'"2*R"': '"2*Q"'}, "mesh.template.outer_radius: .*'Q'"),
        ({'"2*R"': "-3"}, "mesh.template.outer_radius: got -3.0; expected a number > 0"),
        ({'"2*R"': "true"}, "mesh.template.outer_radius: got the boolean true; expected a number"),
        ({'"2*R"': "0.5"}, "mesh.template.inner_radius: got 1; expected less than outer_radius = 0.5"),
        ({'["R", 1]': "[1]"}, "mesh.template.center: got a list of 1; expected two values"),
        ({"order = 3": "order = 3\nelements = 2"}, r"mesh.elements: got this beside \[mesh.template\]"),
        ({"order = 3": 'order = 3\nstructure = "coarse.msh"'}, r"mesh.structure: got this beside \[mesh.template\]"),
        ({"order = 3": "order = 3\nvertices.a = [0, 0]"}, r"mesh.vertices: got this beside \[mesh.template\]"),
    ],
)
def test_mistakes_name_their_place(replaced, message):
    with pytest.raises(SceneError, match=message) as caught:
        scene(**replaced)
    assert caught.value.file == "ring.toml"


def test_a_choice_is_checked():
    text = '[mesh]\norder = 1\n[mesh.template]\nname = "flag_in_channel"\nbody = "squre"\n'
    with pytest.raises(SceneError, match=r"mesh.template.body: got 'squre'\. Did you mean 'square'\?"):
        scene(text)


def test_two_numbers_for_a_chain_are_refused():
    entry = '[[mesh.count]]\non = [["{0}", "{1}"]]\nelements = {2}\n'
    text = RING + entry.format("a0", "b0", 5) + entry.format("a1", "b1", 6)
    with pytest.raises(
        TopologyError, match=r"mesh.count\[1\]: 6 elements on edge a1–b1, but mesh.count\[0\] asks for 5"
    ):
        built(text)
