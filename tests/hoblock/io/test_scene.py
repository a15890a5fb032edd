"""The mesh part of a scene, read into plain data."""

from __future__ import annotations

import dataclasses
import math
import tomllib

import numpy as np
import pytest

from hoblock.errors import SceneError
from hoblock.io.scene import constants_of, load_mesh_scene, read_mesh_scene
from hoblock.io.toml import apply_overrides
from hoblock.scene import ArcAbout, ArcThrough, Formula

SCENE = """
title = "A quarter ring beside a square"

[constants]
r = 0.5
R = "2*r"
q = "r*cos(pi/4)"

[mesh]
order = 4
elements = 2

[mesh.vertices]
a = ["r", 0]
b = ["R", 0]
c = [0, 1.0]
d = [0, "r"]
e = [2, 0]
f = [2, 1]
g = [1, 1]

[mesh.blocks]
fluid = [["a", "b", "c", "d"]]
solid = [["b", "e", "f", "g"]]

[mesh.edges]
inner = [["d", "a"]]
outer = [["e", "f", "g"], ["b", "c"]]

[[mesh.curve]]
on = "inner"
kind = "arc"
center = [0, 0]

[[mesh.curve]]
on = [["b", "c"]]
kind = "arc"
through = ["2*q", "2*q"]

[[mesh.curve]]
on = [["e", "f"]]
kind = "parametric"
x = "2 + 0.1*sin(pi*s)"
y = "s"

[[mesh.count]]
on = [["a", "b"]]
elements = 3

[[mesh.grading]]
on = [["a", "b"]]
kind = "exponential"
a = 1.8

[[mesh.grading]]
on = "outer"
kind = "quadratic"
m = -0.5

[[mesh.grading]]
on = [["f", "g"]]
kind = "cubic"
m = 0

[[mesh.grading]]
on = [["b", "e"]]
kind = "uniform"

[fluid]
density = "not hoblock's business"

[[motion]]
on = 3
"""


def scene(*overrides, text=SCENE):
    return read_mesh_scene(apply_overrides(tomllib.loads(text), overrides), "ring.toml")


def replaced(old, new):
    assert old in SCENE
    return SCENE.replace(old, new, 1)


# --- what is read -------------------------------------------------------------------------------------------------


def test_the_whole_scene():
    mesh = scene()
    assert (mesh.order, mesh.elements, mesh.title, mesh.file) == (4, 2, "A quarter ring beside a square", "ring.toml")
    assert mesh.vertices["a"] == (0.5, 0.0)
    assert mesh.vertices["b"] == (1.0, 0.0)
    assert list(mesh.vertices) == list("abcdefg")
    assert dict(mesh.blocks) == {"fluid": (("a", "b", "c", "d"),), "solid": (("b", "e", "f", "g"),)}
    assert dict(mesh.edges) == {"inner": (("d", "a"),), "outer": (("e", "f", "g"), ("b", "c"))}


def test_curves():
    about, through, formula = scene().curves
    assert (about.on, about.shape, about.place) == ((("d", "a"),), ArcAbout((0.0, 0.0)), "mesh.curve[0]")
    assert isinstance(through.shape, ArcThrough)
    np.testing.assert_allclose(through.shape.point, [math.sqrt(0.5)] * 2, rtol=1e-15)
    assert isinstance(formula.shape, Formula)
    assert formula.place == "mesh.curve[2]"
    assert formula.shape.x.place == "mesh.curve[2].x"
    np.testing.assert_allclose(formula.shape.x.evaluate(s=[0.0, 0.5, 1.0]), [2.0, 2.1, 2.0], atol=1e-15)
    np.testing.assert_allclose(formula.shape.y.evaluate(s=[0.0, 0.5, 1.0]), [0.0, 0.5, 1.0])


