import numpy as np
import pytest

from hoblock.cli import main
from hoblock.io.npz import read_npz
from hoblock.resampling import geometric_error


def test_convert_changes_the_order(file, tmp_path, capsys):
    up, down = tmp_path / "up.npz", tmp_path / "down.npz"
    assert main(["convert", str(file), str(up), "--order", "6"]) == 0
    assert "order 3 to 6: the same geometry" in capsys.readouterr().out
    assert main(["convert", str(up), str(down), "--order", "1"]) == 0
    out = capsys.readouterr().out
    mesh = read_npz(file)
    assert geometric_error(read_npz(up), mesh) < 1e-14
    # Chords of two elements a half wave: 0.2 sin(π t) at t = 1/4 is 0.2 (√2 - 1)/2 above the chord.
    assert float(out.partition("moved by up to ")[2].split()[0]) == pytest.approx(0.2 * (2**0.5 - 1) / 2, rel=0.1)
    assert dict(read_npz(down).edge_groups).keys() == {"bottom", "inlet"}


@pytest.mark.parametrize("name", ["bent.msh", "bent.vtu", "bent.inp"])
def test_convert_tells_the_format_by_the_suffix(name, file, tmp_path, capsys):
    pytest.importorskip("meshio")
    assert main(["convert", str(file), str(tmp_path / name)]) == 0
    assert f"wrote {tmp_path / name}" in capsys.readouterr().out
    assert (tmp_path / name).stat().st_size > 1000


def test_convert_refuses_a_bad_mesh_unless_told(bad_file, tmp_path, capsys):
    path = tmp_path / "out.npz"
    assert main(["convert", str(bad_file), str(path)]) == 2
    assert "1 of 2 elements are not valid. Worst: element 1" in capsys.readouterr().err
    assert not path.exists()
    assert main(["convert", str(bad_file), str(path), "--unchecked"]) == 0
    np.testing.assert_array_equal(read_npz(path).points, read_npz(bad_file).points)


def test_unknown_formats_are_refused_by_the_parser(file, capsys):
    with pytest.raises(SystemExit) as exit_info:
        main(["convert", str(file), "a.dat", "--format", "stl"])
    assert exit_info.value.code == 2
    assert "invalid choice: 'stl'" in capsys.readouterr().err
