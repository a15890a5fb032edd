"""IMVJ: the dense formula, linear problems, reuse, compression."""

import numpy as np
import pytest

from hofsi.coupling.multi_vector import MultiVector


def problem(size, seed):
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(size, size))
    A *= 3.0 / np.abs(np.linalg.eigvals(A)).max()  # plain iteration diverges
    b = rng.normal(size=size)
    return A, b, np.linalg.solve(np.eye(size) - A, b)


def iterations(accelerator, A, b, exact, limit=50):
    """Evaluations of d̃ after the first until the iterate is exact."""
    accelerator.begin_step()
    d = np.zeros(len(b))
    for count in range(limit):
        if np.linalg.norm(d - exact) <= 1e-9 * np.linalg.norm(exact):
            accelerator.end_step()
            return count
        d = accelerator.next(d, A @ d + b - d)
    raise AssertionError("not converged")


@pytest.mark.parametrize("size", [1, 4, 9])
def test_a_linear_problem_takes_one_iteration_more_than_its_size_and_the_next_step_one(size):
    A, b, exact = problem(size, 31)
    accelerator = MultiVector(10, 0.0, 0.5)
    assert iterations(accelerator, A, b, exact) == size + 1
    assert accelerator.rank == size
    other = np.random.default_rng(32).normal(size=size)
    assert iterations(accelerator, A, other, np.linalg.solve(np.eye(size) - A, other)) <= 2


def dense_update(J, V, W):
    """Bogaers et al. 2014, Eq. (27), with the matrix that is never formed here."""
    return J + (W - J @ V) @ np.linalg.solve(V.T @ V, V.T)


def test_iterates_are_those_of_the_dense_formula():
    """Three steps with three Jacobians, on an interface with more unknowns than there are secants."""
    rng, size = np.random.default_rng(33), 24
    accelerator, J = MultiVector(10, 0.0, 0.5), np.zeros((size, size))
    for step in range(3):
        A, b = 0.2 * rng.normal(size=(size, size)), rng.normal(size=size)
        accelerator.begin_step()
        d, residuals, images = np.zeros(size), [], []
        for iteration in range(5):
            image = A @ d + b
            residuals.append(image - d)
            images.append(image)
            current = J
            if iteration:
                V, W = (np.diff(np.array(values), axis=0).T for values in (residuals, images))
                current = dense_update(J, V, W)
            first = step == iteration == 0
            expected = d + 0.5 * residuals[0] if first else image - current @ residuals[-1]
            d = accelerator.next(d, residuals[-1])
            np.testing.assert_allclose(d, expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())
        accelerator.end_step()
        J = current
    assert accelerator.rank == 12


def test_compression_keeps_the_jacobian_and_bounds_its_rank():
    """Jacobians that change from step to step, so that every step has secants of its own."""
    A, _, _ = problem(12, 34)
    plain, compressed = MultiVector(100, 1e-12, 0.5), MultiVector(2, 1e-12, 0.5)
    rng = np.random.default_rng(35)
    for _ in range(8):
        changed, load = A + 0.05 * rng.normal(size=A.shape), rng.normal(size=12)
        for accelerator in (plain, compressed):
            iterations(accelerator, changed, load, np.linalg.solve(np.eye(12) - changed, load))
    v = rng.normal(size=12)
    np.testing.assert_allclose(compressed._kept(v), plain._kept(v), atol=1e-6 * np.linalg.norm(plain._kept(v)))
    assert compressed.rank <= 12 < plain.rank


def test_small_singular_values_are_dropped():
    """J maps e_0 to e_1 and e_2 to a small multiple of e_3."""
    ranks = []
    for small in (1e-6, 1e-2):
        accelerator = MultiVector(1, 1e-3, 0.5)
        e = np.eye(4)
        accelerator.begin_step()
        residual, image = np.zeros(4), np.zeros(4)
        for v, w in ((0 * e[0], 0 * e[0]), (e[0], e[1]), (e[2], small * e[3])):
            residual, image = residual + v, image + w
            accelerator.next(image - residual, residual)
        accelerator.end_step()
        ranks.append(accelerator.rank)
    assert ranks == [1, 2]


def test_without_restart_steps_nothing_is_kept():
    A, b, exact = problem(6, 36)
    accelerator = MultiVector(0, 0.0, 0.5)
    first = iterations(accelerator, A, b, exact)
    assert accelerator.rank == 0
    assert iterations(accelerator, A, b, exact) == first == 7


def test_what_is_forgotten_does_not_help_later_steps():
    A, b, exact = problem(8, 37)
    accelerator = MultiVector(10, 0.0, 0.5)
    first = iterations(accelerator, A, b, exact)
    accelerator.forget()
    assert accelerator.rank == 0
    assert iterations(accelerator, A, b, exact) == first


def test_a_repeated_residual_makes_no_secant():
    accelerator = MultiVector(10, 1e-3, 0.5)
    accelerator.begin_step()
    d, r = np.zeros(2), np.array([1.0, 1.0])
    first = accelerator.next(d, r)
    np.testing.assert_array_equal(accelerator.next(d, r), first)
    accelerator.end_step()
    assert accelerator.rank == 0


def test_after_failures_the_first_iterate_is_nearer_until_a_step_converges():
    accelerator = MultiVector(5, 1e-3, 0.5)
    d, r, moved = np.zeros(2), np.array([1.0, -1.0]), []
    for _ in range(3):
        accelerator.begin_step()
        moved.append(accelerator.next(d, r)[0])
        accelerator.forget()
    accelerator.begin_step()
    accelerator.end_step()
    accelerator.begin_step()
    moved.append(accelerator.next(d, r)[0])
    np.testing.assert_allclose(moved, [0.5, 0.05, 0.005, 0.5])
