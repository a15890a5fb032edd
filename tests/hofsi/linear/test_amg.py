from __future__ import annotations

import sys

import numpy as np
import pytest
import scipy.sparse as sp

from hoblock.errors import MissingExtraError
from hofsi.errors import LinearSolverError
from hofsi.linear.amg import Coarsening, PatchMultigrid
from hofsi.linear.extra import pyamg_module
from hofsi.linear.krylov import flexible_gmres


@pytest.fixture
def pyamg():
    return pytest.importorskip("pyamg")


def line(m):
    """Interpolation from every second of 2 m + 1 points to all but the two ends, and patches of three points."""
    fine, coarse = 2 * m - 1, m - 1
    P = np.zeros((fine, coarse))
    patches = np.zeros((coarse, fine))
    for k in range(coarse):
        P[2 * k : 2 * k + 3, k] = 0.5, 1.0, 0.5
        patches[k, 2 * k : 2 * k + 3] = 1.0
    return sp.csr_matrix(P), sp.csr_matrix(patches)


def coarsening(m):
    P, patches = line(m)
    square = sp.kron(P, P, format="csr")
    return Coarsening(square, sp.kron(patches, patches, format="csr"), np.ones((square.shape[1], 1)))


def operator(m, wind=0.0):
    """Diffusion and convection on (2 m - 1)² points, by differences against the wind."""
    n = 2 * m - 1
    second = sp.diags_array([-np.ones(n - 1), 2.0 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1])
    upwind = sp.diags_array([-np.ones(n - 1), np.ones(n)], offsets=[-1, 0])
    eye = sp.eye_array(n)
    return sp.csr_matrix(sp.kron(second + wind * upwind, eye) + sp.kron(eye, second))


@pytest.mark.usefixtures("pyamg")
def test_symmetric_cycle_is_a_symmetric_definite_operator():
    multigrid = PatchMultigrid(operator(4), coarsening(4), symmetric=True)
    M = np.stack([multigrid.solve(column) for column in np.eye(49)])
    np.testing.assert_allclose(M, M.T, atol=1e-14)
    assert np.linalg.eigvalsh((M + M.T) / 2.0).min() > 0.0


@pytest.mark.parametrize(("wind", "symmetric"), [(0.0, True), (30.0, False)])
@pytest.mark.usefixtures("pyamg")
def test_iterations_do_not_grow_with_the_grid(wind, symmetric):
    counts = []
    for m in (6, 12, 40):  # the last has a coarse level of its own below order 1
        A = operator(m, wind)
        x = np.random.default_rng(61).standard_normal(A.shape[0])
        multigrid = PatchMultigrid(A, coarsening(m), symmetric=symmetric)
        found, iterations = flexible_gmres(A.__matmul__, multigrid.solve, A @ x, 1e-9)
        np.testing.assert_allclose(found, x, rtol=0.0, atol=1e-6)
        counts.append(iterations)
    assert max(counts) <= 15


@pytest.mark.usefixtures("pyamg")
def test_same_hierarchy_every_time():
    b = np.random.default_rng(29).standard_normal(79 * 79)
    first, second = (PatchMultigrid(operator(40, 4.0), coarsening(40), symmetric=False).solve(b) for _ in range(2))
    np.testing.assert_array_equal(first, second)


@pytest.mark.usefixtures("pyamg")
def test_without_coarse_unknowns_the_patches_remain():
    A = operator(2)
    everything = Coarsening(sp.csr_matrix((9, 0)), sp.csr_matrix(np.ones((1, 9))), np.ones((0, 1)))
    x = np.arange(9.0)
    np.testing.assert_allclose(PatchMultigrid(A, everything, symmetric=True).solve(A @ x), x, atol=1e-13)


@pytest.mark.usefixtures("pyamg")
def test_singular_patch_is_reported():
    A = sp.csr_matrix(np.zeros((49, 49)) + np.ones((49, 49)))
    with pytest.raises(LinearSolverError, match=r"patch of 9 unknowns is singular.*linear\.solver"):
        PatchMultigrid(A, coarsening(4), symmetric=True)


def test_missing_pyamg_names_the_extra(monkeypatch):
    for name in ("pyamg", "pyamg.krylov"):
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(MissingExtraError, match=r"pip install 'hofsi-coupler\[amg\]'"):
            pyamg_module(name)
