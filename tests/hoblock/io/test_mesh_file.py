import numpy as np
import pytest

from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.mesh_file import write_mesh
from hoblock.io.npz import read_npz


@pytest.fixture
def mesh(layouts):
    return generate(layouts.square(counts=2), 3)


@pytest.mark.parametrize(
    ("name", "start"), [("m.msh", b"$MeshFormat"), ("m.VTU", b'<?xml version="1.0"?>\n<VTKFile'), ("m.npz", b"PK")]
)
def test_the_suffix_tells_the_format(name, start, mesh, tmp_path):
    if not name.endswith(".npz"):
        pytest.importorskip("meshio")
    (tmp_path / name).write_text("something old and much longer than a mesh " * 1000)
    write_mesh(str(tmp_path / name), mesh)
    data = (tmp_path / name).read_bytes()
    assert data.startswith(start)
    assert b"something old" not in data


def test_npz_comes_back(mesh, tmp_path):
    write_mesh(tmp_path / "m.npz", mesh)
    np.testing.assert_array_equal(read_npz(tmp_path / "m.npz").points, mesh.points)


@pytest.mark.parametrize("name", ["mesh.stl", "mesh"])
def test_unknown_suffixes(name, mesh, tmp_path):
    with pytest.raises(MeshFileError, match=r"suffix is '.*'; expected one of \.msh, \.npz, \.vtu"):
        write_mesh(tmp_path / name, mesh)
    assert not (tmp_path / name).exists()


def test_missing_folders(mesh, tmp_path):
    with pytest.raises(FileNotFoundError):
        write_mesh(tmp_path / "missing" / "mesh.npz", mesh)
