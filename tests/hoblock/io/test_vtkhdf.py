import sys

import numpy as np
import pytest

from hoblock.errors import MeshFileError, MissingExtraError
from hoblock.generate import generate
from hoblock.io.equispaced import equispaced_points
from hoblock.io.vtkhdf import VtkhdfSeries


@pytest.fixture
def h5py():
    return pytest.importorskip("h5py")


@pytest.mark.parametrize("order", [1, 2, 4, 10])
def test_vtk_reads_every_step(order, h5py, layouts, tmp_path, vtk_module):
    hdf = pytest.importorskip("vtkmodules.vtkIOHDF")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    mesh = generate(layouts.annulus(3, counts=2), order)
    path = tmp_path / "ring.vtkhdf"
    series = VtkhdfSeries(path)
    times = [0.25, 1.0, 1.5]
    moved = [mesh.with_points(mesh.points * (1 + k)) for k in range(3)]
    for count, (time, step) in enumerate(zip(times, moved, strict=True), start=1):
        series.write(time, step, point_data={"u/v": step.points}, cell_data={"k": np.full(len(mesh.cells), count)})
        reader = hdf.vtkHDFReader()
        reader.SetFileName(str(path))
        reader.UpdateInformation()
        keys = pytest.importorskip("vtkmodules.vtkCommonExecutionModel").vtkStreamingDemandDrivenPipeline
        found = reader.GetOutputInformation(0)
        if count > 1:  # VTK takes a file of one step as one without times
            assert [found.Get(keys.TIME_STEPS(), k) for k in range(reader.GetNumberOfSteps())] == times[:count]
        assert reader.GetNumberOfSteps() == count
        for k in range(count):
            reader.UpdateTimeStep(times[k])
            grid = reader.GetOutputDataObject(0)
            places = vtk_to_numpy(grid.GetPoints().GetData())
            np.testing.assert_array_equal(places[:, :2], equispaced_points(moved[k]))
            assert grid.GetNumberOfCells() == len(mesh.cells)
            assert grid.GetCell(0).GetCellType() == (9 if order == 1 else 70)
            np.testing.assert_array_equal(vtk_to_numpy(grid.GetPointData().GetArray("u∕v")), places)
            assert set(vtk_to_numpy(grid.GetCellData().GetArray("k")).tolist()) == {k + 1}
            inner = vtk_to_numpy(grid.GetFieldData().GetArray("edge_group:inner"))
            np.testing.assert_array_equal(inner, mesh.edge_groups["inner"])
    assert series.times == tuple(times)


def test_cells_are_stored_once(h5py, layouts, tmp_path):
    mesh = generate(layouts.square(counts=3), 3)
    series = VtkhdfSeries(tmp_path / "s.vtkhdf")
    for time in range(5):
        series.write(time, mesh)
    with h5py.File(tmp_path / "s.vtkhdf") as file:
        root = file["VTKHDF"]
        assert root["Connectivity"].shape == (mesh.cells.size,)
        assert root["Points"].shape == (5 * len(mesh.points), 3)
        assert root["Steps/PointOffsets"][:].tolist() == [k * len(mesh.points) for k in range(5)]
        assert root["Steps"].attrs["NSteps"] == 5


def test_steps_that_do_not_fit(h5py, layouts, tmp_path):
    mesh = generate(layouts.square(counts=2), 2)
    series = VtkhdfSeries(tmp_path / "s.vtkhdf")
    series.write(0.0, mesh, point_data={"u": mesh.points})
    with pytest.raises(MeshFileError, match=r"the mesh has other cells .* Write a series of \.vtu files"):
        series.write(1.0, generate(layouts.square(counts=3), 2), point_data={"u": np.zeros((49, 2))})
    with pytest.raises(
        MeshFileError, match=r"data are scaled_jacobian \(4,\), body \(4,\); expected those of the first"
    ):
        series.write(1.0, mesh)
    with pytest.raises(ValueError, match=r"time is 0\.0; expected a finite number above 0\.0"):
        series.write(0.0, mesh)
    series.write(1.0, mesh, point_data={"u": mesh.points})
    assert series.times == (0.0, 1.0)


def test_a_failed_step_does_no_harm(h5py, layouts, tmp_path, monkeypatch):
    mesh = generate(layouts.square(counts=2), 2)
    path = tmp_path / "s.vtkhdf"
    series = VtkhdfSeries(path)

    def fail(*_):
        raise OSError("the disk is full")

    with monkeypatch.context() as patch:
        patch.setattr("hoblock.io.vtkhdf._set", fail)
        with pytest.raises(OSError, match="the disk is full"):
            series.write(0.0, mesh)
        assert not list(tmp_path.iterdir())
    series.write(0.0, mesh)
    with monkeypatch.context() as patch:
        patch.setattr("hoblock.io.vtkhdf._set", fail)
        with pytest.raises(OSError, match="the disk is full"):
            series.write(1.0, mesh)
    series.write(1.0, mesh.with_points(mesh.points + 1))
    with h5py.File(path) as file:
        steps, points = file["VTKHDF/Steps"], file["VTKHDF/Points"]
        assert steps.attrs["NSteps"] == 2
        assert steps["Values"][:].tolist() == [0, 1]
        first, second = steps["PointOffsets"][:]
        np.testing.assert_array_equal(points[first : first + 25, :2], mesh.points)
        np.testing.assert_array_equal(points[second : second + 25, :2], mesh.points + 1)


def test_without_h5py(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'hoblock\[hdf\]'"):
        VtkhdfSeries(tmp_path / "s.vtkhdf")
