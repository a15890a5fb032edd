import numpy as np

from hoblock.cli import main


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


def test_the_distance_from_the_curves_is_reported(scene, capsys):
    distances = []
    for order in (1, 2, 6):
        assert main(["check", str(scene), "--order", str(order), "--set", "mesh.elements=8"]) == 0
        (line,) = (line for line in capsys.readouterr().out.splitlines() if line.startswith("curve fit"))
        assert line.endswith("(1 curved edge, worst a–b)")
        distances.append(float(line.split()[3]))
    assert 0.2 * (1 - np.cos(np.pi / 16)) * 0.9 < distances[0] < 0.2 * (1 - np.cos(np.pi / 16))
    assert distances[2] < 1e-8 < distances[1] < 1e-3
    assert main(["check", str(scene), "--set", "mesh.curve=[]"]) == 0
    assert "curve fit" not in capsys.readouterr().out
