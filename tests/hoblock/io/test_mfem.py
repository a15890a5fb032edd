import numpy as np
import pytest

from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.mfem import read_mfem, write_mfem
from hoblock.mesh import QuadMesh
from hoblock.node_order import line_node_order, node_order
from hoblock.quality import det_jacobian
from hoblock.reference import (
    gauss_legendre,
    gauss_lobatto,
    lagrange_derivative,
    tensor_basis,
    tensor_gradient,
    tensor_quadrature,
)

STRAIGHT = """MFEM mesh v1.0
# by hand
dimension
2

elements
2
1 3 0 1 4 3
7 3 5 4 1 2

boundary
3
1 1 0 1
2 1 2 1
2 1 2 5

vertices
6
2
0 0
1 0
2 0
0 1
1 1
2 1
"""


@pytest.fixture
def path(tmp_path):
    return tmp_path / "m.mesh"


@pytest.fixture
def mfem():
    return pytest.importorskip("mfem.ser")


def sides(members):
    return set(map(tuple, members.tolist()))


def assert_same(again, mesh, atol=0.0):
    assert again.order == mesh.order
    np.testing.assert_allclose(again.coordinates, mesh.coordinates, rtol=0, atol=atol)
    assert len(again.points) == len(mesh.points)
    assert list(again.cell_groups) == list(mesh.cell_groups)
    assert list(again.edge_groups) == list(mesh.edge_groups)
    for name, members in mesh.cell_groups.items():
        assert again.cell_groups[name].tolist() == sorted(members.tolist())
    for name, members in mesh.edge_groups.items():
        assert sides(again.edge_groups[name]) == sides(members)


def ring(layouts, order):
    mesh = generate(layouts.annulus(4, counts=2), order)
    groups = {"all of it": np.arange(16), 'a "b" \\': np.array([0, 5]), "none": np.zeros(0, dtype=np.int64)}
    edges = {
        **mesh.edge_groups,
        "some inner": mesh.edge_groups["inner"][::2],
        "between": np.array([(0, 1), (1, 2)]),
        "none": np.zeros((0, 2), dtype=np.int64),
    }
    return QuadMesh(mesh.points, mesh.cells, order, groups, edges)


@pytest.mark.parametrize("order", range(1, 11))
def test_own_files_come_back_to_the_last_bit(order, layouts, path):
    mesh = ring(layouts, order)
    write_mfem(path, mesh)
    assert_same(read_mfem(path), mesh)


def test_without_groups(layouts, path):
    mesh = generate(layouts.square(counts=2), 3)
    mesh = QuadMesh(mesh.points, mesh.cells, 3, {}, {})
    write_mfem(path, mesh, "1.3")
    assert_same(read_mfem(path), mesh)
    write_mfem(path, mesh)
    assert path.read_text().startswith("MFEM mesh v1.0\n")
    again = read_mfem(path)
    assert (list(again.cell_groups), list(again.edge_groups)) == (["1"], ["1"])
    assert len(again.edge_groups["1"]) == 8


def test_version_10_has_names_in_comments(layouts, path):
    write_mfem(path, ring(layouts, 2), "1.0")
    text = path.read_text()
    assert "# element attributes of all of it: 1 4\n" in text
    assert "# boundary attributes of inner: 1 6\n" in text
    assert "attribute_sets" not in text
    assert len(read_mfem(path).cells) == 16


def evaluated(text):
    """Order, corner cycle and points of the elements, straight from the words of the file."""
    words = text.split("nodes\n")[1].split()
    assert words[0] == "FiniteElementSpace"
    assert words[1:3] == ["FiniteElementCollection:", words[2]]
    assert words[2].startswith("L2_T1_2D_P")
    assert words[3:7] == ["VDim:", "2", "Ordering:", "1"]
    order = int(words[2].removeprefix("L2_T1_2D_P"))
    values = np.array([float(word) for word in words[7:] if word != "mfem_mesh_end"])
    return order, values.reshape(-1, (order + 1) ** 2, 2)


@pytest.mark.parametrize("order", range(1, 11))
def test_the_format_by_its_description(order, layouts, path):
    mesh = ring(layouts, order)
    write_mfem(path, mesh)
    found, points = evaluated(path.read_text())
    assert found == order
    where, weights = tensor_quadrature(order + 1)
    dX = np.einsum("dqi,eix->eqdx", np.moveaxis(tensor_gradient(gauss_lobatto(order), where), -1, 0), points)
    area = float((np.linalg.det(dX) @ weights).sum())
    assert area == pytest.approx(float((det_jacobian(mesh, where) @ weights).sum()), rel=1e-14)


