"""Files for ParaView, read back by vtk and evaluated by its own Lagrange cells."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from hoblock import Arc, BlockStructure, QuadMesh, generate
from hoblock.errors import MissingExtraError
from hoblock.reference import gauss_lobatto, tensor_basis
from hofsi.io.vtu import require_vtk, write_vtu


def _mesh(order: int) -> QuadMesh:
    """Four elements round a quarter of a circle."""
    vertices = {
        "a": (1.0, 0.0),
        "b": (2.5, 0.0),
        "c": (2.5, 2.5),
        "d": (0.0, 2.5),
        "e": (0.0, 1.0),
        "f": (np.sqrt(0.5), np.sqrt(0.5)),
    }
    blocks = {"fluid": [("a", "b", "c", "f"), ("f", "c", "d", "e")]}
    curves = {
        ends: Arc.from_center(np.zeros(2), np.array(vertices[ends[0]]), np.array(vertices[ends[1]]))
        for ends in (("a", "f"), ("f", "e"))
    }
    return generate(BlockStructure.build(vertices, blocks, counts={("a", "b"): 2}, curves=curves), order)


def _read(path: Path) -> Any:
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def _evaluate(cell: Any, r: float, s: float) -> tuple[list[float], list[float]]:
    """A point of a cell, and the weights of its nodes there, by vtk."""
    from vtkmodules.vtkCommonCore import reference

    x, weights = [0.0] * 3, [0.0] * cell.GetNumberOfPoints()
    cell.EvaluateLocation(reference(0), [r, s, 0.0], x, weights)
    return x, weights


@pytest.mark.usefixtures("vtk_module")
@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, 6])
def test_vtk_evaluates_the_same_points_and_fields(tmp_path: Path, order: int) -> None:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    mesh = _mesh(order)
    rng = np.random.default_rng(71)
    points = mesh.points + 0.05 * np.sin(3.0 * mesh.points[:, ::-1])  # not the points of the mesh
    fields = {
        "pressure": rng.standard_normal(len(points)),
        "velocity": rng.standard_normal((len(points), 2)),
        "stress": rng.standard_normal((len(points), 6)),
    }
    write_vtu(tmp_path / "a.vtu", mesh, points, fields)
    grid = _read(tmp_path / "a.vtu")
    assert grid.GetNumberOfCells() == len(mesh.cells) == 4
    data = grid.GetPointData()
    assert {data.GetArrayName(k) for k in range(data.GetNumberOfArrays())} == set(fields)
    assert [data.GetArray(name).GetNumberOfComponents() for name in ("pressure", "velocity", "stress")] == [1, 3, 6]
    for element, nodes in enumerate(mesh.cells):
        cell = grid.GetCell(element)
        assert cell.GetCellType() == 70
        ids = [cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]
        for r, s in rng.uniform(0.0, 1.0, (5, 2)):
            x, weights = _evaluate(cell, r, s)
            N = tensor_basis(gauss_lobatto(order), np.array([[2 * r - 1, 2 * s - 1]]))[0]
            np.testing.assert_allclose(x, [*(N @ points[nodes]), 0.0], rtol=0, atol=1e-12)
            for name, values in fields.items():
                found = np.array(weights) @ vtk_to_numpy(data.GetArray(name))[ids]
                expected = N @ values[nodes]
                padded = np.append(expected, 0.0) if name == "velocity" else expected
                np.testing.assert_allclose(found, padded, rtol=0, atol=1e-12)


@pytest.mark.usefixtures("vtk_module")
@pytest.mark.parametrize(("order", "error"), [(1, 0.08), (2, 2e-3), (4, 2e-6), (6, 3e-9)])
def test_curved_sides_are_curved_for_vtk(tmp_path: Path, order: int, error: float) -> None:
    mesh = _mesh(order)
    write_vtu(tmp_path / "a.vtu", mesh, mesh.points, {})
    grid = _read(tmp_path / "a.vtu")
    radii = [
        float(np.hypot(*_evaluate(grid.GetCell(element), *place)[0][:2]))
        for element in range(4)
        for t in np.linspace(0.0, 1.0, 21)
        for place in ((t, 0.0), (t, 1.0), (0.0, t), (1.0, t))
    ]
    assert sum(abs(radius - 1.0) < error for radius in radii) >= 2 * 21  # two sides lie on the circle
    assert min(radii) > 1.0 - error


@pytest.mark.usefixtures("vtk_module")
def test_the_file_is_compressed_binary(tmp_path: Path) -> None:
    mesh = _mesh(6)
    write_vtu(tmp_path / "a.vtu", mesh, mesh.points, {"zero": np.zeros(len(mesh.points))})
    content = (tmp_path / "a.vtu").read_bytes()
    assert b'compressor="vtkZLibDataCompressor"' in content
    assert b'<AppendedData encoding="raw">' in content
    assert [path.name for path in tmp_path.iterdir()] == ["a.vtu"]


@pytest.mark.usefixtures("vtk_module")
def test_a_field_of_another_mesh_is_refused(tmp_path: Path) -> None:
    mesh = _mesh(2)
    with pytest.raises(ValueError, match=r"field 'pressure' has 7 rows; expected one for each of the 25 nodes"):
        write_vtu(tmp_path / "a.vtu", mesh, mesh.points, {"pressure": np.zeros(7)})


@pytest.mark.usefixtures("vtk_module")
def test_a_missing_directory_is_an_error(tmp_path: Path) -> None:
    mesh = _mesh(2)
    with pytest.raises(OSError, match=r"a.vtu: could not be written"):
        write_vtu(tmp_path / "nowhere" / "a.vtu", mesh, mesh.points, {})


def test_the_error_without_vtk_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    missing: dict[str, ModuleType | None] = {"vtkmodules": None, "vtkmodules.vtkCommonCore": None}
    for name, module in missing.items():
        monkeypatch.setitem(sys.modules, name, module)  # type: ignore[arg-type]
    with pytest.raises(MissingExtraError, match=r"pip install 'hofsi-coupler\[vtk\]'"):
        require_vtk()