def test_counts_and_gradings():
    mesh = scene()
    (count,) = mesh.counts
    assert (count.on, count.elements, count.place) == ((("a", "b"),), 3, "mesh.count[0]")
    assert [(g.kind, dict(g.values), g.place) for g in mesh.gradings] == [
        ("exponential", {"a": 1.8}, "mesh.grading[0]"),
        ("quadratic", {"m": -0.5}, "mesh.grading[1]"),
        ("cubic", {"m": 0.0}, "mesh.grading[2]"),
        ("uniform", {}, "mesh.grading[3]"),
    ]
    assert mesh.gradings[1].on == mesh.edges["outer"]


def test_the_least_a_scene_needs():
    mesh = scene(
        text="[mesh]\norder = 1\n[mesh.vertices]\na = [0, 0]\nb = [1, 0]\nc = [1, 1]\nd = [0, 1]\n"
        '[mesh.blocks]\nfluid = [["a", "b", "c", "d"]]\n'
    )
    assert (mesh.elements, mesh.title, mesh.curves, mesh.counts, mesh.gradings) == (1, "", (), (), ())
    assert dict(mesh.edges) == {}


def test_scenes_are_read_only():
    mesh = scene()
    with pytest.raises(dataclasses.FrozenInstanceError):
        mesh.order = 3
    with pytest.raises(TypeError):
        mesh.vertices["a"] = (0.0, 0.0)


def test_load_with_overrides(tmp_path):
    path = tmp_path / "ring.toml"
    path.write_text(SCENE, encoding="utf-8")
    mesh = load_mesh_scene(path, ["mesh.order=6", "constants.r=0.25", "mesh.count[0].elements=5"])
    assert (mesh.order, mesh.vertices["b"], mesh.counts[0].elements) == (6, (0.5, 0.0), 5)
    assert mesh.file == str(path)
    assert load_mesh_scene(path).order == 4


def test_errors_name_the_file(tmp_path):
    path = tmp_path / "ring.toml"
    path.write_text(SCENE, encoding="utf-8")
    with pytest.raises(SceneError, match=r"ring\.toml: mesh\.order: got the text 'six'; expected an integer"):
        load_mesh_scene(path, ["mesh.order=six"])
    with pytest.raises(SceneError, match=r"ring\.toml: mesh\.order: it is the number 4, not a table"):
        load_mesh_scene(path, ["mesh.order.x=1"])
    with pytest.raises(SceneError, match="no such file"):
        load_mesh_scene(tmp_path / "other.toml")


# --- constants ----------------------------------------------------------------------------------------------------


def test_constants_use_those_above():
    constants = constants_of({"constants": {"a": 2, "b": "a**2", "c": "a*b + pi"}})
    assert constants == {"a": 2.0, "b": 4.0, "c": 8.0 + math.pi}
    assert list(constants) == ["a", "b", "c"]
    assert constants_of({}) == {}


@pytest.mark.parametrize(
    ("constants", "message"),
    [
        ({"a": "2*b", "b": 1}, r"^constants\.a: '2\*b' uses 'b', which is not known yet; move it below"),
        ({"a": "a + 1"}, r"^constants\.a: 'a \+ 1' uses the constant itself; expected a number or constants above"),
        ({"a": "2*zz"}, r"^constants\.a: expression \"2\*zz\": the name 'zz' is not known"),
        ({"a": "x"}, "the name 'x' has no meaning here"),
        ({"a": True}, r"^constants\.a: got the boolean true; expected a number or an expression of earlier constants"),
        ({"a": [1]}, "got a list of 1; expected a number"),
        ({"a": "1/0"}, r'^constants\.a: expression "1/0" is inf'),
        ({"a": math.inf}, "expected a finite number"),
        ({"x": 1}, r"^constants\.x: 'x' has a meaning of its own in expressions; choose another name"),
        ({"t": 1}, "'t' has a meaning of its own"),
        ({"pi": 3}, "'pi' has a meaning of its own"),
        ({"sin": 3}, "'sin' has a meaning of its own"),
        ({"lambda": 3}, "'lambda' has a meaning of its own"),
        ({"a-b": 3}, r"^constants\.a-b: got the name 'a-b'; expected letters"),
        ({"2a": 3}, "got the name '2a'"),
        ({"ρ": 3}, "got the name 'ρ'"),
        ({"": 3}, "got the name ''"),
        (3, "^constants: got the number 3; expected a table"),
    ],
)
def test_constants_refused(constants, message):
    with pytest.raises(SceneError, match=message):
        constants_of({"constants": constants})


