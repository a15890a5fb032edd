from pathlib import Path

import numpy as np
import pytest

from hoblock.cli import main
from hoblock.io.npz import read_npz


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


def test_format_overrides_the_suffix(scene, tmp_path):
    path = tmp_path / "bent.dat"
    assert main(["mesh", str(scene), "-o", str(path), "--format", "ism-v2"]) == 0
    assert path.read_text(encoding="utf-8").startswith("ISM-V2\n")


def test_what_a_format_cannot_hold_is_said(scene, tmp_path, capsys):
    gradings = [
        'mesh.grading=[{on=[["a", "b"]], kind="exponential", a=1}, {on=[["a", "d"]], kind="exponential", a=1}]',
        'mesh.curve=[{on=[["a", "b"]], kind="parametric", x="2*s", y="h*sin(pi*s)"}, '
        '{on=[["a", "d"]], kind="parametric", x="-h*sin(pi*s)", y="s"}]',
    ]
    changes = [word for change in gradings for word in ("--set", change)]
    assert main(["mesh", str(scene), "-o", str(tmp_path / "a.inp"), *changes]) == 0
    assert "rebuilt from these, inner nodes are up to " in capsys.readouterr().out
    assert main(["mesh", str(scene), "-o", str(tmp_path / "a.inp")]) == 0
    assert "inner nodes" not in capsys.readouterr().out


@pytest.mark.parametrize("name", ["csm1", "dfg_2d_1", "fsi1", "wall_ramm"])
def test_example_scenes_have_valid_meshes(name, capsys, tmp_path):
    path = Path(__file__).parents[3] / "examples" / f"{name}.toml"
    if not path.exists():
        pytest.skip("the examples are not beside these tests")
    assert main(["mesh", str(path), "-o", str(tmp_path / "mesh.npz")]) == 0
    assert "certified" in capsys.readouterr().out
    mesh = read_npz(tmp_path / "mesh.npz")
    assert np.isfinite(mesh.points).all()


def test_boundaries_that_share_a_side_need_an_order(scene, tmp_path, capsys):
    path = tmp_path / "bent.inp"
    words = ["mesh", str(scene), "-o", str(path), "--set", 'mesh.edges.left=[["a", "d"]]']
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "belongs to 'inlet' and to 'left'" in err
    assert "or --boundaries on the command line" in err
    assert main([*words, "--boundaries", "left", "bottom"]) == 0
    text = path.read_text(encoding="utf-8")
    assert "left" in text
    assert "inlet" not in text
    capsys.readouterr()
    assert main(["mesh", str(scene), "-o", str(tmp_path / "a.npz"), "--boundaries", "left"]) == 2
    assert "mesh: --boundaries is for abaqus, ism" in capsys.readouterr().err
