import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.msh import read_msh, write_msh
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.quality import det_jacobian, scaled_jacobian
from hoblock.reference import (
    equispaced,
    gauss_lobatto,
    lagrange_derivative,
    tensor_basis,
    tensor_gradient,
    tensor_quadrature,
)

VERSIONS = ["2.2", "4.1"]


def channel(layouts, order):
    vertices, quads = layouts.quads("grid")
    structure = BlockStructure.build(
        vertices,
        {"fluid": quads[:4], "the solid": quads[4:]},
        counts=2,
        edges={"bottom": [(0, 1), (1, 2), (2, 3)], "left": [(0, 4), (4, 8)], "walls": [(0, 1), (8, 9)]},
        curves={(1, 2): layouts.bump((1, 0), (2, 0), 0.15), (5, 6): layouts.bump((1, 1), (2, 1), -0.1)},
    )
    return generate(structure, order)


@pytest.fixture
def gmsh(gmsh_module):
    gmsh_module.initialize(interruptible=False)
    gmsh_module.option.setNumber("General.Terminal", 0)
    yield gmsh_module
    gmsh_module.finalize()


def sides(members):
    return set(map(tuple, members.tolist()))


def assert_same(again, mesh, atol=1e-13):
    assert again.order == mesh.order
    np.testing.assert_allclose(again.coordinates, mesh.coordinates, rtol=0, atol=atol * np.abs(mesh.points).max())
    np.testing.assert_array_equal(again.cells, mesh.cells)
    assert list(again.cell_groups) == list(mesh.cell_groups)
    assert list(again.edge_groups) == list(mesh.edge_groups)
    for name, members in mesh.cell_groups.items():
        assert again.cell_groups[name].tolist() == sorted(members.tolist())
    for name, members in mesh.edge_groups.items():
        assert sides(again.edge_groups[name]) == sides(members)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("order", range(1, 11))
def test_gmsh_reads_the_same_geometry_and_names(order, version, gmsh, layouts, rng, tmp_path):
    mesh = channel(layouts, order)
    path = tmp_path / "channel.msh"
    write_msh(path, mesh, version)
    assert path.read_bytes().startswith(f"$MeshFormat\n{version} 1 8\n".encode())
    gmsh.open(str(path))
    kind = gmsh.model.mesh.getElementType("quadrangle", order)
    tags, _ = gmsh.model.mesh.getElementsByType(kind)
    assert len(tags) == len(mesh.cells)
    # Entities are sorted by group, so elements are matched by their centres.
    where = np.concatenate([np.zeros((1, 2)), rng.uniform(-1, 1, (4, 2))])
    flat = np.pad(where, ((0, 0), (0, 1))).ravel()
    _, determinants, places = gmsh.model.mesh.getJacobians(kind, flat)
    places = places.reshape(len(tags), len(where), 3)
    expected = tensor_basis(gauss_lobatto(order), where) @ mesh.coordinates
    match = np.argmin(np.abs(places[:, None, 0, :2] - expected[None, :, 0]).sum(axis=2), axis=1)
    assert np.array_equal(np.sort(match), np.arange(len(mesh.cells)))
    np.testing.assert_allclose(places[..., :2], expected[match], atol=1e-11)
    np.testing.assert_array_equal(places[..., 2], 0)
    np.testing.assert_allclose(determinants.reshape(len(tags), -1), det_jacobian(mesh, where)[match], rtol=1e-8)
    sizes = {
        (dimension, gmsh.model.getPhysicalName(dimension, tag)): sum(
            len(gmsh.model.mesh.getElements(dimension, entity)[1][0])
            for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
        )
        for dimension, tag in gmsh.model.getPhysicalGroups()
    }
    assert sizes == {(1, "bottom"): 6, (1, "left"): 4, (1, "walls"): 4, (2, "fluid"): 16, (2, "the solid"): 8}


