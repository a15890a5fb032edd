import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hoblock.cli import main
from hoblock.io.npz import read_npz

SCENE = """
title = "a bent channel"
[constants]
h = 0.2
[mesh]
order = 3
elements = 2
[mesh.vertices]
a = [0, 0]
b = [2, 0]
c = [2, 1]
d = [0, 1]
e = [4, 0]
f = [4, 1]
[mesh.blocks]
fluid = [["a", "b", "c", "d"]]
solid = [["b", "e", "f", "c"]]
[mesh.edges]
bottom = [["a", "b", "e"]]
inlet = [["a", "d"]]
[[mesh.curve]]
on = [["a", "b"]]
kind = "parametric"
x = "2*s"
y = "h*sin(pi*s)"
[[mesh.count]]
on = [["b", "e"]]
elements = 3
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "bent.toml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def test_check_reports_size_and_quality(scene, capsys):
    assert main(["check", str(scene)]) == 0
    out, err = capsys.readouterr()
    rows = dict(line.split(maxsplit=1) for line in out.replace("det J", "det_J").splitlines())
    assert err == ""
    assert rows["scene"] == f"{scene}: a bent channel"
    assert rows["blocks"] == "2 (3 chains of opposite edges)"
    assert rows["elements"] == "10 of order 3"
    assert rows["nodes"] == str(16 * 7)
    assert rows["groups"] == "fluid (4), solid (6)"
    assert rows["edges"] == "bottom (5), inlet (2)"
    assert rows["det_J"].startswith("min 0.0") or rows["det_J"].startswith("min 0.1")
    assert rows["skewness"].startswith("max 0.")


def test_order_and_values_can_be_changed(scene, capsys):
    assert main(["check", str(scene), "--order", "5", "--set", "mesh.elements=4", "--set", "constants.h=0"]) == 0
    out = capsys.readouterr().out
    assert "elements         28 of order 5" in out
    assert "scaled Jacobian  min 1, mean 1" in out


def test_mesh_writes_a_file(scene, tmp_path, capsys):
    path = tmp_path / "bent.npz"
    assert main(["mesh", str(scene), "-o", str(path), "--order", "2"]) == 0
    assert f"wrote {path}" in capsys.readouterr().out
    mesh = read_npz(path)
    assert mesh.order == 2
    assert mesh.points[mesh.edge_nodes("bottom"), 1].max() == pytest.approx(0.2)


@pytest.mark.parametrize("suffix", ["msh", "vtu"])
def test_mesh_writes_other_formats(suffix, scene, tmp_path):
    pytest.importorskip("meshio")
    path = tmp_path / f"bent.{suffix}"
    assert main(["mesh", str(scene), "--output", str(path)]) == 0
    assert path.stat().st_size > 1000


def test_plot_draws(scene, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    path = tmp_path / "bent.png"
    assert main(["plot", str(scene), "-o", str(path), "--names", "--color", "groups"]) == 0
    assert path.read_bytes().startswith(b"\x89PNG")
    assert capsys.readouterr().out == f"wrote {path}\n"


def test_plot_draws_an_invalid_mesh_and_fails(scene, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    path = tmp_path / "bad.png"
    assert main(["plot", str(scene), "-o", str(path), "--set", "constants.h=1.3"]) == 2
    assert path.exists()
    assert "elements have det J <= 0 somewhere. Worst: element" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["check", "{scene}", "--set", "mesh.order=0"], "{scene}: mesh.order: got 0; expected an integer"),
        (["check", "{scene}", "--set", "constants.h=1.3"], "{scene}: 4 of 10 elements have det J <= 0 somewhere"),
        (["check", "{scene}", "--set", "mesh.vertices.c=[2, -1]"], "{scene}: mesh: blocks."),
        (["check", "{scene}", "--set", 'mesh.curve[0].y="0.1 + h*s"'], "{scene}: mesh.curve[0] on a–b: curve: end"),
        (["check", "{scene}", "--set", 'mesh.curve[0].y="log(s)"'], "{scene}: mesh.curve[0].y: expression"),
        (["check", "missing.toml"], "missing.toml: no such file"),
        (["mesh", "{scene}", "-o", "mesh.stl"], "{scene}: mesh.stl: suffix is '.stl'; expected one of"),
        (["mesh", "{scene}", "-o", "no/such/folder.npz"], "no/such/folder.npz: No such file or directory"),
    ],
)
def test_errors_are_one_message_and_exit_code_2(arguments, message, scene, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert main([word.format(scene=scene) for word in arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("hoblock: " + message.format(scene=scene))
    assert err.count("\n") == 1


def test_missing_matplotlib_is_an_error_of_one_message(scene, tmp_path, capsys, monkeypatch):
    for name in [name for name in sys.modules if name.split(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert main(["plot", str(scene), "-o", str(tmp_path / "m.png")]) == 2
    assert "pip install 'hoblock[plot]'" in capsys.readouterr().err


def test_usage_errors_exit_with_2(capsys):
    with pytest.raises(SystemExit) as exit_info:
        main(["mesh", "scene.toml"])
    assert exit_info.value.code == 2
    assert "-o/--output" in capsys.readouterr().err


def test_python_m_hoblock(scene):
    import hoblock

    source = str(Path(hoblock.__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": source}
    command = [sys.executable, "-m", "hoblock", "check", str(scene), "--set", "mesh.vertices.f=1"]
    result = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert result.returncode == 2
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert "mesh.vertices.f" in result.stderr


@pytest.mark.parametrize("name", ["csm1", "dfg_2d_1", "fsi1", "wall_ramm"])
def test_example_scenes_have_valid_meshes(name, capsys, tmp_path):
    path = Path(__file__).parents[2] / "examples" / f"{name}.toml"
    if not path.exists():
        pytest.skip("the examples are not beside these tests")
    assert main(["mesh", str(path), "-o", str(tmp_path / "mesh.npz")]) == 0
    assert "certified" in capsys.readouterr().out
    mesh = read_npz(tmp_path / "mesh.npz")
    assert np.isfinite(mesh.points).all()
