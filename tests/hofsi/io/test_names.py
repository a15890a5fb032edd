"""Names that a scene defines and uses."""

from __future__ import annotations

import pytest

from hoblock.errors import SceneError
from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hofsi.errors import CaseError
from hofsi.io.names import block_groups, check_name, choice, edge_names

MESH = MeshScene(order=1, vertices={}, blocks={"water": (), "steel": ()}, edges={"wall": ()})


def test_choice() -> None:
    table = Table({"type": "amg"}, "linear")
    assert choice(table, "type", ("direct", "amg"), "direct") == "amg"
    assert choice(table, "other", ("direct", "amg"), "auto") == "auto"
    table.finish()


def test_choice_of_an_unknown_word() -> None:
    with pytest.raises(SceneError, match=r"linear.type: got 'smg'. Did you mean 'amg'\?"):
        choice(Table({"type": "smg"}, "linear"), "type", ("direct", "amg"), "direct")


def test_block_groups() -> None:
    assert block_groups(Table({"blocks": "steel"}), MESH, "solid") == ("steel",)
    assert block_groups(Table({"blocks": ["water", "steel"]}), MESH, "solid") == ("water", "steel")


def test_the_default_group_must_exist_too() -> None:
    expected = r"fluid.blocks: got the unknown name 'fluid'. Expected one of the groups in .*: water, steel"
    with pytest.raises(CaseError, match=expected):
        block_groups(Table({}, "fluid"), MESH, "fluid")


def test_edge_names() -> None:
    assert edge_names(Table({"on": "wall"}), MESH) == ("wall",)
    with pytest.raises(SceneError, match=r"motion\[0\].on: the required key is missing"):
        edge_names(Table({}, "motion[0]"), MESH)


def test_no_names_at_all() -> None:
    with pytest.raises(CaseError, match=r"a.b: got the unknown name 'c'. Expected one of the things: there are none"):
        check_name("c", (), "things", "a.b")


def test_many_names_are_not_all_listed() -> None:
    with pytest.raises(CaseError, match=r"n18, n19, …$"):
        check_name("other", [f"n{k}" for k in range(30)], "things", "a")
