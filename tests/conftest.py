"""Fixtures and options shared by all tests."""

from __future__ import annotations

import importlib
from types import ModuleType

import pytest

_ORACLES = {"gmsh_module", "mfem", "vtk_module"}


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-public-api",
        action="store_true",
        help="rewrite tests/public_api.txt from the packages instead of comparing with it",
    )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what asks another program."""
    for item in items:
        if _ORACLES & set(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.oracle)


def _import_or_skip(name: str) -> ModuleType:
    # Wheels of programs with a window load system libraries; where one is missing, the import raises OSError or a
    # plain ImportError, which pytest.importorskip does not take as a missing module.
    try:
        return importlib.import_module(name)
    except (ImportError, OSError) as error:
        pytest.skip(f"{name} cannot be imported here: {error}")


@pytest.fixture(scope="session")
def gmsh_module() -> ModuleType:
    """The module gmsh, not initialised; skips where it cannot be imported."""
    return _import_or_skip("gmsh")


@pytest.fixture(scope="session")
def vtk_module() -> ModuleType:
    """The package vtkmodules with its data model and XML readers; skips where they cannot be imported."""
    for part in ("vtkCommonDataModel", "vtkIOXML"):
        _import_or_skip(f"vtkmodules.{part}")
    return _import_or_skip("vtkmodules")
