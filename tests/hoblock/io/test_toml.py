"""TOML files and overrides."""

from __future__ import annotations

import copy

import pytest

from hoblock.errors import SceneError
from hoblock.io.toml import apply_overrides, naming_file, read_toml, repeat_option

DATA = {
    "title": "flow",
    "constants": {"U": 1.0},
    "mesh": {"order": 4, "vertices": {"a b": [0, 0], "c": ["r", 1]}},
    "solid": [{"density": 1.0, "boundary": [{"type": "fixed"}]}, {"density": 2.0}],
    "empty": [],
}


def write(folder, content, name="scene.toml"):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


# --- files --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
def test_read(tmp_path, mark, end):
    path = write(tmp_path, mark + 'title = "Strömung"'.encode() + end + b"[mesh]" + end + b"order = 4" + end)
    assert read_toml(path) == {"title": "Strömung", "mesh": {"order": 4}}
    assert read_toml(str(path)) == read_toml(path)


def test_a_missing_file_suggests_its_neighbour(tmp_path):
    write(tmp_path, "a = 1", "channel.toml")
    with pytest.raises(SceneError, match=r"chanel\.toml: no such file\. Did you mean 'channel\.toml'\?") as caught:
        read_toml(tmp_path / "chanel.toml")
    assert caught.value.file == str(tmp_path / "chanel.toml")
    with pytest.raises(SceneError, match=r"no such file\. Check the name and the folder"):
        read_toml(tmp_path / "nowhere" / "scene.toml")


def test_a_folder_is_no_file(tmp_path):
    with pytest.raises(SceneError, match="this is a folder; expected a TOML file"):
        read_toml(tmp_path)


def test_a_path_through_a_file_cannot_be_read(tmp_path):
    write(tmp_path, "a = 1")
    with pytest.raises(SceneError, match="cannot be read"):
        read_toml(tmp_path / "scene.toml" / "other.toml")
    with pytest.raises(SceneError, match="cannot be read"):
        read_toml("scene\0.toml")


@pytest.mark.parametrize("content", ["", "\n\n", "# only a comment\n"])
def test_an_empty_file(tmp_path, content):
    with pytest.raises(SceneError, match=r"scene\.toml: the file is empty: expected at least \[mesh\]"):
        read_toml(write(tmp_path, content))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("[mesh]\norder = = 4\n", r"scene\.toml: not valid TOML: .*line 2, column 9"),
        ("[mesh]\na = 1\na = 2\n", r"not valid TOML: Cannot overwrite a value \(at line 3, column 6\)"),
        ("[mesh\n", r"not valid TOML: .*line 1"),
        ("a = " + "[" * 5000, "nested too deeply"),
        ("a = " + "1" * 5000, "a number is too long"),
        (b"a = '\xff'", r"not UTF-8 text \(byte 5\); save the file as UTF-8"),
    ],
)
def test_what_is_not_toml(tmp_path, content, message):
    with pytest.raises(SceneError, match=message):
        read_toml(write(tmp_path, content))


def test_the_first_file_named_stays():
    with pytest.raises(SceneError, match=r"^inner\.toml: a: b$"), naming_file("outer.toml"), naming_file("inner.toml"):
        raise SceneError("b", "a")


