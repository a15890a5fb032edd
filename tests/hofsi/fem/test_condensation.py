from __future__ import annotations

import numpy as np
import pytest

from hofsi.errors import LinearSolverError
from hofsi.fem.assembly import assemble_vector
from hofsi.fem.condensation import CondensedSystem
from hofsi.fem.constraints import DirectedNodes, NodeConstraints
from hofsi.fem.element import boundary_first

ANGLE = 0.7
NORMAL = np.array([np.cos(ANGLE), np.sin(ANGLE)])


def numbering(mesh):
    local, on_boundary = boundary_first(mesh.order)
    return (2 * mesh.cells[:, local][:, :, None] + np.arange(2)).reshape(len(mesh.cells), -1), 2 * on_boundary


def element_matrices(dofs, rng):
    A = rng.standard_normal((*dofs.shape, dofs.shape[1]))
    return A + 2.0 * dofs.shape[1] * np.eye(dofs.shape[1])


def supports(mesh, rolling):
    left, top = mesh.edge_nodes("left"), mesh.edge_nodes("top")
    entries = [DirectedNodes.component(left, axis) for axis in range(2)]
    if rolling:
        entries.append(DirectedNodes(top, np.tile(NORMAL, (len(top), 1))))
    return NodeConstraints(len(mesh.points), entries)


def full_solution(dofs, A, r, size, constraints, pinned=()):
    """Dense solution of the assembled system in the nodes' own frames."""
    K = np.zeros((size, size))
    for numbers, block in zip(dofs, A, strict=True):
        K[np.ix_(numbers, numbers)] += block
    R = np.eye(size)
    for node in constraints.rotated:
        R[2 * node : 2 * node + 2, 2 * node : 2 * node + 2] = constraints.frames[node]
    free = np.ones(size, dtype=bool)
    free[: constraints.fixed.size] = ~constraints.fixed.ravel()
    free[list(pinned)] = False
    own = np.zeros(size)
    own[free] = np.linalg.solve((R.T @ K @ R)[np.ix_(free, free)], (R.T @ assemble_vector(dofs, r, size))[free])
    return R @ own


@pytest.mark.parametrize("order", [1, 2, 4])
@pytest.mark.parametrize("rolling", [False, True])
def test_condensed_solution_is_that_of_the_full_system(distorted, order, rolling):
    rng = np.random.default_rng(17)
    mesh = distorted(order)
    dofs, boundary = numbering(mesh)
    size = 2 * len(mesh.points)
    constraints = supports(mesh, rolling)
    A, r = element_matrices(dofs, rng), rng.standard_normal(dofs.shape)
    given = r.copy()
    x = CondensedSystem(dofs, boundary, size, constraints).factorise(A).solve(r)
    np.testing.assert_allclose(x, full_solution(dofs, A, r, size, constraints), atol=1e-12)
    np.testing.assert_array_equal(r, given)
    if rolling:
        only_rolling = np.setdiff1d(mesh.edge_nodes("top"), mesh.edge_nodes("left"))
        np.testing.assert_allclose(x.reshape(-1, 2)[only_rolling] @ NORMAL, 0.0, atol=1e-15)


@pytest.mark.parametrize("order", [1, 2, 4])
@pytest.mark.parametrize("rolling", [False, True])
def test_what_a_solution_leaves_of_each_element(distorted, order, rolling):
    rng = np.random.default_rng(43)
    mesh = distorted(order)
    dofs, boundary = numbering(mesh)
    A, r = element_matrices(dofs, rng), rng.standard_normal(dofs.shape)
    system = CondensedSystem(dofs, boundary, 2 * len(mesh.points), supports(mesh, rolling))
    x, left = system.factorise(A).solve_and_balance(r)
    np.testing.assert_array_equal(x, system.factorise(A).solve(r))
    np.testing.assert_allclose(left, r - (A @ x[dofs][:, :, None])[:, :, 0], rtol=0.0, atol=1e-12)


def test_pinned_unknowns_beyond_the_vector_field(distorted):
    rng = np.random.default_rng(18)
    mesh = distorted(2)
    dofs, boundary = numbering(mesh)
    size = 2 * len(mesh.points)
    corner = size + mesh.cells[:, [0]]  # a scalar with one unknown an element, on its boundary
    dofs = np.concatenate([dofs[:, :boundary], corner, dofs[:, boundary:]], axis=1)
    constraints = supports(mesh, True)
    A, r = element_matrices(dofs, rng), rng.standard_normal(dofs.shape)
    numbers = np.unique(corner)
    unused = np.setdiff1d(np.arange(size, size + len(mesh.points)), numbers)
    total, pinned = size + len(mesh.points), (int(numbers[1]),)
    x = CondensedSystem(dofs, boundary + 1, total, constraints, pinned).factorise(A).solve(r)
    np.testing.assert_allclose(x, full_solution(dofs, A, r, total, constraints, (*pinned, *unused)), atol=1e-12)
    assert x[pinned[0]] == 0.0


def test_matrix_is_the_schur_complement(distorted):
    rng = np.random.default_rng(19)
    mesh = distorted(3, 1, 1)
    dofs, boundary = numbering(mesh)
    A = element_matrices(dofs, rng)
    system = CondensedSystem(dofs, boundary, 2 * len(mesh.points), NodeConstraints(len(mesh.points), []))
    a, inner = A[0], slice(boundary, None)
    schur = a[:boundary, :boundary] - a[:boundary, inner] @ np.linalg.solve(a[inner, inner], a[inner, :boundary])
    order = np.argsort(np.argsort(dofs[0, :boundary]))
    np.testing.assert_allclose(system.matrix(A).toarray()[np.ix_(order, order)], schur, atol=1e-12)