@pytest.mark.parametrize("order", range(1, 11))
def test_mfem_integrates_the_same_area_and_lengths(order, mfem, layouts, path):
    mesh = ring(layouts, order)
    write_mfem(path, mesh)
    theirs = mfem.Mesh(str(path))
    assert theirs.GetNE() == 16
    assert theirs.CheckElementOrientation(False) == 0
    assert theirs.CheckBdrElementOrientation(False) == 0
    assert set(theirs.attribute_sets.GetAttributeSetNames()) == set(mesh.cell_groups)
    assert set(theirs.bdr_attribute_sets.GetAttributeSetNames()) == set(mesh.edge_groups)

    def measure(transformations, geometry):
        rule = mfem.IntRules.Get(geometry, 100 if geometry == mfem.Geometry.SEGMENT else 2 * order + 1)
        total = 0.0
        for transformation in transformations:
            for k in range(rule.GetNPoints()):
                point = rule.IntPoint(k)
                transformation.SetIntPoint(point)
                total += point.weight * transformation.Weight()
        return total

    area = measure((theirs.GetElementTransformation(k) for k in range(16)), mfem.Geometry.SQUARE)
    where, weights = tensor_quadrature(order + 1)
    assert area == pytest.approx(float((det_jacobian(mesh, where) @ weights).sum()), rel=1e-12)
    x, w = gauss_legendre(60)
    basis = lagrange_derivative(gauss_lobatto(order), x)
    for name in mesh.edge_groups:
        attributes = set(theirs.bdr_attribute_sets.GetAttributeSet(name).ToList())
        members = [k for k in range(theirs.GetNBE()) if theirs.GetBdrAttribute(k) in attributes]
        assert len(members) == len(mesh.edge_groups[name])
        length = measure((theirs.GetBdrElementTransformation(k) for k in members), mfem.Geometry.SEGMENT)
        k, n = np.arange(order + 1), order + 1
        local = np.stack([k, order + n * k, order * n + k, n * k])
        expected = sum(
            float(np.hypot(*(basis @ mesh.coordinates[element, local[side]]).T) @ w)
            for element, side in mesh.edge_groups[name]
        )
        assert length == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("order", [1, 2, 3, 6])
@pytest.mark.parametrize("discontinuous", [False, True])
@pytest.mark.parametrize("ordering", [0, 1])
def test_files_that_mfem_wrote(order, discontinuous, ordering, mfem, layouts, rng, path):
    mesh = generate(layouts.random("star", rng), order)
    write_mfem(path, mesh)
    theirs = mfem.Mesh(str(path))
    theirs.SetCurvature(order, discontinuous, 2, ordering)
    theirs.Print(str(path))
    assert ("L2_T1" if discontinuous else "H1") in path.read_text()
    assert_same(read_mfem(path), mesh, atol=1e-13)


@pytest.mark.parametrize("order", [1, 2, 3, 7, 10])
def test_node_order_of_mfem(order, mfem):
    lattice = np.stack(np.meshgrid(*[(gauss_lobatto(order) + 1) / 2] * 2), axis=-1).reshape(-1, 2)
    collection = mfem.H1_FECollection(order, 2)
    rule = collection.FiniteElementForGeometry(mfem.Geometry.SQUARE).GetNodes()
    theirs = [(rule.IntPoint(k).x, rule.IntPoint(k).y) for k in range(rule.GetNPoints())]
    np.testing.assert_allclose(lattice[node_order(order, "mfem")], theirs, atol=1e-14)
    rule = collection.FiniteElementForGeometry(mfem.Geometry.SEGMENT).GetNodes()
    theirs = [rule.IntPoint(k).x for k in range(rule.GetNPoints())]
    np.testing.assert_allclose((gauss_lobatto(order)[line_node_order(order, "mfem")] + 1) / 2, theirs, atol=1e-14)


def test_straight_meshes(path):
    path.write_text(STRAIGHT)
    mesh = read_mfem(path)
    where, weights = tensor_quadrature(2)
    np.testing.assert_allclose(det_jacobian(mesh, where) @ weights, [1, 1])
    assert {name: members.tolist() for name, members in mesh.cell_groups.items()} == {"1": [0], "7": [1]}
    assert {name: len(members) for name, members in mesh.edge_groups.items()} == {"1": 1, "2": 2}


