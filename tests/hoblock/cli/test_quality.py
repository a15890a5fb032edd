import json

import numpy as np
import pytest

from hoblock.cli import main
from hoblock.io.npz import read_npz, write_npz
from hoblock.mesh import QuadMesh
from hoblock.quality import det_jacobian, equiangular_skewness, scaled_jacobian


@pytest.mark.parametrize("kind", ["scene", "file"])
def test_quality_in_json(kind, scene, file, capsys):
    assert main(["quality", str({"scene": scene, "file": file}[kind]), "--json", "--worst", "3"]) == 0
    data = json.loads(capsys.readouterr().out)
    mesh = read_npz(file)
    assert data["valid"] is True
    assert (data["cells"], data["points"], data["order"]) == (10, len(mesh.points), 3)
    assert data["area"] == pytest.approx(4 - 0.2 * 4 / np.pi, rel=1e-4)
    assert 0 < data["min_det_j_bound"] < det_jacobian(mesh, np.zeros((1, 2))).max()
    quality = scaled_jacobian(mesh)
    assert data["scaled_jacobian"]["min"] == pytest.approx(quality.min())
    assert data["scaled_jacobian"]["mean"] == pytest.approx(quality.mean())
    assert data["skewness"]["max"] == pytest.approx(equiangular_skewness(mesh).max())
    for measure in ("scaled_jacobian", "jacobian_ratio", "skewness", "aspect_ratio", "size_jump"):
        histogram = data[measure]["histogram"]
        assert sum(histogram["counts"]) == 10
        assert len(histogram["edges"]) == len(histogram["counts"]) + 1
    worst = data["worst_elements"]
    assert [bad["element"] for bad in worst] == np.argsort(quality, kind="stable")[:3].tolist()
    assert worst[0]["block"] == (None if kind == "file" else "blocks.fluid[0] (a, b, c, d)")


def test_quality_in_words(scene, capsys):
    assert main(["quality", str(scene)]) == 0
    out = capsys.readouterr().out
    assert out.startswith(f"scene            {scene}\n")
    assert "verdict          valid" in out
    for name in ("scaled Jacobian: min", "Jacobian ratio: min", "skewness: min", "aspect ratio: min", "size jump: min"):
        assert name in out
    assert out.count("█") > 40
    assert out.count(" in blocks.") == 5


def test_histograms_have_no_empty_bins_at_their_ends(file, capsys):
    assert main(["quality", str(file)]) == 0
    out = capsys.readouterr().out
    assert out.startswith(f"mesh             {file}\n")
    tables = [part.splitlines()[1:] for part in out.split("\n\n") if "█" in part]
    assert len(tables) == 5
    assert all(table[k].endswith("█") for table in tables for k in (0, -1))
    assert [sum(int(line.split()[3]) for line in table) for table in tables] == [10] * 5


def test_quality_of_a_bad_mesh_is_reported_in_full_with_exit_code_2(scene, bad_file, capsys):
    for source, block in ((bad_file, None), (scene, "blocks.fluid[0] (a, b, c, d)")):
        changes = ["--set", "constants.h=1.3"] if source == scene else []
        assert main(["quality", str(source), "--json", *changes]) == 2
        out, err = capsys.readouterr()
        data = json.loads(out)
        assert data["valid"] is False
        assert data["verdict"] == "invalid"
        assert data["worst_elements"][0]["status"] == "invalid"
        assert data["worst_elements"][0]["block"] == block
        assert err.startswith(f"hoblock: {source}: ")
        assert err.count("\n") == 1
    assert main(["quality", str(bad_file)]) == 2
    assert "not certified (1 valid, 1 invalid)" in capsys.readouterr().out


def test_quality_in_json_stays_json_without_finite_nodes(tmp_path, capsys):
    points = np.array([(0, 0), (1, 0), (0, 1), (np.nan, 1)])
    write_npz(tmp_path / "nan.npz", QuadMesh(points, np.arange(4)[None], 1, {}, {}))
    assert main(["quality", str(tmp_path / "nan.npz"), "--json"]) == 2

    def refuse(word):
        raise AssertionError(word)

    data = json.loads(capsys.readouterr().out, parse_constant=refuse)
    assert data["min_det_j_bound"] is None
