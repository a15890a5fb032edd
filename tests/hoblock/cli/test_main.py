import os
import subprocess
import sys
from pathlib import Path

import pytest

from hoblock.cli import main


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["check", "{scene}", "--set", "mesh.order=0"], "{scene}: mesh.order: got 0; expected an integer"),
        (
            ["check", "{scene}", "--set", "constants.h=1.3"],
            "{scene}: 4 of 10 elements are invalid: det J <= 0 somewhere",
        ),
        (["check", "{scene}", "--set", "mesh.vertices.c=[2, -1]"], "{scene}: mesh: blocks."),
        (["check", "{scene}", "--set", 'mesh.curve[0].y="0.1 + h*s"'], "{scene}: mesh.curve[0] on a–b: curve: end"),
        (["check", "{scene}", "--set", 'mesh.curve[0].y="log(s)"'], "{scene}: mesh.curve[0].y: expression"),
        (["check", "missing.toml"], "missing.toml: no such file"),
        (
            ["check", "m.msh"],
            "check: m.msh is a mesh file; expected a scene (.toml). For a mesh file use: hoblock quality",
        ),
        (["mesh", "m.npz", "-o", "a.vtu"], "mesh: m.npz is a mesh file; expected a scene (.toml)."),
        (
            ["convert", "{scene}", "a.vtu"],
            "convert: {scene} is a scene; expected a mesh file. For a scene use: hoblock mesh {scene} -o a.vtu.",
        ),
        (["mesh", "{scene}", "-o", "folder.vtu"], "folder.vtu: Is a directory. Give the name of a file."),
        (["quality", "folder.vtu"], "folder.vtu: Is a directory. Give the name of a file."),
        (["mesh", "{scene}", "-o", "mesh.stl"], "mesh.stl: suffix is '.stl'; expected one of"),
        (
            ["mesh", "{scene}", "-o", "no/such/folder.npz"],
            "no/such/folder.npz: No such file or directory. There is no folder no/such: make it first.",
        ),
    ],
)
def test_errors_are_one_message_and_exit_code_2(arguments, message, scene, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.vtu").mkdir()
    assert main([word.format(scene=scene) for word in arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("hoblock: " + message.format(scene=scene))
    assert err.count("\n") == 1


def test_files_that_may_not_be_written_have_a_way_out(scene, capsys, monkeypatch):
    def refuse(part, path):
        raise PermissionError(13, "Permission denied", str(part))

    monkeypatch.setattr(os, "replace", refuse)
    target = scene.with_name("a.vtu")
    remedy = "Check the rights of the file and its folder, or choose another folder."
    assert main(["mesh", str(scene), "-o", str(target)]) == 2
    assert capsys.readouterr().err == f"hoblock: {target}: Permission denied. {remedy}\n"


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


def test_version(capsys):
    with pytest.raises(SystemExit) as exit_info:
        main(["--version"])
    assert exit_info.value.code == 0
    assert capsys.readouterr().out.startswith("hoblock 0.")


@pytest.mark.parametrize("command", ["check", "mesh", "quality", "plot", "convert"])
def test_help_texts(command, capsys):
    with pytest.raises(SystemExit) as exit_info:
        main([command, "--help"])
    assert exit_info.value.code == 0
    out = capsys.readouterr().out
    assert out.startswith(f"usage: hoblock {command}")
    assert "--order" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["quality", "{file}", "--order", "2"], "quality: --set and --order change a scene, but {file} is a mesh file"),
        (["plot", "{file}", "-o", "a.png", "--set", "mesh.order=2"], "plot: --set and --order change a scene"),
        (["plot", "{file}", "-o", "a.png", "--counts"], "plot: --counts needs blocks, but {file} is a mesh file"),
        (["plot", "{file}", "-o", "a.jpg"], "a.jpg: suffix is '.jpg'; expected one of .pdf, .png, .svg"),
        (["plot", "{file}", "-o", "a.png", "--zoom", "1", "0", "0", "1"], "plot: --zoom is 1 0 0 1; expected X0 < X1"),
        (["plot", "{file}", "-o", "a.png", "--width", "0"], "plot: --width is 0; expected 1 to 100 inches"),
        (["plot", "{file}", "-o", "a.png", "--dpi", "1"], "plot: --dpi is 1; expected 10 to 2000"),
        (["quality", "{file}", "--worst", "-1"], "quality: --worst is -1; expected 0 or more"),
        (["quality", "no/folder.npz"], "no/folder.npz: No such file or directory. Check the name and the folder."),
        (["quality", "nothing.npz"], "nothing.npz: No such file or directory. Check the name and the folder."),
        (["quality", "mesh.stl"], "mesh.stl: suffix is '.stl'; expected one of"),
        (["convert", "{file}", "a.npz", "--order", "0"], "convert: --order is 0; expected 1 to 32"),
        (["convert", "{file}", "a.stl"], "a.stl: suffix is '.stl'; expected one of"),
        (["convert", "{file}", "no/such/folder.npz"], "no/such/folder.npz: No such file or directory"),
    ],
)
def test_bad_use_of_mesh_files_is_one_message(arguments, message, file, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert main([word.format(file=file) for word in arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("hoblock: " + message.format(file=file))
    assert err.count("\n") == 1


def test_a_reader_that_leaves_early_is_no_error():
    command = [sys.executable, "-m", "hoblock", "templates", "naca_c_grid"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    process.stdout.close()
    assert process.stderr.read() == ""
    assert process.wait() == 0
    process.stderr.close()