def test_discontinuous_nodes_at_gauss_points(layouts, path):
    mesh = generate(layouts.annulus(3), 4)
    write_mfem(path, mesh)
    gauss = gauss_legendre(5)[0]
    where = np.stack(np.meshgrid(gauss, gauss), axis=-1).reshape(-1, 2)
    points = tensor_basis(gauss_lobatto(4), where) @ mesh.coordinates
    head, _ = path.read_text().split("Ordering: 1\n")
    rows = "".join(f"{x!r} {y!r}\n" for x, y in points.reshape(-1, 2).tolist())
    path.write_text(head.replace("L2_T1_2D", "L2_2D") + "Ordering: 1\n" + rows + "mfem_mesh_end\n")
    assert_same(read_mfem(path), mesh, atol=1e-13)


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("MFEM mesh v1.0", "MFEM NC mesh v1.0", "the first line is 'MFEM NC mesh v1.0'; expected 'MFEM mesh v1.0' to"),
        ("MFEM mesh v1.0", "ISM-V2", "the first line is 'ISM-V2'"),
        ("dimension\n2", "dimension\n3", "the dimension is 3; expected 2"),
        ("dimension\n2", "dimension\nx", "the number of dimensions is 'x'"),
        ("7 3 5 4 1 2", "7 2 5 4 1", "there are 1 triangles in the section elements, the first in row 1"),
        ("7 3 5 4 1 2", "7 3 5 4 1", "there are a line of elements in row 1"),
        ("7 3 5 4 1 2", "7 3 5 4 1 6", "an element uses vertex 6; there are 6"),
        ("7 3 5 4 1 2", "7 3 5 4 1 -1", "out of range"),
        ("7 3 5 4 1 2", "7 3 5 4 1 1", "1 quadrilaterals have two corners in one node"),
        ("2 1 2 5", "2 1 2 3", "1 lines of '2' are no sides of quadrilaterals"),
        ("2 1 2 5", "2 1 2 9", "1 lines of '2' are no sides|use nodes that are not in the file"),
        ("boundary\n3", "boundary\n999", "the file ends too early"),
        ("2 0\n", "", "cannot reshape array"),
        ("2 0\n", "x 0\n", "cannot reshape|there is a section"),
        ("2 0\n", "2 nan0\n", "could not convert string to float"),
        ("vertices\n", "vertex_parents\n", "there is a section 'vertex_parents'; expected a conforming mesh"),
        ("elements\n2\n1 3 0 1 4 3\n7 3 5 4 1 2", "elements\n0", "there are no elements"),
    ],
)
def test_files_that_do_not_hold_a_mesh(old, new, match, path):
    assert old in STRAIGHT
    path.write_text(STRAIGHT.replace(old, new))
    with pytest.raises(MeshFileError, match=rf"m\.mesh: .*({match})"):
        read_mfem(path)


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("L2_T1_2D_P2", "NURBS2", r"nodes are 'NURBS2'; expected H1_2D_P<p>, .*SetCurvature\(order, true\)"),
        ("L2_T1_2D_P2", "L2_T1_2D_P0", "nodes are 'L2_T1_2D_P0'"),
        ("L2_T1_2D_P2", "L2_T1_2D_P3", "there are 36 nodes; expected 64 for 4 elements"),
        ("L2_T1_2D_P2", "H1_2D_P2", "there are 36 nodes; expected 25 for 4 elements"),
        ("VDim: 2", "VDim: 1", "nodes have VDim '1' and Ordering '1'; expected 2 and 0 or 1"),
        ("Ordering: 1\n", "Ordering: 1\n7\n", "nodes have 73 values; expected a multiple of 2"),
    ],
)
def test_nodes_that_do_not_fit(old, new, match, layouts, path):
    write_mfem(path, generate(layouts.square(counts=2), 2))
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(MeshFileError, match=match):
        read_mfem(path)


def test_damaged_files_raise_nothing_else(layouts, path, rng):
    write_mfem(path, generate(layouts.annulus(3), 2))
    data = path.read_bytes()
    refused = 0
    for k in range(400):
        damaged = bytearray(data[: rng.integers(len(data))] if k % 4 == 0 else data)
        for place in rng.integers(0, max(len(damaged), 1), rng.integers(1, 4)):
            damaged[place : place + 1] = bytes([rng.integers(32, 127)])
        path.write_bytes(damaged)
        try:
            read_mfem(path)
        except MeshFileError:
            refused += 1
    assert refused > 100


def test_what_cannot_be_written(layouts, path):
    mesh = generate(layouts.square(), 1)
    with pytest.raises(MeshFileError, match=r"the name 'a\\nb' cannot be written"):
        write_mfem(path, QuadMesh(mesh.points, mesh.cells, 1, {"a\nb": np.array([0])}, {}))
    with pytest.raises(ValueError, match=r"version is '1\.1'; expected '1\.0' or '1\.3'"):
        write_mfem(path, mesh, "1.1")
    assert not path.exists()
