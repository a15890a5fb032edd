import numpy as np
import pytest

from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.npz import read_npz, write_npz


@pytest.fixture
def path(tmp_path):
    return tmp_path / "mesh.npz"


@pytest.mark.parametrize("order", [1, 4, 12])
def test_a_mesh_comes_back_to_the_last_bit(order, layouts, path):
    mesh = generate(layouts.annulus(3, counts=2), order)
    write_npz(path, mesh)
    again = read_npz(path)
    assert again.order == order
    np.testing.assert_array_equal(again.points, mesh.points)
    np.testing.assert_array_equal(again.cells, mesh.cells)
    for ours, theirs in ((mesh.cell_groups, again.cell_groups), (mesh.edge_groups, again.edge_groups)):
        assert list(ours) == list(theirs)
        for name in ours:
            np.testing.assert_array_equal(theirs[name], ours[name])
    with pytest.raises(ValueError, match="read-only"):
        again.points[0] = 1


def test_names_may_contain_anything(layouts, path):
    mesh = generate(layouts.square(edges={"../up/и ö": [("a", "b")]}), 2)
    write_npz(path, mesh)
    assert list(read_npz(path).edge_groups) == ["../up/и ö"]


def test_files_are_the_same_for_the_same_mesh(layouts, tmp_path):
    mesh = generate(layouts.square(counts=2), 3)
    for name in ("one.npz", "two.npz"):
        write_npz(tmp_path / name, mesh)
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "two.npz").read_bytes()


def test_nothing_is_unpickled(path):
    np.savez(path, format=np.array([{"a": 1}], dtype=object))
    with pytest.raises(MeshFileError, match=r"not a NumPy archive that can be read .*pickle"):
        read_npz(path)


def test_files_of_another_kind(path):
    path.write_text("no archive")
    with pytest.raises(MeshFileError, match=r"mesh\.npz: not a NumPy archive that can be read"):
        read_npz(path)
    with path.open("wb") as file:
        np.save(file, np.zeros(3))
    with pytest.raises(MeshFileError, match="not a NumPy archive that can be read"):
        read_npz(path)
    path.write_bytes(b"P")
    with pytest.raises(
        MeshFileError, match=r"not a NumPy archive that can be read \(File is not a zip file\)\. Write it"
    ):
        read_npz(path)
    path.write_bytes(b"")
    with pytest.raises(MeshFileError, match="not a NumPy archive that can be read"):
        read_npz(path)
    np.savez(path, points=np.zeros((3, 2)))
    with pytest.raises(MeshFileError, match="format is 'not given'; expected 'hoblock mesh 1'"):
        read_npz(path)
    with pytest.raises(FileNotFoundError):
        read_npz(path.with_name("missing.npz"))


def test_damaged_files(layouts, path):
    write_npz(path, generate(layouts.square(counts=2), 3))
    data = bytearray(path.read_bytes())
    middle = len(data) // 3
    data[middle : middle + 40] = bytes(40)
    path.write_bytes(data)
    with pytest.raises(MeshFileError, match="not a NumPy archive that can be read"):
        read_npz(path)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"order": np.array(0)}, "order is 0; expected at least 1"),
        ({"points": np.zeros((9, 3))}, r"points have shape \(9, 3\); expected \(n, 2\)"),
        ({"points": np.zeros((9, 2), dtype=np.float32)}, "points have type float32; expected float64"),
        ({"order": np.array(3)}, r"cells have shape \(1, 9\); expected \(e, 16\)"),
        ({"cells": np.zeros((1, 9))}, "cells have type float64; expected integers"),
        ({"cells": np.arange(1, 10)[None]}, "cells run from 1 to 9; expected 0 to 8"),
        ({"cell_group_0": np.array([1])}, "elements of group 'body' run from 1 to 1; expected 0 to 0"),
        ({"cell_group_0": np.array([[0]])}, r"group 'body' has shape \(1, 1\); expected \(k,\)"),
        ({"edge_group_0": np.array([0, 1])}, r"edge group 'low' has shape \(2,\); expected \(k, 2\)"),
        ({"edge_group_0": np.array([(0, 4)])}, "sides of edge group 'low' run from 4 to 4; expected 0 to 3"),
        ({"edge_group_0": np.array([(2, 0)])}, "elements of edge group 'low' run from 2 to 2"),
        ({"edge_group_0": None}, "there is no array 'edge_group_0'; the file is incomplete"),
        ({"points": None}, "there is no array 'points'"),
    ],
)
def test_parts_that_do_not_fit(change, match, layouts, path):
    write_npz(path, generate(layouts.square(edges={"low": [("a", "b")]}), 2))
    with np.load(path) as archive:
        arrays = dict(archive)
    arrays.update(change)
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    with pytest.raises(MeshFileError, match=match):
        read_npz(path)