def test_everything_held_leaves_the_inner_unknowns(distorted):
    rng = np.random.default_rng(20)
    mesh = distorted(3, 1, 1)
    dofs, boundary = numbering(mesh)
    nodes = np.unique(dofs[:, :boundary] // 2)
    constraints = NodeConstraints(len(mesh.points), [DirectedNodes.component(nodes, axis) for axis in range(2)])
    A, r = element_matrices(dofs, rng), rng.standard_normal(dofs.shape)
    x = CondensedSystem(dofs, boundary, 2 * len(mesh.points), constraints).factorise(A).solve(r)
    np.testing.assert_allclose(x, full_solution(dofs, A, r, x.size, constraints), atol=1e-12)


def test_singular_inner_block_is_reported(distorted):
    mesh = distorted(2)
    dofs, boundary = numbering(mesh)
    A = np.zeros((*dofs.shape, dofs.shape[1]))
    system = CondensedSystem(dofs, boundary, 2 * len(mesh.points), supports(mesh, False))
    with pytest.raises(LinearSolverError, match="inner unknowns is singular"):
        system.factorise(A)


@pytest.mark.parametrize("order", [1, 2, 4])
def test_a_border_responds_as_the_full_matrix_says(distorted, order):
    rng = np.random.default_rng(19)
    mesh = distorted(order)
    dofs, boundary = numbering(mesh)
    size = 2 * len(mesh.points)
    constraints = supports(mesh, rolling=True)
    nodes = mesh.edge_nodes("left")[1:-1]  # not where the roller turns the frame
    border = (2 * nodes[:, None] + np.arange(2)).ravel()
    A, r = element_matrices(dofs, rng), rng.standard_normal(dofs.shape)
    places = mesh.points[mesh.cells].mean(axis=1)
    system = CondensedSystem(dofs, boundary, size, constraints, places=places, border=border)
    factor = system.factorise_with_border(A)
    np.testing.assert_allclose(factor.solve(r), system.factorise(A).solve(r), atol=1e-12)
    K = np.zeros((size, size))
    for numbers, block in zip(dofs, A, strict=True):
        K[np.ix_(numbers, numbers)] += block
    given = rng.standard_normal(len(border))
    x = factor.extended(given)
    np.testing.assert_array_equal(x[border], given)
    held = np.setdiff1d(np.flatnonzero(constraints.fixed.ravel()), border)
    free = np.setdiff1d(np.arange(size), np.append(held, border))
    frames = constraints.frames
    balance = (frames.transpose(0, 2, 1) @ (K @ x).reshape(-1, 2, 1)).ravel()
    np.testing.assert_allclose(balance[free], 0.0, atol=1e-11)
    np.testing.assert_allclose((K @ x)[border], factor.border_response @ given, atol=1e-11)


def test_a_border_takes_a_factorisation_that_keeps_it(distorted):
    mesh = distorted(2)
    dofs, boundary = numbering(mesh)
    constraints = supports(mesh, rolling=False)
    nodes = mesh.edge_nodes("left")
    border = (2 * nodes[:, None] + np.arange(2)).ravel()
    A = element_matrices(dofs, np.random.default_rng(23))
    places = mesh.points[mesh.cells].mean(axis=1)
    system = CondensedSystem(dofs, boundary, 2 * len(mesh.points), constraints, places=places, border=border)
    assert system.factorise(A).border_response is None
    assert system.factorise_with_border(A).border_response.shape == (len(border), len(border))
    without = CondensedSystem(dofs, boundary, 2 * len(mesh.points), constraints, border=border)
    assert without.factorise_with_border(A).border_response is None  # SuperLU


@pytest.mark.parametrize("with_places", [False, True])
def test_flexibility_is_a_part_of_the_inverse(distorted, with_places):
    rng = np.random.default_rng(29)
    mesh = distorted(3)
    dofs, boundary = numbering(mesh)
    size = 2 * len(mesh.points)
    constraints = supports(mesh, rolling=False)
    places = mesh.points[mesh.cells].mean(axis=1) if with_places else None
    system = CondensedSystem(dofs, boundary, size, constraints, places=places)
    A = element_matrices(dofs, rng)
    nodes = rng.permutation(np.unique(np.concatenate([mesh.edge_nodes("left"), mesh.edge_nodes("top")])))
    unknowns = (2 * nodes[:, None] + np.arange(2)).ravel()
    assert system.tells_flexibility(unknowns)
    K = np.zeros((size, size))
    for numbers, block in zip(dofs, A, strict=True):
        K[np.ix_(numbers, numbers)] += block
    free = ~constraints.fixed.ravel()
    inverse = np.zeros_like(K)
    inverse[np.ix_(free, free)] = np.linalg.inv(K[np.ix_(free, free)])
    found = system.factorise(A).flexibility(unknowns)
    np.testing.assert_allclose(found, inverse[np.ix_(unknowns, unknowns)], rtol=0.0, atol=1e-11 * np.abs(found).max())
    assert not found[constraints.fixed.ravel()[unknowns]].any()


def test_nodes_with_frames_of_their_own_do_not_tell_their_flexibility(distorted):
    mesh = distorted(2)
    dofs, boundary = numbering(mesh)
    system = CondensedSystem(dofs, boundary, 2 * len(mesh.points), supports(mesh, rolling=True))
    assert not system.tells_flexibility(2 * mesh.edge_nodes("top"))
    assert system.tells_flexibility(2 * mesh.edge_nodes("left")[1:-1])
