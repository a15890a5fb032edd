"""Block edges by their materials."""

from __future__ import annotations

import pytest

from hoblock.scene import MeshScene
from hofsi.edge_owners import FLUID, EdgeOwners, components, edges_of, in_words, named_edges, quad_edges, solid_label

# 3 ─ 4 ─ 5 ─ 8
# │ f │ f │ s │
# 0 ─ 1 ─ 2 ─ 7
MESH = MeshScene(
    order=1,
    vertices={},
    blocks={"f": (("0", "1", "4", "3"), ("1", "2", "5", "4")), "s": (("2", "7", "8", "5"),)},
    edges={"floor": (("2", "1", "0"), ("2", "7")), "wall": (("3", "0"),)},
)


@pytest.fixture
def owners() -> EdgeOwners:
    return EdgeOwners.build(MESH, {FLUID: ("f",), solid_label("flag"): ("s",)})


def test_outer_edges(owners: EdgeOwners) -> None:
    assert set(owners.outer(FLUID)) == {("0", "1"), ("1", "2"), ("4", "5"), ("3", "4"), ("0", "3")}
    assert set(owners.outer("solid 'flag'")) == {("2", "7"), ("7", "8"), ("5", "8")}


def test_wet_edges_lie_between_fluid_and_solid(owners: EdgeOwners) -> None:
    assert [edge for edge in owners.of if owners.is_wet(edge)] == [("2", "5")]
    assert not owners.is_wet(("0", "5"))


def test_two_solids_share_an_edge_that_is_dry() -> None:
    owners = EdgeOwners.build(MESH, {"solid 'a'": ("f",), "solid 'b'": ("s",)})
    assert not owners.is_wet(("2", "5"))
    assert ("2", "5") not in owners.outer("solid 'a'")


@pytest.mark.parametrize(
    ("edge", "words"),
    [
        (("0", "1"), "belongs to the fluid alone"),
        (("1", "4"), "is inside the fluid"),
        (("2", "5"), "is shared by the fluid and solid 'flag'"),
        (("0", "5"), "is not an edge of a block with a material"),
    ],
)
def test_where(owners: EdgeOwners, edge: tuple[str, str], words: str) -> None:
    assert owners.where(edge) == words


def test_edges_have_no_direction() -> None:
    assert quad_edges(("2", "7", "8", "5")) == (("2", "7"), ("7", "8"), ("5", "8"), ("2", "5"))
    assert named_edges(MESH, "floor") == (("1", "2"), ("0", "1"), ("2", "7"))
    assert edges_of(MESH, ["wall"]) == (("wall", ("0", "3")),)


def test_components_are_held_together_by_edges() -> None:
    chain = [("a", "b", "c", "d"), ("e", "f", "g", "h"), ("c", "d", "e", "f")]
    assert len(components(chain)) == 1
    corner = [("a", "b", "c", "d"), ("c", "x", "y", "z")]
    assert [len(part) for part in components(corner)] == [4, 4]
    assert components([]) == ()


def test_in_words_is_short() -> None:
    assert in_words([("a", "b"), ("b", "c")]) == "a–b, b–c"
    many = [(f"v{k}", f"w{k}") for k in range(11)]
    assert in_words(many).endswith("v7–w7, … (11 edges)")
