"""Where bending a straight mesh fails and blocks do not: the thin, graded quarter annulus, in Gmsh and in hoblock."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from hoblock.quality import certify, element_areas, scaled_jacobian

PEERS = Path(__file__).resolve().parents[2] / "benchmarks" / "peers"
pytestmark = pytest.mark.verification


@pytest.fixture
def annulus(gmsh_module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(PEERS.parent))
    monkeypatch.syspath_prepend(str(PEERS))
    return importlib.import_module("gmsh_annulus")


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("progression", [1.0, 1.3])
def test_gmsh_makes_invalid_elements_and_blocks_do_not(order: int, progression: float, annulus: ModuleType) -> None:
    theirs, _ = annulus.by_gmsh(order, progression)
    ours, their_opinion = annulus.by_hoblock(order, progression)
    assert len(theirs.cells) == len(ours.cells) == 16
    assert certify(theirs).counts["invalid"] == 2
    assert certify(ours).valid
    assert scaled_jacobian(ours).min() >= 0.99
    assert their_opinion.min() >= 0.95
    # The same region: both areas are that of the ring, as far as the order resolves it.
    areas = [element_areas(mesh).sum() for mesh in (theirs, ours)]
    np.testing.assert_allclose(areas, np.pi / 4 * (1.6**2 - 1.0), rtol=2e-3 if order == 2 else 1e-5)
