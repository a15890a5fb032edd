"""Fields in files."""

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.errors import FieldError, MeshFileError
from hoblock.fields import GridField, MeshField
from hoblock.generate import generate
from hoblock.io.field_file import read_field, write_field

X, Y = np.linspace(0.0, 1.0, 6), np.linspace(-1.0, 2.0, 5)
VALUES = np.sin(X[:, None]) + Y[None, :] ** 2
PLACES = np.array([[0.3, 0.4], [0.9, -0.7]])


def text(separator=",", heading="x,y,phi\n", shuffle=True):
    rows = [(x, y, VALUES[i, j]) for i, x in enumerate(X) for j, y in enumerate(Y)]
    order = np.random.default_rng(7311).permutation(len(rows)) if shuffle else range(len(rows))
    return heading + "".join(separator.join(repr(float(v)) for v in rows[k]) + "\n" for k in order)


@pytest.mark.parametrize("degree", [1, 3])
def test_grids_survive_the_round_trip(tmp_path, degree):
    field = GridField(X, Y, VALUES, degree)
    write_field(tmp_path / "phi.npz", field)
    back = read_field(tmp_path / "phi.npz", degree)
    assert isinstance(back, GridField)
    assert back.degree == degree
    for name in ("x", "y", "values"):
        np.testing.assert_array_equal(getattr(back, name), getattr(field, name))


def test_mesh_fields_survive_the_round_trip(tmp_path):
    mesh = generate(
        BlockStructure.build({"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1)}, [("a", "b", "c", "d")]), 4
    )
    field = MeshField(mesh, np.exp(mesh.points[:, 0]))
    write_field(tmp_path / "phi.npz", field)
    back = read_field(tmp_path / "phi.npz")
    assert isinstance(back, MeshField)
    np.testing.assert_array_equal(back(np.abs(PLACES)), field(np.abs(PLACES)))
    np.testing.assert_array_equal(back.mesh.cells, mesh.cells)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("phi.csv", text()),
        ("phi.csv", text("; ", "# of a measurement\nx; y; phi\n\n")),
        ("phi.txt", text("  ", "", shuffle=False)),
        ("phi.TXT", "\ufeff" + text("\t")),
    ],
)
def test_tables_in_any_order(tmp_path, name, content):
    (tmp_path / name).write_text(content, encoding="utf-8")
    field = read_field(tmp_path / name)
    assert isinstance(field, GridField)
    np.testing.assert_array_equal(field.values, VALUES)


def test_arrays_of_integers_are_numbers(tmp_path):
    np.savez(tmp_path / "phi.npz", x=np.arange(4), y=np.arange(5), values=np.ones((4, 5), dtype=int))
    np.testing.assert_allclose(read_field(tmp_path / "phi.npz")(np.array([[0.5, 0.5]])), 1.0)


@pytest.mark.parametrize(
    ("name", "content", "match"),
    [
        ("phi.json", "{}", r"suffix is '\.json'; expected one of \.csv, \.npz, \.txt"),
        ("phi.npz", "PK no archive", "not a NumPy archive that can be read"),
        ("phi.csv", "x,y,v\n0,0,1\n0,1\n", r"line 3: got '0,1'; expected x, y and a value"),
        ("phi.csv", "x,y\nin m,in m\n0,0,1\n", r"line 2: got 'in m,in m'; expected x, y and a value"),
        ("phi.csv", "x,y,v\n0.1,np.float64(0.9),1\n", r"line 2: got '0\.1,np\.float64\(0\.9\),1'"),
        ("phi.csv", "# m\nx y\nnp.float64(0.9) 0 1\n0 0 1\n", r"line 3: got 'np\.float64\(0\.9\) 0 1'; expected x, y"),
        ("phi.csv", "0,0,1\n0,1,a\n", r"line 2: got '0,1,a'"),
        ("phi.csv", "", "0 values at 0 different x and 0 different y, nothing; expected one value"),
        ("phi.csv", "0,0,1\n0,1,1\n1,0,1\n", r"3 values at 2 different x and 2 different y, none at \(1, 1\)"),
        ("phi.csv", "0,0,1\n0,1,1\n1,0,1\n1,1,2\n1,1,2\n", r"2 at \(1, 1\); expected one value at every point"),
        ("phi.csv", "0,0,1\n0,1,1\n1,0,1\n1,1,2\n", r"phi\.csv: grid field: x has shape \(2,\); expected at least 4"),
    ],
)
def test_bad_text(tmp_path, name, content, match):
    (tmp_path / name).write_text(content, encoding="utf-8")
    with pytest.raises(FieldError, match=match):
        read_field(tmp_path / name)


@pytest.mark.parametrize(
    ("arrays", "error", "match"),
    [
        ({"x": X, "y": Y}, FieldError, "there is no array 'values'; expected 'x', 'y' and 'values' of a grid, or"),
        ({"values": VALUES}, FieldError, "there is no array 'x', 'y'"),
        ({"x": X, "y": Y, "values": VALUES.T}, FieldError, r"phi\.npz: grid field: values have .* Transpose them"),
        ({"x": X, "y": Y, "values": VALUES.astype(str)}, FieldError, "'values' has type .*; expected real numbers"),
        ({"cells": np.zeros((1, 4), int), "values": X}, MeshFileError, "format is 'not given'"),
        ({"x": X, "y": Y, "values": np.array([object()])}, FieldError, "not a NumPy archive that can be read"),
    ],
)
def test_bad_archives(tmp_path, arrays, error, match):
    np.savez(tmp_path / "phi.npz", **arrays)
    with pytest.raises(error, match=match):
        read_field(tmp_path / "phi.npz")


def test_files_that_are_not_text_or_not_there(tmp_path):
    (tmp_path / "phi.csv").write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(FieldError, match="not a text file"):
        read_field(tmp_path / "phi.csv")
    with pytest.raises(FileNotFoundError):
        read_field(tmp_path / "nowhere.npz")
    with pytest.raises(FieldError, match=r"suffix is '\.csv'; expected '\.npz'"):
        write_field(tmp_path / "phi.csv", GridField(X, Y, VALUES))