def length(mesh, name):
    """Length of a group of sides by a rule of 60 points."""
    x, w = np.polynomial.legendre.leggauss(60)
    slope = lagrange_derivative(gauss_lobatto(mesh.order), x)
    k, n = np.arange(mesh.order + 1), mesh.order + 1
    local = np.stack([k, mesh.order + n * k, mesh.order * n + k, n * k])
    members = mesh.edge_groups[name]
    tangents = slope @ mesh.points[mesh.cells[members[:, :1], local[members[:, 1]]]]
    return float((np.hypot(*np.moveaxis(tangents, -1, 0)) @ w).sum())


def area_from_nodes(gmsh, kind, order):
    """Area from the coordinates and the local node positions that Gmsh reports, with an accurate basis."""
    tags, places, _ = gmsh.model.mesh.getNodes()
    position = np.zeros((int(tags.max()) + 1, 2))
    position[tags] = places.reshape(-1, 3)[:, :2]
    _, nodes = gmsh.model.mesh.getElementsByType(kind)
    count = (order + 1) ** 2
    reference = gmsh.model.mesh.getElementProperties(kind)[4].reshape(count, 2)
    lexicographic = np.lexsort(np.round(reference, 6).T)
    points = position[nodes.reshape(-1, count)[:, lexicographic]]
    where, weights = tensor_quadrature(order + 1)
    dX = np.einsum("dqi,eix->eqdx", np.moveaxis(tensor_gradient(equispaced(order), where), -1, 0), points)
    return float((np.linalg.det(dX) @ weights).sum())


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("order", range(1, 11))
def test_gmsh_integrates_the_same_area_and_lengths(order, version, gmsh, layouts, tmp_path):
    mesh = channel(layouts, order)
    write_msh(tmp_path / "channel.msh", mesh, version)
    gmsh.open(str(tmp_path / "channel.msh"))
    where, weights = tensor_quadrature(order + 1)
    expected = float((det_jacobian(mesh, where) @ weights).sum())
    kind = gmsh.model.mesh.getElementType("quadrangle", order)
    _, determinants, _ = gmsh.model.mesh.getJacobians(kind, np.pad(where, ((0, 0), (0, 1))).ravel())
    area = float((determinants.reshape(-1, len(weights)) @ weights).sum())
    exact = 1e-12 if order <= 7 else 1e-9  # Gmsh's own basis functions are no better
    assert area == pytest.approx(expected, rel=exact)
    assert area_from_nodes(gmsh, kind, order) == pytest.approx(expected, rel=1e-12)
    x, w = np.polynomial.legendre.leggauss(60)
    kind = gmsh.model.mesh.getElementType("line", order)
    for dimension, tag in gmsh.model.getPhysicalGroups(1):
        total = 0.0
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag):
            _, determinants, _ = gmsh.model.mesh.getJacobians(
                kind, np.pad(x[:, None], ((0, 0), (0, 2))).ravel(), entity
            )
            total += float((determinants.reshape(-1, len(w)) @ w).sum())
        assert total == pytest.approx(length(mesh, gmsh.model.getPhysicalName(1, tag)), rel=exact)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("order", range(1, 9))
