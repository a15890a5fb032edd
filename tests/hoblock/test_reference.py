import numpy as np
import pytest
from numpy.polynomial import legendre

from hoblock.reference import (
    bernstein_from_legendre,
    differentiation_matrix,
    equispaced,
    gauss_legendre,
    gauss_lobatto,
    lagrange,
    lagrange_derivative,
    legendre_from_gauss,
    tensor_basis,
    tensor_gradient,
    tensor_quadrature,
)

ORDERS = range(1, 13)


@pytest.mark.parametrize(
    ("order", "inner"),
    [
        (1, []),
        (2, [0.0]),
        (3, [np.sqrt(1 / 5)]),
        (4, [0.0, np.sqrt(3 / 7)]),
        (5, [np.sqrt(1 / 3 - 2 * np.sqrt(7) / 21), np.sqrt(1 / 3 + 2 * np.sqrt(7) / 21)]),
        (6, [0.0, np.sqrt(5 / 11 - 2 / 11 * np.sqrt(5 / 3)), np.sqrt(5 / 11 + 2 / 11 * np.sqrt(5 / 3))]),
    ],
)
def test_gauss_lobatto_has_the_known_closed_forms(order, inner):
    expected = np.unique(np.concatenate([[-1.0, 1.0], inner, np.negative(inner) + 0.0]))
    np.testing.assert_allclose(gauss_lobatto(order), expected, rtol=0, atol=2e-16)


@pytest.mark.parametrize("order", [7, 11, 16, 25])
def test_gauss_lobatto_rule_is_exact_to_degree_2p_minus_1_and_no_further(order):
    x = gauss_lobatto(order)
    weights = 2.0 / (order * (order + 1) * legendre.legval(x, [0.0] * order + [1.0]) ** 2)
    for degree in range(0, 2 * order, 2):
        assert weights @ x**degree == pytest.approx(2.0 / (degree + 1), rel=1e-12)
    exact = 2.0 / (2 * order + 1)
    # The error at degree 2p is that of P_p², which the rule integrates to 2/p instead of 2/(2p + 1).
    P = legendre.legval(x, [0.0] * order + [1.0])
    assert weights @ P**2 == pytest.approx(2.0 / order, rel=1e-11)
    assert abs(weights @ P**2 - exact) > 0.5 * exact


@pytest.mark.parametrize("order", ORDERS)
def test_nodes_are_ascending_symmetric_and_read_only(order):
    for nodes in (gauss_lobatto(order), equispaced(order)):
        assert nodes.shape == (order + 1,)
        assert np.all(np.diff(nodes) > 0)
        assert np.array_equal(nodes, -nodes[::-1])
        assert (nodes[0], nodes[-1]) == (-1.0, 1.0)
        with pytest.raises(ValueError, match="read-only"):
            nodes[0] = 0.0


@pytest.mark.parametrize("function", [gauss_lobatto, equispaced])
def test_order_zero_is_refused(function):
    with pytest.raises(ValueError, match="order is 0; expected an integer >= 1"):
        function(0)


@pytest.mark.parametrize("count", [1, 2, 5, 9])
def test_gauss_legendre_is_exact_to_degree_2n_minus_1_and_no_further(count):
    x, w = gauss_legendre(count)
    for degree in range(2 * count):
        assert w @ x**degree == pytest.approx((1 + (-1) ** degree) / (degree + 1), abs=1e-14)
    assert abs(w @ x ** (2 * count) - 2 / (2 * count + 1)) > 1e-7


def test_tensor_quadrature_integrates_monomials_of_the_square():
    points, weights = tensor_quadrature(3)
    for a in range(6):
        for b in range(6):
            exact = (1 + (-1) ** a) / (a + 1) * (1 + (-1) ** b) / (b + 1)
            assert weights @ (points[:, 0] ** a * points[:, 1] ** b) == pytest.approx(exact, abs=1e-14)
    assert points[1, 0] > points[0, 0]  # ξ fastest
    assert points[1, 1] == points[0, 1]