# --- refusals -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("title=3", "title: got the number 3; expected a text"),
        ("mesh=3", r"mesh: got the number 3; expected a table \[mesh\]"),
        ("mesh.order=0", "mesh.order: got 0; expected an integer of at least 1 and of at most 32"),
        ("mesh.order=33", "mesh.order: got 33"),
        ("mesh.order=true", "mesh.order: got the boolean true"),
        ("mesh.elements=0", "mesh.elements: got 0; expected an integer of at least 1"),
        (
            "mesh.odrer=3",
            r"mesh\.odrer: unknown key\. Did you mean 'order'\? Known keys: .*vertices, blocks, edges, order",
        ),
        ("mesh.vertices={}", r"mesh\.vertices: there are no vertices"),
        ("mesh.vertices.a=[1, 2, 3]", r"mesh\.vertices\.a: got a list of 3; expected two values"),
        ('mesh.vertices.a=["rr", 0]', r"mesh\.vertices\.a\[0\]: expression \"rr\": the name 'rr' is not known"),
        ("mesh.vertices.a=[nan, 0]", r"mesh\.vertices\.a\[0\]: got nan"),
        ("mesh.blocks={}", r"mesh\.blocks: there are no blocks"),
        ("mesh.blocks.fluid=[]", r"mesh\.blocks\.fluid: got an empty list; expected a list of quads"),
        ("mesh.blocks.fluid=a", r"mesh\.blocks\.fluid: got the text 'a'; expected a list of quads"),
        ('mesh.blocks.fluid=["a", "b"]', r"mesh\.blocks\.fluid\[0\]: got the text 'a'; expected the names of four"),
        (
            'mesh.blocks.fluid=[["a", "b", "c"]]',
            r"mesh\.blocks\.fluid\[0\]: got a list of 3; expected the names of four vertices",
        ),
        (
            'mesh.blocks.fluid=[["a", "b", "c", 4]]',
            r"mesh\.blocks\.fluid\[0\]: got a list of 4; expected the names of four",
        ),
        (
            'mesh.blocks.fluid=[["a", "b", "c", "z"]]',
            r"mesh\.blocks\.fluid\[0\]: unknown vertex 'z'\. Expected names from",
        ),
        ('mesh.blocks.fluid=[["a", "b", "c", "a"]]', r"mesh\.blocks\.fluid\[0\]: the vertex 'a' occurs more than once"),
        ('mesh.edges.inner=["a", "b"]', r"mesh\.edges\.inner: .* Put one more pair of brackets around it"),
        ('mesh.edges.inner=[["a", "A"]]', r"mesh\.edges\.inner\[0\]: unknown vertex 'A'\. Did you mean 'a'\?"),
        ("mesh.edges=3", r"mesh\.edges: got the number 3; expected a table"),
        ("mesh.curve[0].on=iner", r"mesh\.curve\[0\]\.on: got 'iner'\. Did you mean 'inner'\? .*: 'inner', 'outer'"),
        ('mesh.curve[0].on=["d", "a"]', r"mesh\.curve\[0\]\.on: .* Put one more pair of brackets around it"),
        ('mesh.curve[0].on=[["d", "z"]]', r"mesh\.curve\[0\]\.on\[0\]: unknown vertex 'z'"),
        ("mesh.curve[0].on=3", r"mesh\.curve\[0\]\.on: got the number 3; expected a list of paths"),
        ("mesh.curve[0].kind=ark", r"mesh\.curve\[0\]\.kind: got 'ark'\. Did you mean 'arc'\?"),
        (
            "mesh.curve[0].through=[1, 1]",
            r"mesh\.curve\[0\]: an arc with 'center' and 'through'; expected exactly",
        ),
        ("mesh.curve[0].center=[1]", r"mesh\.curve\[0\]\.center: got a list of 1"),
        ("mesh.curve[0].radius=1", r"mesh\.curve\[0\]\.radius: unknown key\. .*Known keys: on, kind, center, through"),
        ("mesh.curve[2].x=cos(t)", r"mesh\.curve\[2\]\.x: expression \"cos\(t\)\": the name 't' has no meaning here"),
        ("mesh.curve[2].center=[0, 0]", r"mesh\.curve\[2\]\.center: unknown key"),
        ("mesh.curve=3", r"mesh\.curve: got the number 3; expected an array of tables\. Write \[\[mesh\.curve\]\]"),
        ("mesh.count[0].elements=0", r"mesh\.count\[0\]\.elements: got 0; expected an integer of at least 1"),
        ("mesh.count[0].number=3", r"mesh\.count\[0\]\.number: unknown key"),
        ("mesh.grading[0].kind=linear", r"mesh\.grading\[0\]\.kind: got 'linear'"),
        ("mesh.grading[0].a=51", r"mesh\.grading\[0\]\.a: got 51; expected a number of at least -50 and of at most 50"),
        ("mesh.grading[0].m=0.1", r"mesh\.grading\[0\]\.m: unknown key"),
        ("mesh.grading[1].m=1", r"mesh\.grading\[1\]\.m: got 1; expected a number above -1 and below 1"),
        ("mesh.grading[1].m=-1.0", r"mesh\.grading\[1\]\.m: got -1\.0"),
        ("mesh.grading[2].m=-0.1", r"mesh\.grading\[2\]\.m: got -0\.1; expected a number of at least 0 and below 1"),
        ("mesh.grading[3].m=0.1", r"mesh\.grading\[3\]\.m: unknown key\. .*Known keys: leaving, on, kind"),
    ],
)
def test_mistakes_have_a_place(override, message):
    with pytest.raises(SceneError, match=f"^ring.toml: {message}") as caught:
        scene(override)
    assert caught.value.file == "ring.toml"


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("order = 4\n", r"mesh\.order: the required key is missing"),
        ('kind = "arc"\n', r"mesh\.curve\[0\]\.kind: the required key is missing"),
        ("center = [0, 0]\n", r"mesh\.curve\[0\]: an arc with none of 'center', 'through' and 'angle'"),
        ('on = "inner"\n', r"mesh\.curve\[0\]\.on: the required key is missing"),
        ('y = "s"\n', r"mesh\.curve\[2\]\.y: the required key is missing"),
        ("elements = 3\n", r"mesh\.count\[0\]\.elements: the required key is missing"),
        ("a = 1.8\n", r"mesh\.grading\[0\]\.a: the required key is missing"),
        ("m = -0.5\n", r"mesh\.grading\[1\]\.m: the required key is missing"),
    ],
)
def test_missing_keys(line, message):
    with pytest.raises(SceneError, match=message):
        scene(text=replaced(line, ""))


