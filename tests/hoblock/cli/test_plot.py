import sys

import pytest

from hoblock.cli import main


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
    assert " elements are invalid: det J <= 0 somewhere. Worst: element" in capsys.readouterr().err


def test_missing_matplotlib_is_an_error_of_one_message(scene, tmp_path, capsys, monkeypatch):
    for name in [name for name in sys.modules if name.split(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert main(["plot", str(scene), "-o", str(tmp_path / "m.png")]) == 2
    assert "pip install 'hoblock[plot]'" in capsys.readouterr().err


def test_plot_of_a_mesh_file(file, bad_file, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    for source, code in ((file, 0), (bad_file, 2)):
        path = tmp_path / "file.svg"
        assert main(["plot", str(source), "-o", str(path), "--color", "skewness", "--numbers", "--nodes"]) == code
        assert f"<!-- {source.name} -->" in path.read_text(encoding="utf-8")
    assert "element 1, det J" in capsys.readouterr().err


def test_plot_options(scene, tmp_path):
    pytest.importorskip("matplotlib")
    path = tmp_path / "part.svg"
    options = ["--names", "--counts", "--blocks-only", "--zoom", "-0.1", "2.5", "-0.1", "1.1", "--width", "5"]
    assert main(["plot", str(scene), "-o", str(path), *options]) == 0
    text = path.read_text(encoding="utf-8")
    assert "<!-- a -->" in text
    assert "<!-- e -->" not in text
    assert "<!-- bottom -->" in text
    assert main(["plot", str(scene), "-o", str(path), "--no-edges"]) == 0
    assert "<!-- bottom -->" not in path.read_text(encoding="utf-8")
