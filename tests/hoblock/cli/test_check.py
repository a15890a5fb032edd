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
