import numpy as np
import pytest

from hoblock.cli import main
from hoblock.io.npz import write_npz
from hoblock.mesh import QuadMesh

SCENE = """
title = "a bent channel"
[constants]
h = 0.2
[mesh]
order = 3
elements = 2
[mesh.vertices]
a = [0, 0]
b = [2, 0]
c = [2, 1]
d = [0, 1]
e = [4, 0]
f = [4, 1]
[mesh.blocks]
fluid = [["a", "b", "c", "d"]]
solid = [["b", "e", "f", "c"]]
[mesh.edges]
bottom = [["a", "b", "e"]]
inlet = [["a", "d"]]
[[mesh.curve]]
on = [["a", "b"]]
kind = "parametric"
x = "2*s"
y = "h*sin(pi*s)"
[[mesh.count]]
on = [["b", "e"]]
elements = 3
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "bent.toml"
    path.write_text(SCENE, encoding="utf-8")
    return path


@pytest.fixture
def file(scene, tmp_path, capsys):
    """A mesh file of order 3."""
    path = tmp_path / "bent.npz"
    assert main(["mesh", str(scene), "-o", str(path)]) == 0
    capsys.readouterr()
    return path


@pytest.fixture
def bad_file(tmp_path):
    """A mesh file with one element turned over."""
    points = np.array([(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)], dtype=float)
    cells = np.array([[0, 1, 3, 4], [2, 1, 5, 4]])
    write_npz(tmp_path / "bad.npz", QuadMesh(points, cells, 1, {}, {}))
    return tmp_path / "bad.npz"
