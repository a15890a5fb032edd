import numpy as np
import pytest

from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.vtu import write_vtu
from hoblock.mesh import QuadMesh
from hoblock.quality import det_jacobian, scaled_jacobian
from hoblock.reference import (
    equispaced,
    gauss_legendre,
    gauss_lobatto,
    lagrange_derivative,
    tensor_basis,
    tensor_gradient,
    tensor_quadrature,
)


def read(path):
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


@pytest.mark.parametrize("order", [*range(1, 11), 13])
def test_vtk_evaluates_the_same_geometry(order, layouts, rng, tmp_path, vtk_module):
    from vtkmodules.vtkCommonCore import reference

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


def test_cell_data(layouts, rng, tmp_path, vtk_module):
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


def test_meshio_reads_it(layouts, tmp_path):
    meshio = pytest.importorskip("meshio")
    mesh = generate(layouts.annulus(3), 4)
    write_vtu(tmp_path / "annulus.vtu", mesh)
    file = meshio.read(tmp_path / "annulus.vtu")
    assert [block.type for block in file.cells] == ["VTK_LAGRANGE_QUADRILATERAL"]
    assert file.cells[0].data.shape == mesh.cells.shape


def arrays_of(data):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}


@pytest.mark.parametrize("order", range(1, 11))
def test_area_and_lengths_from_what_vtk_reads(order, layouts, tmp_path, vtk_module):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkHigherOrderQuadrilateral

    mesh = generate(layouts.annulus(4, counts=2), order)
    write_vtu(tmp_path / "m.vtu", mesh)
    grid = read(tmp_path / "m.vtu")
    places = vtk_to_numpy(grid.GetPoints().GetData())[:, :2]
    nodes = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(len(mesh.cells), -1)
    index = vtkHigherOrderQuadrilateral.PointIndexFromIJK
    local = np.array([[index(i, j, [order, order]) for i in range(order + 1)] for j in range(order + 1)])
    points = places[nodes[:, local.ravel()]]
    where, weights = tensor_quadrature(order + 1)
    dX = np.einsum("dqi,eix->eqdx", np.moveaxis(tensor_gradient(equispaced(order), where), -1, 0), points)
    area = float((np.linalg.det(dX) @ weights).sum())
    assert area == pytest.approx(float((det_jacobian(mesh, where) @ weights).sum()), rel=1e-12)
    x, w = gauss_legendre(60)
    sides = [local[0], local[:, -1], local[-1], local[:, 0]]
    inverse = np.argsort(local.ravel())
    for name, radius in (("inner", 1.0), ("outer", 2.0)):
        members = arrays_of(grid.GetFieldData())[f"edge_group:{name}"]
        lengths = {}
        for kind, coordinates in (("theirs", points), ("ours", mesh.coordinates)):
            basis = lagrange_derivative(equispaced(order) if kind == "theirs" else gauss_lobatto(order), x)
            lengths[kind] = sum(
                float(np.hypot(*(basis @ coordinates[element, inverse[sides[side]]]).T) @ w)
                for element, side in members
            )
        assert lengths["theirs"] == pytest.approx(lengths["ours"], rel=1e-12)
        assert lengths["theirs"] == pytest.approx(2 * np.pi * radius, rel=0.03)


@pytest.mark.parametrize("order", [1, 2, 5])
def test_fields_are_the_same_functions(order, layouts, rng, tmp_path, vtk_module):
    from vtkmodules.vtkCommonCore import reference

    mesh = generate(layouts.random("disc", rng), order)
    fields = {"u": rng.normal(size=(len(mesh.points), 2)), "p": rng.normal(size=len(mesh.points))}
    marks = {"rank": np.arange(len(mesh.cells)), "flag": np.arange(len(mesh.cells)) % 2 == 0}
    write_vtu(tmp_path / "m.vtu", mesh, point_data=fields, cell_data=marks)
    grid = read(tmp_path / "m.vtu")
    values, cells = arrays_of(grid.GetPointData()), arrays_of(grid.GetCellData())
    assert values["u"].shape == (len(mesh.points), 3)
    assert set(cells) == {"scaled_jacobian", "rank", "flag", *mesh.cell_groups}
    np.testing.assert_array_equal(cells["rank"], marks["rank"])
    np.testing.assert_array_equal(cells["flag"], marks["flag"])
    where = rng.uniform(0, 1, (4, 2))
    basis = tensor_basis(gauss_lobatto(order), 2 * where - 1)
    for element in range(len(mesh.cells)):
        cell, weights = grid.GetCell(element), [0.0] * (order + 1) ** 2
        nodes = [cell.GetPointId(k) for k in range(len(weights))]
        for k, (r, s) in enumerate(where):
            cell.EvaluateLocation(reference(0), [r, s, 0.0], [0.0] * 3, weights)
            for name, field in fields.items():
                expected = basis[k] @ field[mesh.cells[element]]
                np.testing.assert_allclose(np.atleast_1d(weights @ values[name][nodes])[:2], expected, atol=1e-9)


def test_data_that_do_not_fit(layouts, tmp_path):
    mesh = generate(layouts.square(counts=2), 2)
    path = tmp_path / "m.vtu"
    with pytest.raises(
        ValueError, match=r"point_data\['u'\] has shape \(24,\); expected one row for each node: \(25,\)"
    ):
        write_vtu(path, mesh, point_data={"u": np.zeros(24)})
    with pytest.raises(ValueError, match=r"cell_data\['k'\] has shape \(\); expected one row for each element: \(4,\)"):
        write_vtu(path, mesh, cell_data={"k": 1.0})
    with pytest.raises(ValueError, match=r"cell_data\['k'\] has type complex128; expected real numbers"):
        write_vtu(path, mesh, cell_data={"k": np.zeros(4, dtype=complex)})
    with pytest.raises(MeshFileError, match="the group 'body' has the name of an array of cell data"):
        write_vtu(path, mesh, cell_data={"body": np.zeros(4)})
    with pytest.raises(MeshFileError, match=r"the name 'a\\x00' cannot be written"):
        write_vtu(path, mesh, point_data={"a\0": mesh.points})
    write_vtu(path, mesh, cell_data={"scaled_jacobian": np.zeros(4)})
    assert len(list(tmp_path.iterdir())) == 1
