import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.msh import write_msh
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.quality import det_jacobian
from hoblock.reference import gauss_lobatto, tensor_basis

pytest.importorskip("meshio")


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
def gmsh():
    module = pytest.importorskip("gmsh")
    module.initialize(interruptible=False)
    module.option.setNumber("General.Terminal", 0)
    yield module
    module.finalize()


@pytest.mark.parametrize("order", range(1, 11))
def test_gmsh_reads_the_same_geometry_and_names(order, gmsh, layouts, rng, tmp_path):
    mesh = channel(layouts, order)
    path = tmp_path / "channel.msh"
    write_msh(path, mesh)
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


def test_gmsh_measures_curved_boundaries(gmsh, layouts, tmp_path):
    mesh = generate(layouts.annulus(4, counts=2), 7)
    write_msh(tmp_path / "annulus.msh", mesh)
    gmsh.open(str(tmp_path / "annulus.msh"))
    points, weights = gmsh.model.mesh.getIntegrationPoints(1, "Gauss12")
    kind = gmsh.model.mesh.getElementType("line", 7)
    for dimension, tag in gmsh.model.getPhysicalGroups(1):
        (entity,) = gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
        _, determinants, _ = gmsh.model.mesh.getJacobians(kind, points, entity)
        length = float((determinants.reshape(-1, len(weights)) @ weights).sum())
        radius = {"inner": 1.0, "outer": 2.0}[gmsh.model.getPhysicalName(dimension, tag)]
        assert length == pytest.approx(2 * np.pi * radius, rel=1e-10)


@pytest.mark.parametrize(
    ("order", "quad", "line"),
    [(1, "quad", "line"), (2, "quad9", "line3"), (3, "quad16", "line4"), (6, "quad49", "line7")],
)
def test_meshio_reads_proper_types(order, quad, line, layouts, tmp_path):
    import meshio

    mesh = channel(layouts, order)
    path = tmp_path / "channel.msh"
    write_msh(path, mesh)
    assert path.read_bytes().startswith(b"$MeshFormat\n2.2 1 8\n")
    file = meshio.read(path, file_format="gmsh")
    assert set(file.cells_dict) == {quad, line}
    assert {name: tuple(value) for name, value in file.field_data.items()} == {
        "bottom": (1, 1),
        "left": (2, 1),
        "walls": (3, 1),
        "fluid": (4, 2),
        "the solid": (5, 2),
    }
    if order <= 2:  # GLL and equispaced nodes are the same, and so is the order that meshio reads
        np.testing.assert_allclose(file.points[:, :2], mesh.points, atol=1e-15)
        np.testing.assert_array_equal(file.cells_dict[quad], mesh.cells[:, node_order(order, "gmsh")])
    assert np.bincount(file.get_cell_data("gmsh:physical", quad)).tolist() == [0, 0, 0, 0, 16, 8]


def test_elements_without_a_group_are_kept(layouts, gmsh, tmp_path):
    mesh = generate(layouts.square(counts=2), 2)
    bare = QuadMesh(mesh.points, mesh.cells, 2, {"corner": np.array([0])}, {})
    write_msh(tmp_path / "bare.msh", bare)
    gmsh.open(str(tmp_path / "bare.msh"))
    assert len(gmsh.model.mesh.getElementsByType(10)[0]) == 4
    ((_, tag),) = gmsh.model.getPhysicalGroups()
    assert gmsh.model.getPhysicalName(2, tag) == "corner"


def test_what_the_format_cannot_hold(layouts, tmp_path):
    mesh = generate(layouts.square(), 2)
    path = tmp_path / "mesh.msh"
    with pytest.raises(MeshFileError, match=r"has order 11; Gmsh's files hold orders 1 to 10. Write .vtu or .npz"):
        write_msh(path, generate(layouts.square(), 11))
    twice = QuadMesh(mesh.points, mesh.cells, 2, {"a": np.array([0]), "b": np.array([0])}, {})
    with pytest.raises(MeshFileError, match="element 0 is in group 'b' and in another one"):
        write_msh(path, twice)
    same = QuadMesh(mesh.points, mesh.cells, 2, {"a": np.array([0])}, {"a": np.array([(0, 0)])})
    with pytest.raises(MeshFileError, match=r"'a' names elements and edges; a .msh file needs different names"):
        write_msh(path, same)
    assert not path.exists()
