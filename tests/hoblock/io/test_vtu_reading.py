import re

import numpy as np
import pytest

from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.vtu import read_vtu, write_vtu
from hoblock.mesh import QuadMesh

TWO = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="7" NumberOfCells="3">
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">
0 0 1  1 0 1  2 0 1  0 1 1  1 1 1  2 1 1  9 9 9 </DataArray></Points>
<Cells>
<DataArray type="Int32" Name="connectivity" format="ascii">0 1 0 1 4 3 4 5 2 1</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">2 6 10</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">3 9 9</DataArray>
</Cells>
<CellData>
<DataArray type="Int32" Name="right" format="ascii">1 0 1</DataArray>
<DataArray type="Int32" Name="material" format="ascii">0 3 4</DataArray>
</CellData>
</Piece></UnstructuredGrid></VTKFile>
"""


@pytest.fixture
def path(tmp_path):
    return tmp_path / "mesh.vtu"


def assert_same(again, mesh):
    assert again.order == mesh.order
    np.testing.assert_array_equal(again.cells, mesh.cells)
    np.testing.assert_allclose(again.points, mesh.points, rtol=0, atol=1e-13 * np.abs(mesh.points).max())
    for ours, theirs in ((mesh.cell_groups, again.cell_groups), (mesh.edge_groups, again.edge_groups)):
        assert list(ours) == list(theirs)
        for name, members in ours.items():
            np.testing.assert_array_equal(theirs[name], members)


@pytest.mark.parametrize("order", range(1, 11))
def test_own_files(order, layouts, path):
    mesh = generate(layouts.annulus(4, counts=2), order)
    groups = {"odd \"<name>\" & 'é'": np.array([3, 0]), "none": np.zeros(0, dtype=np.int64)}
    edges = {**mesh.edge_groups, "none": np.zeros((0, 2), dtype=np.int64), "a:b": np.array([(5, 2), (1, 3)])}
    mesh = QuadMesh(mesh.points, mesh.cells, order, groups, edges)
    write_vtu(path, mesh)
    assert_same(read_vtu(path), mesh)


@pytest.mark.parametrize("mode", ["ascii", "binary", "appended", "raw"])
@pytest.mark.parametrize("compressor", ["none", "zlib", "lzma"])
def test_files_that_vtk_wrote(mode, compressor, layouts, path, vtk_module):
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

    mesh = generate(layouts.annulus(3, counts=40), 4)  # large enough for several blocks of 32 KiB
    write_vtu(path, mesh)
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    for width in (32, 64):
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetInputData(reader.GetOutput())
        writer.SetFileName(str(path))
        {"ascii": writer.SetDataModeToAscii, "binary": writer.SetDataModeToBinary}.get(
            mode, writer.SetDataModeToAppended
        )()
        writer.SetEncodeAppendedData(mode == "appended")
        {"none": writer.SetCompressorTypeToNone, "zlib": writer.SetCompressorTypeToZLib}.get(
            compressor, writer.SetCompressorTypeToLZMA
        )()
        (writer.SetHeaderTypeToUInt32 if width == 32 else writer.SetHeaderTypeToUInt64)()
        assert writer.Write() == 1
        assert_same(read_vtu(path), mesh)
    writer.SetCompressorTypeToLZ4()
    if mode != "ascii":
        writer.Write()
        with pytest.raises(MeshFileError, match="compressed by 'vtkLZ4DataCompressor'; write them with zlib"):
            read_vtu(path)


def test_files_by_hand(path):
    path.write_text(TWO)
    mesh = read_vtu(path)
    assert mesh.points.tolist() == [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]
    assert mesh.cells.tolist() == [[0, 1, 3, 4], [4, 1, 5, 2]]  # the second one was clockwise
    assert {name: members.tolist() for name, members in mesh.cell_groups.items()} == {"right": [1]}
    assert dict(mesh.edge_groups) == {}


def test_biquadratic_quads_of_meshio(path):
    meshio = pytest.importorskip("meshio")
    points = np.array(
        [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, -0.2, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 1, 0)]
    )
    meshio.write(path, meshio.Mesh(points, [("quad9", np.arange(9)[None])]))
    mesh = read_vtu(path)
    assert mesh.order == 2
    np.testing.assert_array_equal(mesh.points[mesh.cells[0, [0, 1, 2, 4, 8]]], points[[0, 4, 1, 8, 2], :2])


def test_clockwise_elements_keep_their_sides(layouts, path):
    mesh = generate(layouts.square(counts=2, edges={"low": [("a", "b")]}), 2)
    write_vtu(path, mesh.with_points(mesh.points * [-1, 1]))
    again = read_vtu(path)
    np.testing.assert_allclose(again.points[again.edge_nodes("low"), 1], 0)
    assert len(again.edge_nodes("low")) == 5


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        (
            "3 9 9<",
            "3 9 23<",
            r"1 quads with eight nodes, the first is cell 2; expected quads \(types 9, 28, 70\) only",
        ),
        ("3 9 9<", "3 5 9<", "1 triangles, the first is cell 1"),
        ("3 9 9<", "3 99 9<", "1 cells of type 99"),
        ("3 9 9<", "3 3 3<", "there are no quads"),
        ("2 6 10<", "2 5 10<", "quads of 3 and of 5 nodes; expected one order"),
        ("2 6 10<", "0 5 10<", r"quads have 5 nodes; expected \(p \+ 1\)²"),
        ("2 6 10<", "2 6 11<", "3 types, 3 offsets and 10 nodes do not fit together"),
        ("2 6 10<", "2 6 x<", "array 'offsets': invalid literal"),
        ("0 1 0 1 4", "0 1 0 1 44", "elements use nodes 0 to 44; there are 7"),
        ("0 1 0 1 4", "0 1 0 1 -4", "elements use nodes -4 to 5; there are 7"),
        ("2 1 1  9", "2 1 1.5  9", "z runs from 1 to 1.5; expected a plane mesh"),
        ("2 1 1  9", "2 1 inf  9", "z runs|not finite"),
        ('NumberOfComponents="3"', 'NumberOfComponents="4"', "has 21 values; expected a multiple of 4"),
        ('NumberOfComponents="3"', 'NumberOfComponents="x"', "NumberOfComponents is 'x'; expected an integer"),
        ('NumberOfComponents="3"', "", r"points have shape \(21,\); expected \(n, 3\)"),
        ('Name="types"', 'Name="kinds"', "Cells has 0 arrays 'types'; expected one"),
        ('"Int32" Name="offsets"', '"Float32" Name="offsets"', "array 'offsets' has type float32"),
        ('"Int32" Name="offsets"', '"String" Name="offsets"', "array 'offsets' has type 'String'; expected numbers"),
        ('"offsets" format="ascii"', '"offsets" format="binary"', "array 'offsets': "),
        ('"offsets" format="ascii"', '"offsets" format="hex"', "format is 'hex'; expected 'ascii'"),
        (
            '"offsets" format="ascii"',
            '"offsets" format="appended" offset="5"',
            "array 'offsets': the data end too early",
        ),
        ('type="UnstructuredGrid"', 'type="PolyData"', "the file holds 'PolyData'; expected 'UnstructuredGrid'"),
        ("<Piece ", "<Piece/><Piece ", "there are 2 pieces; expected one"),
        ("</VTKFile>", "", "this is no XML that can be read"),
        ("VTKFile", "File", "the outermost element is 'File'; expected 'VTKFile'"),
        ('<?xml version="1.0"?>', '<!DOCTYPE a [<!ENTITY b "c">]>', "there is a document type"),
        ("<Points>", '<AppendedData encoding="raw">_', "AppendedData has no end"),
    ],
)
def test_files_that_do_not_hold_a_mesh(old, new, match, path):
    assert old in TWO
    path.write_text(TWO.replace(old, new))
    with pytest.raises(MeshFileError, match=rf"mesh\.vtu: .*({match})"):
        read_vtu(path)


def test_groups_that_do_not_fit(layouts, path):
    mesh = generate(layouts.square(counts=2), 1)
    for groups, edges in (({"a": np.array([3])}, {}), ({}, {"a": np.array([(3, 3)])})):
        write_vtu(path, QuadMesh(mesh.points, mesh.cells, 1, groups, edges))
        good = path.read_bytes()
        bad = QuadMesh(mesh.points, mesh.cells, 1, {}, {})
        write_vtu(path, bad)
        field = re.search(rb"<FieldData>.*</FieldData>", good, re.DOTALL)[0]
        few = TWO.replace("<UnstructuredGrid><Piece", "<UnstructuredGrid>FIELD<Piece").replace(
            'byte_order="LittleEndian"',
            'byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor"',
        )
        path.write_bytes(few.encode().replace(b"FIELD", field))
        with pytest.raises(MeshFileError, match=r"_group:a' does not fit the 2 elements"):
            read_vtu(path)


@pytest.mark.parametrize("text", [False, True])
def test_damaged_files_raise_nothing_else(text, layouts, path, rng):
    if text:
        path.write_text(TWO)
    else:
        write_vtu(path, generate(layouts.annulus(3, counts=2), 2))
    data = path.read_bytes()
    refused = 0
    for k in range(500):
        damaged = bytearray(data[: rng.integers(len(data))] if k % 4 == 0 else data)
        for place in rng.integers(0, max(len(damaged), 1), rng.integers(1, 4)):
            damaged[place:place] = b"" if k % 2 else bytes([rng.integers(32, 127)])
            damaged[place : place + 1] = bytes([rng.integers(256)])
        path.write_bytes(damaged)
        try:
            read_vtu(path)
        except MeshFileError:
            refused += 1
    assert refused > 150
