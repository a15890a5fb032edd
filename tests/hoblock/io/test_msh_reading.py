import numpy as np
import pytest

from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.msh import read_msh, write_msh
from hoblock.quality import det_jacobian
from hoblock.reference import tensor_quadrature

SQUARE = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 7 "wall"
2 9 "body"
$EndPhysicalNames
$Nodes
5
10 0 0 0
20 2 0 0
3000000 2 1 0
40 0 1 0
5 9 9 0
$EndNodes
$Elements
3
1 15 2 0 5 5
2 1 2 7 1 10 20
9 3 2 9 1 10 20 3000000 40
$EndElements
"""


@pytest.fixture
def gmsh(gmsh_module):
    gmsh_module.initialize(interruptible=False)
    gmsh_module.option.setNumber("General.Terminal", 0)
    yield gmsh_module
    gmsh_module.finalize()


@pytest.fixture
def path(tmp_path):
    return tmp_path / "mesh.msh"


def area(mesh):
    where, weights = tensor_quadrature(mesh.order + 1)
    return det_jacobian(mesh, where) @ weights


def ring(gmsh, order, clockwise):
    """A half annulus of two transfinite surfaces, one of them perhaps clockwise, with names."""
    model, geo = gmsh.model, gmsh.model.geo
    middle = geo.addPoint(0, 0, 0)
    inner = [geo.addPoint(x, y, 0) for x, y in ((1, 0), (0, 1), (-1, 0))]
    outer = [geo.addPoint(2 * x, 2 * y, 0) for x, y in ((1, 0), (0, 1), (-1, 0))]
    inside = [geo.addCircleArc(inner[k], middle, inner[k + 1]) for k in range(2)]
    outside = [geo.addCircleArc(outer[k], middle, outer[k + 1]) for k in range(2)]
    spokes = [geo.addLine(first, second) for first, second in zip(inner, outer, strict=True)]
    for k in range(2):
        loop = [spokes[k], outside[k], -spokes[k + 1], -inside[k]]
        if k == 1 and clockwise:
            loop = [-curve for curve in reversed(loop)]
        geo.addPlaneSurface([geo.addCurveLoop(loop)], k + 1)
        geo.mesh.setTransfiniteSurface(k + 1)
        geo.mesh.setRecombine(2, k + 1)
    for curve in [*inside, *outside, *spokes]:
        geo.mesh.setTransfiniteCurve(curve, 4)
    geo.synchronize()
    model.addPhysicalGroup(1, outside, 11, "outer wall")
    model.addPhysicalGroup(1, [spokes[1]], 12)
    model.addPhysicalGroup(2, [1], 21, "right")
    model.addPhysicalGroup(2, [2], 22, "left")
    model.mesh.generate(2)
    model.mesh.setOrder(order)


@pytest.mark.parametrize("order", range(1, 11))
@pytest.mark.parametrize(("version", "binary"), [(2.2, 0), (2.2, 1), (4.1, 0), (4.1, 1)])
def test_files_of_gmsh(order, version, binary, gmsh, path):
    ring(gmsh, order, clockwise=True)
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.write(str(path))
    mesh = read_msh(path)
    assert mesh.order == order
    areas = area(mesh)
    assert (areas > 0).all()
    where, weights = tensor_quadrature(order + 1)
    kind = gmsh.model.mesh.getElementType("quadrangle", order)
    _, determinants, _ = gmsh.model.mesh.getJacobians(kind, np.pad(where, ((0, 0), (0, 1))).ravel())
    theirs = np.abs(determinants.reshape(-1, len(weights)) @ weights)
    np.testing.assert_allclose(areas, theirs, rtol=1e-9)  # Gmsh's basis functions are no better
    assert {name: len(members) for name, members in mesh.cell_groups.items()} == {"right": 9, "left": 9}
    assert list(mesh.edge_groups) == ["outer wall", "12"]
    outer = mesh.points[mesh.edge_nodes("outer wall")]
    assert len(outer) == 6 * order + 1
    assert np.hypot(*outer.T) == pytest.approx(2.0, abs=1e-2 if order == 1 else 1e-3)
    np.testing.assert_allclose(mesh.points[mesh.edge_nodes("12")][:, 0], 0, atol=1e-9)


def test_an_entity_in_two_physical_groups(gmsh, path):
    ring(gmsh, 3, clockwise=False)
    gmsh.model.addPhysicalGroup(2, [1, 2], 30, "all")
    for version in (2.2, 4.1):
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.write(str(path))
        mesh = read_msh(path)
        assert len(mesh.cells) == 18
        sizes = {name: len(members) for name, members in mesh.cell_groups.items()}
        assert sizes == {"right": 9, "left": 9, "all": 18}


def test_numbers_may_be_sparse(path):
    path.write_text(SQUARE)
    mesh = read_msh(path)
    assert mesh.points.tolist() == [[0, 0], [2, 0], [0, 1], [2, 1]]
    assert mesh.cells.tolist() == [[0, 1, 2, 3]]
    assert mesh.cell_groups["body"].tolist() == [0]
    assert mesh.edge_groups["wall"].tolist() == [[0, 0]]


def test_clockwise_quads_are_turned_with_their_sides(path):
    path.write_text(SQUARE.replace("10 20 3000000 40\n", "10 40 3000000 20\n"))
    mesh = read_msh(path)
    assert area(mesh).tolist() == pytest.approx([2.0])
    ends = mesh.points[mesh.edge_nodes("wall")]
    assert ends.tolist() == [[0, 0], [2, 0]]


def test_foreign_line_ends_and_comments(path):
    text = "$Comments\nby hand\n$EndComments\n" + SQUARE
    path.write_bytes(text.replace("\n", "\r\n").encode())
    assert len(read_msh(path).cells) == 1


def test_big_endian_files(layouts, path):
    mesh = generate(layouts.square(counts=2), 2)
    write_msh(path, mesh, "2.2")
    data = path.read_bytes()
    _, rest = data.split(b"$EndMeshFormat\n")
    nodes, elements = rest.split(b"$Nodes\n")[1].split(b"$Elements\n")
    count = len(mesh.points)
    raw = nodes.split(b"\n", 1)[1][: 28 * count]
    record = np.frombuffer(raw, dtype=[("tag", "<i4"), ("x", "<f8", 3)])
    swapped = record.astype([("tag", ">i4"), ("x", ">f8", 3)]).tobytes()
    first, body = elements.split(b"\n", 1)
    integers = np.frombuffer(body[: body.rindex(b"\n$EndElements")], dtype="<i4").astype(">i4").tobytes()
    path.write_bytes(
        b"$MeshFormat\n2.2 1 8\n\0\0\0\1\n$EndMeshFormat\n$Nodes\n%d\n" % count
        + swapped
        + b"\n$EndNodes\n$Elements\n"
        + first
        + b"\n"
        + integers
        + b"\n$EndElements\n"
    )
    again = read_msh(path)
    np.testing.assert_array_equal(again.points, mesh.points)
    np.testing.assert_array_equal(again.cells, mesh.cells)


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("9 3 2 9 1 10 20 3000000 40", "9 2 2 9 1 10 20 40", r"1 triangles, the first is element 9; .*RecombineAll"),
        ("9 3 2 9 1 10 20 3000000 40", "9 4 2 9 1 10 20 5 40", r"1 elements of volumes, .* Mesh the surface only"),
        ("9 3 2 9 1 10 20 3000000 40", "9 99 2 9 1 10 20", r"\$Elements: there are elements of type 99"),
        ("9 3 2 9 1 10 20 3000000 40", "9 3 2 9 1 10 20 3000000 41", "uses node 41, which is not in the file"),
        ("9 3 2 9 1 10 20 3000000 40", "9 3 2 9 1 10 20 20 40", "1 quadrilaterals have two corners in one node"),
        ("9 3 2 9 1 10 20 3000000 40", "9 1 2 9 1 10 20", "there are no quadrangles; expected at least one"),
        ("9 3 2 9 1 10 20 3000000 40", "9 3 2 9 1 10 20 3000000", "the file ends too early"),
        ("1 15 2 0 5 5", "1 15 2000 0 5 5", "an element has 2000 tags; expected 0 to 1000"),
        ("1 15 2 0 5 5", "1 15 2.5 0 5 5", "there should be an integer"),
        ("2 1 2 7 1 10 20", "2 1 2 7 1 10 3000000", r"1 lines of 'wall' are no sides .* from \(0, 0\) to \(2, 1\)"),
        ("2 1 2 7 1 10 20", "2 1 2 7 1 10 5", "1 lines of 'wall' are no sides of quadrilaterals"),
        ("20 2 0 0", "20 2 0 0.5", "z runs from 0 to 0.5; expected a plane mesh"),
        ("20 2 0 0", "20 nan 0 0", "a coordinate that is not finite"),
        ("20 2 0 0", "20 2e200 0 0", "has the coordinate 2e\\+200; expected at most 1e\\+100"),
        ("20 2 0 0", "20 x 0 0", r"\$Nodes: there should be a number"),
        ("$Nodes\n5", "$Nodes\n6", r"\$Nodes: the section ends too early"),
        ("$Nodes\n5", "$Nodes\n999999999999", r"\$Nodes: the section ends too early"),
        ("$Nodes\n5", "$Nodes\nfive", r"\$Nodes: the number of rows is 'five'; expected a positive integer"),
        ("$EndNodes", "$End", r"\$Nodes: there is no \$EndNodes; the file ends too early"),
        (
            "2.2 0 8",
            "4 0 8",
            r"\$MeshFormat: version 4 with data of 8 bytes; expected 2\.2 or 4\.1 .*MshFileVersion = 4\.1",
        ),
        ("2.2 0 8", "2.2 2 8", r"\$MeshFormat: the line is '2\.2 2 8'; expected a version, 0 or 1, and 8"),
        ("2.2 0 8", "2.2 1 8", "the number that shows the byte order is"),
        ("$MeshFormat", "$Format", r"there is no section \$MeshFormat; expected a mesh file of Gmsh"),
        ('2 9 "body"', "2 9 body", r"\$PhysicalNames: a line is '2 9 body'"),
    ],
)
def test_files_that_do_not_hold_a_mesh(old, new, match, path):
    assert SQUARE.count(old) == 1 or old in ("$MeshFormat", "$EndNodes")
    path.write_text(SQUARE.replace(old, new))
    with pytest.raises(MeshFileError, match=rf"mesh\.msh: .*{match}"):
        read_msh(path)


def test_refusals_of_other_meshes_of_gmsh(gmsh, path):
    ring(gmsh, 2, clockwise=False)
    gmsh.write(str(path))
    assert read_msh(path).order == 2
    gmsh.model.mesh.partition(2)
    gmsh.write(str(path))
    with pytest.raises(MeshFileError, match=r"\$PartitionedEntities: the mesh is partitioned. In Gmsh: remove"):
        read_msh(path)
    gmsh.clear()
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    ring(gmsh, 2, clockwise=False)
    gmsh.write(str(path))
    with pytest.raises(
        MeshFileError, match=r"18 quadrangles without inner nodes, [^$]* Mesh\.SecondOrderIncomplete = 0"
    ):
        read_msh(path)


def test_quads_of_two_orders(path):
    text = SQUARE.replace("$Nodes\n5\n", "$Nodes\n10\n" + "".join(f"{100 + k} {k} 0 0\n" for k in range(5)))
    text = text.replace("$Elements\n3\n", "$Elements\n4\n3 10 2 0 1 10 20 3000000 40 100 101 102 103 104\n")
    path.write_text(text)
    with pytest.raises(MeshFileError, match="quadrangles of orders 1, 2; expected one order"):
        read_msh(path)


@pytest.mark.parametrize("version", ["2.2", "4.1", "text"])
def test_damaged_files_raise_nothing_else(version, layouts, path, rng):
    if version == "text":
        path.write_text(SQUARE)
    else:
        write_msh(path, generate(layouts.annulus(3, counts=2), 2), version)
    data = path.read_bytes()
    refused = 0
    cuts = [data[:end] for end in rng.integers(0, len(data), 150)]
    flips = []
    for _ in range(400):
        copy = bytearray(data)
        for place in rng.integers(0, min(len(data), 4000), rng.integers(1, 6)):
            copy[place] = rng.integers(256)
        flips.append(bytes(copy))
    for damaged in [*cuts, *flips]:
        path.write_bytes(damaged)
        try:
            read_msh(path)
        except MeshFileError:
            refused += 1
    assert refused > 150


def test_missing_files(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_msh(tmp_path / "missing.msh")
