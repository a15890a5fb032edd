import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc
from hoblock.errors import MeshFileError, TopologyError
from hoblock.generate import generate
from hoblock.io.block_file import read_structure
from hoblock.io.mesh_file import write_mesh
from hoblock.topology_checks import tolerance


@pytest.fixture
def gmsh(gmsh_module):
    gmsh_module.initialize()
    gmsh_module.option.setNumber("General.Terminal", 0)
    yield gmsh_module
    gmsh_module.finalize()


def channel(gmsh, order, *, recombine=True):
    """A channel with a hole, unstructured quads, names of every dimension."""
    gmsh.model.add("channel")
    occ = gmsh.model.occ
    plate, disk = occ.addRectangle(0, 0, 0, 3, 2), occ.addDisk(1.2, 1, 0, 0.4, 0.4)
    occ.cut([(2, plate)], [(2, disk)])
    occ.synchronize()
    surfaces, curves = ([tag for _, tag in gmsh.model.getEntities(d)] for d in (2, 1))
    round_ones = [tag for tag in curves if gmsh.model.getType(1, tag) != "Line"]
    gmsh.model.addPhysicalGroup(2, surfaces, 5, "fluid")
    gmsh.model.addPhysicalGroup(1, round_ones, 6, "cylinder")
    gmsh.model.addPhysicalGroup(1, [tag for tag in curves if tag not in round_ones], 7, "walls")
    corner = next(tag for _, tag in gmsh.model.getEntities(0) if np.allclose(gmsh.model.getValue(0, tag, [])[:2], 0.0))
    gmsh.model.addPhysicalGroup(0, [corner], 8, "origin")
    for name, value in (("MeshSizeMin", 0.5), ("MeshSizeMax", 0.5), ("RecombineAll", recombine), ("Algorithm", 8)):
        gmsh.option.setNumber(f"Mesh.{name}", value)
    gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", 1 if recombine else 0)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(order)
    return len(gmsh.model.mesh.getElementsByType(gmsh.model.mesh.getElementType("Quadrangle", order))[0])


@pytest.mark.parametrize(("version", "binary"), [(2.2, 0), (2.2, 1), (4.1, 0), (4.1, 1)])
@pytest.mark.parametrize("order", [1, 2, 4])
def test_a_coarse_mesh_of_gmsh_becomes_an_order_6_mesh(order, version, binary, gmsh, tmp_path):
    count = channel(gmsh, order)
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    path = tmp_path / "coarse.msh"
    gmsh.write(str(path))
    structure = read_structure(path, counts=3)
    topology = structure.topology
    assert len(topology.quads) == count
    assert {name: len(blocks) for name, blocks in topology.block_groups.items()} == {"fluid": count}
    cylinder = topology.edge_groups["cylinder"]
    assert set(cylinder.tolist()) == set(structure.curves if order > 1 else cylinder.tolist())
    assert set(topology.edge_groups) == {"cylinder", "walls"}
    assert tuple(structure.vertices[topology.vertex("origin")]) == (0.0, 0.0)
    tag = next(name for name in topology.vertex_names if name != "origin")
    np.testing.assert_allclose(
        structure.vertices[topology.vertex(tag)], gmsh.model.mesh.getNode(int(tag))[0][:2], atol=1e-14
    )
    mesh = generate(structure, 6)  # certified
    assert len(mesh.cells) == 9 * count
    radii = np.hypot(*(mesh.points[mesh.edge_nodes("cylinder")] - [1.2, 1.0]).T)
    assert abs(radii / 0.4 - 1.0).max() < {1: 0.1, 2: 2e-3, 4: 1e-5}[order]


def test_quads_without_inner_nodes(gmsh, tmp_path):
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    channel(gmsh, 1)
    gmsh.model.mesh.setOrder(2)
    gmsh.write(str(tmp_path / "incomplete.msh"))
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 0)
    gmsh.model.mesh.setOrder(1)
    gmsh.model.mesh.setOrder(2)
    gmsh.write(str(tmp_path / "complete.msh"))
    first, second = (read_structure(tmp_path / name) for name in ("incomplete.msh", "complete.msh"))
    assert len(first.curves) == len(second.curves) > 0
    assert abs(generate(first, 4).points - generate(second, 4).points).max() < 1e-14


def test_other_formats_through_meshio(gmsh, tmp_path):
    count = channel(gmsh, 1)
    gmsh.option.setNumber("Mesh.SaveGroupsOfElements", 1)
    gmsh.write(str(tmp_path / "a.inp"))
    structure = read_structure(tmp_path / "a.inp")
    assert len(structure.topology.quads) == count
    assert {"cylinder", "walls"} <= set(structure.topology.edge_groups)
    assert len(structure.topology.block_groups["fluid"]) == count