@pytest.mark.parametrize("order", ORDERS)
def test_lagrange_reproduces_polynomials_and_their_derivatives(order, rng):
    nodes = gauss_lobatto(order)
    coefficients = rng.standard_normal(order + 1)
    x = rng.uniform(-1, 1, 30)
    values = lagrange(nodes, x) @ np.polyval(coefficients, nodes)
    np.testing.assert_allclose(values, np.polyval(coefficients, x), rtol=0, atol=1e-12)
    slopes = np.polyval(np.polyder(coefficients), x)
    np.testing.assert_allclose(lagrange_derivative(nodes, x) @ np.polyval(coefficients, nodes), slopes, atol=1e-11)
    at_nodes = differentiation_matrix(nodes) @ np.polyval(coefficients, nodes)
    np.testing.assert_allclose(at_nodes, np.polyval(np.polyder(coefficients), nodes), atol=1e-11)


def test_lagrange_is_exactly_the_identity_at_its_nodes():
    nodes = gauss_lobatto(9)
    assert np.array_equal(lagrange(nodes, nodes), np.eye(10))
    assert np.array_equal(lagrange(nodes, nodes[3]), np.eye(10)[3:4])


def test_lagrange_is_stable_next_to_a_node():
    nodes = gauss_lobatto(6)
    close = lagrange(nodes, np.nextafter(nodes, 2.0))
    np.testing.assert_allclose(close, np.eye(7), atol=1e-13)


@pytest.mark.parametrize("order", [1, 2, 5, 11, 15])
def test_bernstein_coefficients_of_known_polynomials(order):
    x, _ = gauss_legendre(order + 1)
    t = (x + 1) / 2
    B = bernstein_from_legendre(order) @ legendre_from_gauss(order + 1)
    np.testing.assert_allclose(B @ np.ones(order + 1), 1.0, atol=1e-10)
    np.testing.assert_allclose(B @ t, np.arange(order + 1) / order, atol=1e-10)
    last = np.zeros(order + 1)
    last[-1] = 1.0
    np.testing.assert_allclose(B @ t**order, last, atol=1e-10)


@pytest.mark.parametrize("order", [3, 9, 15])
def test_bernstein_coefficients_bracket_the_polynomial(order, rng):
    nodes, _ = gauss_legendre(order + 1)
    for _ in range(20):
        values = rng.standard_normal(order + 1)
        coefficients = bernstein_from_legendre(order) @ legendre_from_gauss(order + 1) @ values
        sampled = lagrange(nodes, np.linspace(-1, 1, 200)) @ values
        assert coefficients.min() <= sampled.min() + 1e-9
        assert coefficients.max() >= sampled.max() - 1e-9


@pytest.mark.parametrize("count", [2, 7, 40])
def test_legendre_coefficients_reproduce_a_polynomial(count, rng):
    nodes, _ = gauss_legendre(count)
    values = rng.standard_normal(count)
    np.testing.assert_allclose(legendre.legval(nodes, legendre_from_gauss(count) @ values), values, atol=1e-12 * count)


@pytest.mark.parametrize("order", [1, 2, 4])
def test_tensor_basis_counts_xi_fastest_and_differentiates_exactly(order, rng):
    nodes = gauss_lobatto(order)
    grid = np.stack(np.meshgrid(nodes, nodes, indexing="xy"), axis=-1).reshape(-1, 2)
    assert np.array_equal(tensor_basis(nodes, grid), np.eye((order + 1) ** 2))
    points = rng.uniform(-1, 1, (20, 2))
    f = 0.3 + grid[:, 0] ** order * grid[:, 1] - 2 * grid[:, 1] ** order
    x, y = points.T
    np.testing.assert_allclose(tensor_basis(nodes, points) @ f, 0.3 + x**order * y - 2 * y**order, atol=1e-13)
    gradient = np.einsum("kid,i->kd", tensor_gradient(nodes, points), f)
    exact = np.stack([order * x ** (order - 1) * y, x**order - 2 * order * y ** (order - 1)], axis=-1)
    np.testing.assert_allclose(gradient, exact, atol=1e-12)


@pytest.mark.parametrize("order", range(1, 17))
def test_a_basis_at_its_own_nodes_is_the_identity_without_warnings(order):
    """On any interval: the sum of the other barycentric terms may vanish there."""
    for nodes in (gauss_lobatto(order), 0.5 * (gauss_lobatto(order) + 1.0), np.linspace(0.0, 3.0, order + 1)):
        np.testing.assert_array_equal(lagrange(nodes, nodes), np.eye(order + 1))
