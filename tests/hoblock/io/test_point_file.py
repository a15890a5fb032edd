"""Points of curves in text files."""

import pytest

from hoblock.errors import SceneError
from hoblock.io.point_file import read_points

POINTS = ((1.0, 0.5), (0.25, -1e-3), (0.0, 0.0))


@pytest.mark.parametrize(
    "text",
    [
        "1,0.5\n0.25,-1e-3\n0,0\n",
        "x, y\n1, 0.5\n0.25, -0.001\n0, 0",
        "1;0.5\n\n0.25 ; -1E-3\n# the nose\n0;0 # sharp\n",
        "NACA 0012 (made up)\n   1.0  0.5\n  0.25\t-0.001\n 0 0\n",
        "\ufeffx;y\r\n1;.5\r\n0.25;-1e-3\r\n0;-0\r\n",
    ],
)
def test_columns_as_spreadsheets_and_airfoil_tables_have_them(text, tmp_path):
    file = tmp_path / "points.csv"
    file.write_bytes(text.encode())
    assert read_points(file, "mesh.curve[0].file") == POINTS


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("1 2\n3\n", r"^mesh\.curve\[0\]\.file: .*points\.csv, line 2: got '3'; expected two numbers"),
        ("1 2\nx y\n", "line 2: got 'x y'; expected two numbers"),
        ("name\nx y\nx2 y2\n1,2,3\n", "line 4: got '1,2,3'; expected two numbers"),
        ("0,5;1,25\n", "line 1: got '0,5;1,25'; expected two numbers"),
        ("1 2\n3 inf\n", "line 2: got '3 inf'; expected finite numbers"),
        (b"\xff\xfe\x00", "is not a text file; expected two numbers a line"),
    ],
)
def test_what_is_no_list_of_points(text, match, tmp_path):
    file = tmp_path / "points.csv"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(SceneError, match=match):
        read_points(file, "mesh.curve[0].file")


def test_files_that_cannot_be_read(tmp_path, monkeypatch):
    with pytest.raises(SceneError, match=r"gone\.csv cannot be read: No such file"):
        read_points(tmp_path / "gone.csv", "mesh.curve[0].file")
    with pytest.raises(SceneError, match=r"(cannot be read: Is a directory|Permission denied)"):
        read_points(tmp_path, "mesh.curve[0].file")
    monkeypatch.setattr("hoblock.io.point_file._LARGEST", 3)
    (tmp_path / "large.csv").write_text("1 2\n", encoding="utf-8")
    with pytest.raises(SceneError, match="MB; expected a list of points"):
        read_points(tmp_path / "large.csv", "mesh.curve[0].file")
