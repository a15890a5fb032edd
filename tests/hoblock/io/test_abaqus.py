import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.io.abaqus import write_abaqus


def test_meshio_reads_the_straight_sided_mesh(layouts, tmp_path):
    meshio = pytest.importorskip("meshio")
    mesh = generate(layouts.annulus(5), 4)
    write_abaqus(tmp_path / "m.inp", mesh)
    found = meshio.read(tmp_path / "m.inp")
    (block,) = found.cells
    assert block.type == "quad"
    np.testing.assert_array_equal(found.points[block.data][:, :, :2], mesh.points[mesh.corners])
