"""Level sets in a scene."""

import numpy as np
import pytest

from hoblock.errors import ExpressionError, SceneError
from hoblock.expressions import Expression
from hoblock.fields import GridField
from hoblock.io.field_file import write_field
from hoblock.io.scene_isoline import read_isoline
from hoblock.io.table import Table

LINES = np.linspace(0.0, 1.0, 7)


def read(keys, folder):
    table = Table(keys, "mesh.curve[2]")
    isoline = read_isoline(table, {"r": 0.25}, folder)
    table.finish()
    return isoline


def test_formula_with_defaults(tmp_path):
    isoline = read({"function": "x**2 + y**2 - r**2"}, tmp_path)
    assert isinstance(isoline.function, Expression)
    np.testing.assert_allclose(isoline.function.evaluate(x=0.25, y=0.0), 0.0)
    assert (isoline.level, isoline.reach, isoline.project) == (0.0, 0.5, False)


def test_values_of_a_file_beside_the_scene(tmp_path):
    write_field(tmp_path / "phi.npz", GridField(LINES, LINES, np.add.outer(LINES, LINES)))
    isoline = read({"values": "phi.npz", "degree": 2, "level": "2*r", "reach": 0.1, "project": True}, tmp_path)
    assert isinstance(isoline.function, GridField)
    assert (isoline.function.degree, isoline.level, isoline.reach, isoline.project) == (2, 0.5, 0.1, True)


@pytest.mark.parametrize(
    ("keys", "error", "match"),
    [
        ({}, SceneError, r"mesh\.curve\[2\]: a level set with neither 'function' nor 'values'; expected exactly one"),
        ({"function": "x", "values": "phi.npz"}, SceneError, "both 'function' and 'values'"),
        ({"function": "x + z"}, ExpressionError, r"mesh\.curve\[2\]\.function: .*'z' is not known"),
        ({"function": "x", "reach": 0}, SceneError, r"mesh\.curve\[2\]\.reach: .* above 0"),
        ({"function": "x", "level": "a"}, ExpressionError, r"mesh\.curve\[2\]\.level: "),
        ({"function": "x", "project": 1}, SceneError, r"project: .*expected true or false"),
        ({"function": "x", "degree": 3}, SceneError, r"degree: unknown key"),
        ({"values": "phi.npz", "degree": 6}, SceneError, r"degree: got 6; expected .* at most 5"),
        ({"values": "gone.npz"}, SceneError, r"values: the file .*gone\.npz cannot be read: No such file"),
        ({"values": "scene.toml"}, SceneError, r"values: .*suffix is '\.toml'; expected one of"),
    ],
)
def test_errors(tmp_path, keys, error, match):
    write_field(tmp_path / "phi.npz", GridField(LINES, LINES, np.add.outer(LINES, LINES)))
    with pytest.raises(error, match=match):
        read(keys, tmp_path)