def test_a_misspelt_mesh_table_is_found():
    with pytest.raises(SceneError, match=r"mesh: the required key is missing\. Is it misspelt as 'mehs'\?"):
        scene(text=SCENE.replace("[mesh", "[mehs"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('title = "x"\n', r"^ring\.toml: mesh: the required key is missing\. Add a table \[mesh\]$"),
        ("[mesh]\norder = 2\n", r"mesh: there are no blocks; expected \[mesh\.vertices\] and \[mesh\.blocks\], or"),
        (
            "[mesh.vertixes]\na = [0, 0]\n",
            r"mesh\.vertices: the required key is missing\. Is it misspelt as 'vertixes'",
        ),
        ("[mesh.vertices]\na = [0, 0]\n", r"mesh\.blocks: the required key is missing\. Add a table \[mesh\.blocks\]"),
    ],
)
def test_scenes_without_blocks(text, message):
    with pytest.raises(SceneError, match=message):
        scene(text=text)


def test_a_name_without_any_named_edges():
    text = SCENE.replace('[mesh.edges]\ninner = [["d", "a"]]\nouter = [["e", "f", "g"], ["b", "c"]]\n', "")
    with pytest.raises(SceneError, match=r"curve\[0\]\.on: got 'inner'\. .*names of \[mesh\.edges\]: none"):
        scene(text=text)
