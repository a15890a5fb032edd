import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.building import build_structure
from hoblock.cli import main
from hoblock.curves import Arc
from hoblock.errors import SceneError, TopologyError
from hoblock.generate import generate
from hoblock.io.mesh_file import write_mesh
from hoblock.io.scene import load_mesh_scene

SCENE = """
[mesh]
order = 5
elements = 2
structure = "meshes/coarse.msh"

[mesh.edges]
cut = [["1", "2"]]

[[mesh.count]]
on = "inner"
elements = 3

[[mesh.grading]]
on = "cut"
kind = "quadratic"
m = 0.3
"""


@pytest.fixture
def scene(tmp_path):
    corners = np.array([(1, 0), (2, 0), (0, 2), (0, 1)], dtype=float)
    arcs = {pair: Arc.from_center((0, 0), *corners[list(pair)]) for pair in ((0, 3), (1, 2))}
    structure = BlockStructure.build(corners, {"ring": [(0, 1, 2, 3)]}, curves=arcs, edges={"inner": [(0, 3)]})
    (tmp_path / "meshes").mkdir()
    write_mesh(tmp_path / "meshes" / "coarse.msh", generate(structure, 4))
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def test_a_mesh_file_takes_the_place_of_vertices_and_blocks(scene):
    structure = build_structure(load_mesh_scene(scene))
    topology = structure.topology
    assert list(topology.block_groups) == ["ring"]
    assert set(topology.edge_groups) == {"inner", "cut"}
    assert len(structure.curves) == 2
    inner, cut = (int(topology.edge_groups[name][0]) for name in ("inner", "cut"))
    assert (topology.counts[inner], topology.counts[cut]) == (3, 2)
    mesh = generate(structure, 5)
    np.testing.assert_allclose(np.hypot(*mesh.points[mesh.edge_nodes("inner")].T), 1.0, atol=1e-3)


def test_it_is_meshed_from_the_command_line(scene, tmp_path, capsys):
    assert main(["mesh", str(scene), "-o", str(tmp_path / "out.npz")]) == 0
    assert "order 5" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "error", "match"),
    [
        ("mesh.structure='none.msh'", SceneError, r"mesh.structure: .*none.msh: cannot be read \(No such file"),
        ("mesh.structure='scene.toml'", SceneError, r"mesh.structure: .*scene.toml: meshio cannot read it"),
        (
            "mesh.vertices.a=[0, 0]",
            SceneError,
            "mesh.vertices: got this beside mesh.structure, a mesh file",
        ),
        ("mesh.edges.cut=[['1', 'z']]", SceneError, "unknown vertex 'z'"),
        ("mesh.edges.cut=[['1', '3']]", TopologyError, "mesh.edges.cut: no block has a side from '1' to '3'"),
    ],
)
def test_mistakes_have_a_place(change, error, match, scene):
    with pytest.raises(error, match=match):
        build_structure(load_mesh_scene(scene, [change]))