def test_gmsh_agrees_on_the_quality(order, version, gmsh, layouts, rng, tmp_path):
    mesh = generate(layouts.random("star", rng, graded=False), order)
    write_msh(tmp_path / "star.msh", mesh, version)
    gmsh.open(str(tmp_path / "star.msh"))
    tags, _ = gmsh.model.mesh.getElementsByType(gmsh.model.mesh.getElementType("quadrangle", order))
    tags = np.sort(tags)
    ours = scaled_jacobian(mesh)
    # What Gmsh calls minSIGE is our scaled Jacobian; for curved elements both take it at points, and not the same ones.
    np.testing.assert_allclose(
        gmsh.model.mesh.getElementQualities(tags, "minSIGE"), ours, rtol=1e-10 if order == 1 else 5e-3
    )
    assert np.ptp(ours) > 0.05
    if order > 1:
        return
    # Its minSJ is the least det J, here in a corner, by that at the centre.
    determinants = det_jacobian(mesh, np.array([(-1.0, -1.0), (1, -1), (1, 1), (-1, 1), (0, 0)]))
    expected = determinants.min(axis=1) / determinants[:, -1]
    np.testing.assert_allclose(gmsh.model.mesh.getElementQualities(tags, "minSJ"), expected, rtol=1e-10)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize(
    ("order", "quad", "line"), [(1, "quad", "line"), (2, "quad9", "line3"), (6, "quad49", "line7")]
)
def test_meshio_reads_proper_types(order, quad, line, version, layouts, tmp_path):
    meshio = pytest.importorskip("meshio")
    mesh = channel(layouts, order)
    path = tmp_path / "channel.msh"
    write_msh(path, mesh, version)
    file = meshio.read(path, file_format="gmsh")
    assert set(file.cells_dict) == {quad, line}
    assert {name: tuple(value) for name, value in file.field_data.items()} == {
        "bottom": (1, 1),
        "left": (2, 1),
        "walls": (3, 1),
        "fluid": (4, 2),
        "the solid": (5, 2),
    }
    if version == "2.2" and order <= 2:  # GLL and equispaced nodes are the same, and so is the order that meshio reads
        np.testing.assert_allclose(file.points[:, :2], mesh.points, atol=1e-15)
        np.testing.assert_array_equal(file.cells_dict[quad], mesh.cells[:, node_order(order, "gmsh")])
        assert np.bincount(file.get_cell_data("gmsh:physical", quad)).tolist() == [0, 0, 0, 0, 16, 8]


def test_elements_without_a_group_are_kept(layouts, gmsh, tmp_path):
    mesh = generate(layouts.square(counts=2), 2)
    bare = QuadMesh(mesh.points, mesh.cells, 2, {"corner": np.array([0])}, {})
    for version in VERSIONS:
        write_msh(tmp_path / "bare.msh", bare, version)
        gmsh.open(str(tmp_path / "bare.msh"))
        assert len(gmsh.model.mesh.getElementsByType(10)[0]) == 4
        ((_, tag),) = gmsh.model.getPhysicalGroups()
        assert gmsh.model.getPhysicalName(2, tag) == "corner"
        assert_same(read_msh(tmp_path / "bare.msh"), bare)


def overlapping(layouts, order=3):
    mesh = generate(layouts.square(counts=3), order)
    inside = {
        "a": np.array([0, 1, 2]),
        "all": np.arange(9),
        "none": np.zeros(0, dtype=np.int64),
        "both": np.array([2, 0]),
    }
    edges = {
        "from the left": np.array([(3, 1)]),
        "from the right": np.array([(4, 3)]),
        "left": np.array([(0, 3), (3, 3), (6, 3)]),
        "both": np.array([(0, 3), (3, 1)]),
        "empty": np.zeros((0, 2), dtype=np.int64),
    }
    return QuadMesh(mesh.points, mesh.cells, order, inside, edges)


def test_version_41_holds_elements_in_several_groups(layouts, gmsh, tmp_path):
    mesh = overlapping(layouts)
    path = tmp_path / "m.msh"
    write_msh(path, mesh)
    assert path.read_bytes().startswith(b"$MeshFormat\n4.1 1 8\n")
    assert_same(read_msh(path), mesh)
    gmsh.open(str(path))
    assert len(gmsh.model.mesh.getElementsByType(36)[0]) == 9
    found = {}
    for dimension, tag in gmsh.model.getPhysicalGroups():
        entities = gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
        count = sum(len(tags) for e in entities for tags in gmsh.model.mesh.getElements(dimension, e)[1])
        found[dimension, gmsh.model.getPhysicalName(dimension, tag)] = count
    expected = {(2, name): len(members) for name, members in mesh.cell_groups.items()}
    expected |= {(1, name): len(members) for name, members in mesh.edge_groups.items()}
    assert found == expected


