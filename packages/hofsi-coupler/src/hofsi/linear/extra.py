"""The optional library of the iterative path, imported where it is used."""

from __future__ import annotations

from types import ModuleType

from hoblock.extras import import_extra

__all__ = ["pyamg_module"]


def pyamg_module(name: str = "pyamg") -> ModuleType:
    """Import pyamg or one of its modules.

    Raises
    ------
    MissingExtraError
        If pyamg is not installed; names the extra that brings it.
    """
    return import_extra(name, "amg", "hofsi-coupler")