def test_triangles_are_counted(gmsh, tmp_path):
    channel(gmsh, 1, recombine=False)
    gmsh.write(str(tmp_path / "a.msh"))
    with pytest.raises(MeshFileError, match=r"there are \d+ triangles beside 0 quads; expected none. In Gmsh: Mesh"):
        read_structure(tmp_path / "a.msh")
    gmsh.write(str(tmp_path / "a.su2"))
    with pytest.raises(MeshFileError, match=r"cells that are no quads: \d+ of type triangle beside 0 quads"):
        read_structure(tmp_path / "a.su2")


def annulus(order):
    corners = np.array([(1, 0), (2, 0), (0, 2), (0, 1)], dtype=float)
    arcs = {pair: Arc.from_center((0, 0), *corners[list(pair)]) for pair in ((0, 3), (1, 2))}
    structure = BlockStructure.build(
        corners, {"ring": [(0, 1, 2, 3)]}, counts=2, curves=arcs, edges={"inner": [(0, 3)], "outer": [(1, 2)]}
    )
    return generate(structure, order)


@pytest.mark.parametrize("suffix", [".npz", ".vtu", ".msh", ".mesh"])
@pytest.mark.parametrize("order", [1, 3])
def test_meshes_that_hoblock_wrote(suffix, order, tmp_path):
    mesh = annulus(order)
    path = tmp_path / f"mesh{suffix}"
    write_mesh(path, mesh)
    structure = read_structure(path, counts=1)
    assert {name: len(edges) for name, edges in structure.topology.edge_groups.items()} == {"inner": 2, "outer": 2}
    assert len(structure.topology.block_groups["ring"]) == 4
    again = generate(structure, order)
    distance = [np.hypot(*(mesh.points - point).T).min() for point in again.points]
    assert len(again.points) == len(mesh.points)
    assert max(distance) < 1e-13


MSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
{nodes}
$EndNodes
$Elements
{elements}
$EndElements
"""
NODES = "6\n1 0 0 {z}\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 2 1 0"


def written(path, elements, z=0):
    path.write_text(MSH.format(nodes=NODES.format(z=z), elements=elements))
    return path


def test_an_element_of_two_groups_is_one_block(tmp_path):
    path = written(tmp_path / "a.msh", "3\n1 3 2 7 1 1 2 3 4\n2 3 2 8 1 1 2 3 4\n3 3 2 7 1 2 5 6 3")
    groups = read_structure(path).topology.block_groups
    assert {name: blocks.tolist() for name, blocks in groups.items()} == {"7": [0, 1], "8": [0]}


@pytest.mark.parametrize(
    ("elements", "z", "match"),
    [
        ("1\n1 3 2 0 1 1 2 3 4", 0.2, r"a.msh: z runs from 0 to 0.2; expected a plane mesh, z the same everywhere"),
        ("1\n1 1 2 0 1 1 2", 0, "there are no quads; expected at least one"),
        ("1\n1 3 2 0 1 1 2 3 9", 0, "an element uses node 9, which is not in the file"),
        ("2\n1 3 2 0 1 1 2 3 4\n2 5 2 0 1 1 2 3 4 1 2 3 4", 0, "1 elements of volumes beside 1 quads; expected none"),
        ("2\n1 3 2 0 1 1 2 3 4\n2 16 2 0 1 2 5 6 3 1 2 3 4", 0, "quads of orders 1, 2; expected one order"),
        ("1\n1 3 2", 0, r"a.msh: \$Elements"),
    ],
)
def test_files_that_hold_no_structure(elements, z, match, tmp_path):
    path = written(tmp_path / "a.msh", elements, z)
    with pytest.raises(MeshFileError, match=match):
        read_structure(path)


def test_errors_of_the_topology_name_the_file(tmp_path):
    path = written(tmp_path / "a.msh", "2\n1 3 2 0 1 1 2 3 4\n2 3 2 0 1 1 2 6 4")
    with pytest.raises(TopologyError, match=r"a.msh: edge .* has two blocks on the same side"):
        read_structure(path)
    with pytest.raises(TopologyError, match=r"a\.msh: counts: no vertex named"):
        read_structure(written(path, "1\n1 3 2 0 1 1 2 3 4"), counts={("1", "7"): 3})


def test_files_that_are_none(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_structure(tmp_path / "missing.inp")
    for name in ("a.inp", "a.xyz", "a.su2"):
        (tmp_path / name).write_text("nothing that a mesh would say")
        with pytest.raises(MeshFileError, match=rf"{name}: "):
            read_structure(tmp_path / name)


def test_nearly_coincident_points_become_one(tmp_path):
    nodes = "8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 1.0000001 0 0\n6 2 0 0\n7 2 1 0\n8 1 1 0"
    path = tmp_path / "a.msh"
    path.write_text(MSH.format(nodes=nodes, elements="2\n1 3 2 0 1 1 2 3 4\n2 3 2 0 1 5 6 7 8"))
    assert len(read_structure(path, tolerance=1e-6).topology.vertex_names) == 6
    assert len(read_structure(path).topology.vertex_names) == 7
    assert tolerance(np.array([(0, 0), (2, 1)])) < 1e-7