# --- overrides ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("override", "read", "expected"),
    [
        ("mesh.order=6", lambda d: d["mesh"]["order"], 6),
        (" mesh.order = 6 ", lambda d: d["mesh"]["order"], 6),
        ("constants.U=-2.5e-1", lambda d: d["constants"]["U"], -0.25),
        ("constants.V=2", lambda d: d["constants"], {"U": 1.0, "V": 2}),
        ("time.steady=true", lambda d: d["time"], {"steady": True}),
        ("a.b.c=1", lambda d: d["a"], {"b": {"c": 1}}),
        ("title=vortex street", lambda d: d["title"], "vortex street"),
        ('title="a = b"', lambda d: d["title"], "a = b"),
        ("title=a=b", lambda d: d["title"], "a=b"),
        ('title=""', lambda d: d["title"], ""),
        ("fluid.x=4*U*y", lambda d: d["fluid"]["x"], "4*U*y"),
        ("title=1\nx = 2", lambda d: (d["title"], "x" in d), ("1\nx = 2", False)),
        ("solid[1].density=3", lambda d: d["solid"][1]["density"], 3),
        ("solid.1.density=3", lambda d: d["solid"][1]["density"], 3),
        ("solid[0].boundary[0].type=free", lambda d: d["solid"][0]["boundary"], [{"type": "free"}]),
        ("solid.0.boundary.0.on=inlet", lambda d: d["solid"][0]["boundary"][0]["on"], "inlet"),
        ('mesh.vertices."a b"=[1, 2]', lambda d: d["mesh"]["vertices"]["a b"], [1, 2]),
        ("mesh.vertices.c[0]=0.5", lambda d: d["mesh"]["vertices"]["c"], [0.5, 1]),
        ("output={every = 3}", lambda d: d["output"], {"every": 3}),
        ("mesh.vertices.7=[1, 2]", lambda d: d["mesh"]["vertices"]["7"], [1, 2]),
    ],
)
def test_overrides(override, read, expected):
    before = copy.deepcopy(DATA)
    assert read(apply_overrides(DATA, [override])) == expected
    assert before == DATA


def test_overrides_are_applied_in_order():
    assert apply_overrides({}, ["a.b=1", "a.c=2", "a.b=3"]) == {"a": {"b": 3, "c": 2}}
    assert apply_overrides(DATA, []) == DATA


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("mesh.order", r"^--set: got 'mesh\.order'; expected key=value, for example mesh\.order=6"),
        ("=3", "expected key=value"),
        (" =3", "expected key=value"),
        ("mesh.order=", r'without a value; write key="" for an empty text'),
        ("mesh.order= ", "without a value"),
        ("a=[1, 2", "begins like a TOML list, table or text but is none"),
        ("a='x", "begins like a TOML"),
        ("mesh..order=1", r"the key cannot be read at character 6"),
        (".mesh=1", "the key cannot be read at character 1"),
        ("mesh.=1", "the key cannot be read at character 6"),
        ("[0].a=1", "the key cannot be read at character 1"),
        ("solid[-1].density=1", "the key cannot be read at character 6"),
        ("solid[x]=1", "the key cannot be read at character 6"),
        ("mesh order=1", "expected a dot after 'mesh'"),
        (
            "mesh.order.p=1",
            r"^mesh\.order: it is the number 4, not a table; --set mesh\.order\.p=1 cannot reach into it",
        ),
        ("title.x=1", "title: it is the text 'flow', not a table"),
        ("title[0]=1", "title: it is the text 'flow', not a list"),
        ("mesh[0]=1", "mesh: it is a table, not a list"),
        ("solid[2].density=1", r"^solid: got the index 2; expected an index from 0 to 1"),
        ("solid.density=1", r"^solid: got the index density; expected an index from 0 to 1"),
        ("empty[0]=1", "expected no index, the list is empty"),
        ("motion[0].x=1", r"^motion: there is no such list"),
    ],
)
def test_overrides_refused(override, message):
    with pytest.raises(SceneError, match=message):
        apply_overrides(DATA, [override])


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (
            ["run", "s.toml", "--set", "a=1", "b.c=2", "-o", "x"],
            ["run", "s.toml", "--set", "a=1", "--set", "b.c=2", "-o", "x"],
        ),
        (["--set", "a=1", "s.toml"], ["--set", "a=1", "s.toml"]),
        (["--set", "a=1", "--set", "b=2", "c=[1, 2]"], ["--set", "a=1", "--set", "b=2", "--set", "c=[1, 2]"]),
        (["a=1", "--set"], ["a=1", "--set"]),
        (["--set", "a=1", "dir/x=3.toml"], ["--set", "a=1", "dir/x=3.toml"]),
    ],
)
def test_several_changes_after_one_option(words, expected):
    assert repeat_option(words) == expected
