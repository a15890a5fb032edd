"""Names that a scene defines in one place and uses in another, and words from a fixed list."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hoblock.spelling import suggestion
from hofsi.errors import CaseError

__all__ = ["block_groups", "check_name", "choice", "edge_names"]

L = TypeVar("L", bound=str)


def choice(table: Table, key: str, choices: tuple[L, ...], default: L) -> L:
    """Read one of several words; a missing key gives the default, which need not be one of them."""
    if not table.has(key):
        return default
    return choices[choices.index(table.string(key, choices=choices))]


def check_name(name: str, known: Iterable[str], what: str, place: str) -> None:
    """Check that a name is defined.

    Parameters
    ----------
    name : str
    known : iterable of str
    what : str
        What it should be the name of, and where it is defined: ``"edges in [mesh.edges]"``.
    place : str

    Raises
    ------
    CaseError
        With the closest known name, and all of them.
    """
    known = tuple(known)
    if name not in known:
        listed = ", ".join(known[:20]) + (", …" if len(known) > 20 else "")
        raise CaseError(
            f"got the unknown name {name!r}. {suggestion(name, known)}Expected one of the {what}: "
            f"{listed or 'there are none'}",
            place,
        )


def edge_names(table: Table, mesh: MeshScene, key: str = "on") -> tuple[str, ...]:
    """Read ``on``, or another key: one or several names of the mesh's edges."""
    names = table.names(key)
    for name in names:
        check_name(name, mesh.edges, "edges in [mesh.edges]", table.place_of(key))
    return names


def block_groups(table: Table, mesh: MeshScene, default: str) -> tuple[str, ...]:
    """Read ``blocks``: one or several block groups of the mesh."""
    names = table.names("blocks", (default,))
    for name in names:
        check_name(name, mesh.blocks, "groups in [mesh.blocks]", table.place_of("blocks"))
    return names