def test_nodes_lie_on_curves_where_there_are_any(layouts, gmsh, tmp_path):
    mesh = generate(layouts.annulus(4, counts=2), 3)
    write_msh(tmp_path / "m.msh", mesh, "4.1")
    gmsh.open(str(tmp_path / "m.msh"))
    on_curves = np.concatenate([gmsh.model.mesh.getNodes(1, tag)[0] for _, tag in gmsh.model.getEntities(1)])
    expected = np.concatenate([mesh.edge_nodes("inner"), mesh.edge_nodes("outer")]) + 1
    assert np.array_equal(np.sort(on_curves), np.sort(expected))


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("order", [1, 3, 10])
def test_text_is_as_exact_as_bytes(order, version, gmsh, layouts, tmp_path):
    mesh = overlapping(layouts, order) if version == "4.1" else channel(layouts, order)
    write_msh(tmp_path / "bytes.msh", mesh, version)
    write_msh(tmp_path / "text.msh", mesh, version, binary=False)
    text = (tmp_path / "text.msh").read_text()
    assert text.startswith(f"$MeshFormat\n{version} 0 8\n")
    again, other = read_msh(tmp_path / "text.msh"), read_msh(tmp_path / "bytes.msh")
    np.testing.assert_array_equal(again.points, other.points)
    assert_same(again, mesh)
    found = []
    for name in ("bytes.msh", "text.msh"):
        gmsh.open(str(tmp_path / name))
        tags, places, _ = gmsh.model.mesh.getNodes()
        groups = [(d, gmsh.model.getPhysicalName(d, tag)) for d, tag in gmsh.model.getPhysicalGroups()]
        quads = gmsh.model.mesh.getElementsByType(gmsh.model.mesh.getElementType("quadrangle", order))
        found.append((places.reshape(-1, 3)[np.argsort(tags)].tolist(), [q.tolist() for q in quads], groups))
    assert found[0] == found[1]


@pytest.mark.parametrize("version", VERSIONS)
def test_odd_names_come_back(version, gmsh, layouts, tmp_path):
    names = ["a  b", "ö/и", "$EndNodes", "it's #1; {x}", "x" * 120, "\\n"]
    mesh = generate(layouts.square(counts=2), 2)
    mesh = QuadMesh(mesh.points, mesh.cells, 2, {}, {name: np.array([(0, 0)]) for name in names})
    write_msh(tmp_path / "m.msh", mesh, version)
    assert_same(read_msh(tmp_path / "m.msh"), mesh)
    gmsh.open(str(tmp_path / "m.msh"))
    assert [gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups()] == names


def test_what_the_format_cannot_hold(layouts, tmp_path):
    mesh = generate(layouts.square(), 2)
    path = tmp_path / "mesh.msh"
    with pytest.raises(MeshFileError, match=r"has order 11; Gmsh's files hold orders 1 to 10. Write .vtu or .npz"):
        write_msh(path, generate(layouts.square(), 11))
    twice = QuadMesh(mesh.points, mesh.cells, 2, {"a": np.array([0]), "b": np.array([0])}, {})
    with pytest.raises(MeshFileError, match=r"element 0 is in group 'b' and in another one; .* Write version 4\.1"):
        write_msh(path, twice, "2.2")
    for name in ('say "x"', "two\nlines", "x" * 121, ""):
        named = QuadMesh(mesh.points, mesh.cells, 2, {name: np.array([0])}, {})
        with pytest.raises(
            MeshFileError, match="cannot be written; expected 1 to 120 bytes without control characters and double q"
        ):
            write_msh(path, named)
    with pytest.raises(ValueError, match=r"version is '4'; expected '2.2' or '4.1'"):
        write_msh(path, mesh, "4")
    assert not list(tmp_path.iterdir())
