import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.io.vtu import write_vtu
from hoblock.mesh import QuadMesh
from hoblock.quality import scaled_jacobian
from hoblock.reference import gauss_lobatto, tensor_basis

pytest.importorskip("meshio")


def read(path):
    xml = pytest.importorskip("vtkmodules.vtkIOXML")
    reader = xml.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


@pytest.mark.parametrize("order", [*range(1, 11), 13])
def test_vtk_evaluates_the_same_geometry(order, layouts, rng, tmp_path):
    reference = pytest.importorskip("vtkmodules.vtkCommonCore").reference
    mesh = generate(layouts.random("star", rng), order)
    write_vtu(tmp_path / "star.vtu", mesh)
    grid = read(tmp_path / "star.vtu")
    assert grid.GetNumberOfCells() == len(mesh.cells)
    where = rng.uniform(0, 1, (3, 2))
    expected = tensor_basis(gauss_lobatto(order), 2 * where - 1) @ mesh.coordinates
    weights = [0.0] * (order + 1) ** 2
    for element in range(len(mesh.cells)):
        cell = grid.GetCell(element)
        assert cell.GetCellType() == (9 if order == 1 else 70)
        for (r, s), place in zip(where, expected[element], strict=True):
            found = [0.0, 0.0, 0.0]
            cell.EvaluateLocation(reference(0), [r, s, 0.0], found, weights)
            assert found == pytest.approx([*place, 0.0], abs=1e-10)


def test_cell_data(layouts, rng, tmp_path):
    mesh = generate(layouts.random("disc", rng), 3)
    groups = {"core": np.array([0, 2]), "even": np.arange(0, len(mesh.cells), 2)}
    mesh = QuadMesh(mesh.points, mesh.cells, 3, groups, {})
    write_vtu(tmp_path / "disc.vtu", mesh)
    arrays = read(tmp_path / "disc.vtu").GetCellData()
    for name, members in groups.items():
        array = arrays.GetArray(name)
        assert array.GetDataTypeAsString() == "int"
        inside = [k for k in range(array.GetNumberOfTuples()) if array.GetValue(k) == 1]
        assert inside == members.tolist()
    quality = arrays.GetArray("scaled_jacobian")
    values = [quality.GetValue(k) for k in range(len(mesh.cells))]
    np.testing.assert_allclose(values, scaled_jacobian(mesh), rtol=1e-12)


def test_meshio_reads_it_back(layouts, tmp_path):
    import meshio

    mesh = generate(layouts.annulus(3), 4)
    write_vtu(tmp_path / "annulus.vtu", mesh)
    file = meshio.read(tmp_path / "annulus.vtu")
    assert [block.type for block in file.cells] == ["VTK_LAGRANGE_QUADRILATERAL"]
    assert file.cells[0].data.shape == mesh.cells.shape
