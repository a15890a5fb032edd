"""Fields given by values."""

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, LevelSet, nearest_on_level_set
from hoblock.errors import FieldError
from hoblock.fields import GridField, MeshField
from hoblock.generate import generate

LOW, HIGH = (-2.0, -2.1), (2.0, 1.9)


def phi(points):
    x, y = points.T
    return np.exp(x) * np.cos(y) + x**2 + 2.0 * y**2 - 3.0


def gradient(points):
    x, y = points.T
    return np.stack([np.exp(x) * np.cos(y) + 2.0 * x, -np.exp(x) * np.sin(y) + 4.0 * y], axis=-1)


def gridded(count, degree, function=phi):
    x, y = (np.linspace(low, high, count) for low, high in zip(LOW, HIGH, strict=True))
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    return GridField(x, y, function(points.reshape(-1, 2)).reshape(count, count), degree)


def bent_mesh(order, count=3):
    """A square with one round side."""
    vertices = np.array([LOW, (HIGH[0], LOW[1]), HIGH, (LOW[0], HIGH[1])])
    arc = Arc.through(vertices[0], np.array([0.0, LOW[1] - 0.4]), vertices[1])
    return generate(BlockStructure.build(vertices, [(0, 1, 2, 3)], counts=count, curves={(0, 1): arc}), order)


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
def test_splines_pass_through_the_values_and_are_exact_for_polynomials(degree, rng):
    def polynomial(points):
        x, y = points.T
        return (1.0 + x) ** degree - 0.3 * (y - 0.5) ** degree * x**degree

    field = gridded(13, degree, polynomial)
    nodes = np.stack(np.meshgrid(field.x, field.y, indexing="ij"), axis=-1).reshape(-1, 2)
    np.testing.assert_allclose(field(nodes), field.values.ravel(), rtol=1e-13, atol=1e-11)
    places = rng.uniform(LOW, HIGH, (50, 2))
    np.testing.assert_allclose(field(places), polynomial(places), rtol=1e-12, atol=1e-11)
    h = 1e-6
    steps = np.array([(h, 0.0), (0.0, h)])
    differences = np.stack([(field(places + d) - field(places - d)) / (2 * h) for d in steps], axis=-1)
    np.testing.assert_allclose(field.gradient(places), differences, rtol=1e-6, atol=1e-5)


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_isolines_of_gridded_values_reach_the_order_of_the_spline(degree):
    t = np.linspace(0.0, 1.0, 60)
    guesses = np.array([[1.0, 0.0], [0.0, 1.0]])
    exact = LevelSet(phi, *nearest_on_level_set(phi, guesses))
    errors = []
    for count in (21, 81):
        field = gridded(count, degree)
        points = LevelSet(field, *nearest_on_level_set(field, guesses))(t)
        errors.append(exact.distance(points).max())
    assert np.log(errors[0] / errors[1]) / np.log(4.0) > degree + 0.7


def test_grid_lines_may_be_uneven(rng):
    x, y = np.sort(rng.uniform(-1, 1, 30)), np.linspace(0, 3, 25) ** 2
    field = GridField(x, y, x[:, None] ** 3 - y[None, :] ** 2)
    places = np.stack([rng.uniform(x[0], x[-1], 40), rng.uniform(0, 9, 40)], axis=-1)
    np.testing.assert_allclose(field(places), places[:, 0] ** 3 - places[:, 1] ** 2, atol=1e-10)


def test_fields_keep_values_of_their_own():
    values = np.ones((4, 4))
    field = GridField(np.arange(4.0), np.arange(4.0), values)
    values[:] = 7.0
    np.testing.assert_allclose(field(np.array([[1.5, 1.5]])), 1.0)
    with pytest.raises(ValueError, match="read-only"):
        field.values[0, 0] = 2.0


def test_border_of_the_grid_belongs_to_it():
    field = gridded(9, 3)
    corners = np.array([LOW, HIGH]) * (1.0 + 1e-14)
    np.testing.assert_allclose(field(corners), phi(corners), rtol=1e-12)


@pytest.mark.parametrize("order", [1, 2, 5, 9])
def test_mesh_fields_of_the_coordinates_are_exact(order, rng):
    mesh = bent_mesh(order)
    places = rng.uniform(LOW, HIGH, (200, 2))
    field = MeshField(mesh, 3.0 * mesh.points[:, 0] - 2.0 * mesh.points[:, 1] + 1.0)
    np.testing.assert_allclose(field(places), 3.0 * places[:, 0] - 2.0 * places[:, 1] + 1.0, atol=1e-12)
    np.testing.assert_allclose(field.gradient(places), np.tile([3.0, -2.0], (200, 1)), atol=1e-10)


@pytest.mark.parametrize("order", [2, 3, 5])
def test_mesh_fields_converge_with_their_gradients(order, rng):
    places = rng.uniform(LOW, HIGH, (400, 2))
    errors = []
    for count in (4, 8):
        mesh = bent_mesh(order, count)
        field = MeshField(mesh, phi(mesh.points))
        errors.append((abs(field(places) - phi(places)).max(), abs(field.gradient(places) - gradient(places)).max()))
    values, slopes = np.log2(np.array(errors[0]) / errors[1])
    assert values > order + 0.4
    assert slopes > order - 0.4


def test_isolines_of_mesh_fields_lie_on_the_field():
    mesh = bent_mesh(6, 6)
    field = MeshField(mesh, phi(mesh.points))
    ends = nearest_on_level_set(field, np.array([[1.0, 0.0], [0.0, 1.0]]))
    curve = LevelSet(field, *ends)
    points = curve(np.linspace(0.0, 1.0, 80))
    np.testing.assert_allclose(field(points), 0.0, atol=1e-13)
    assert LevelSet(phi, *nearest_on_level_set(phi, ends)).distance(points).max() < 1e-6


def test_no_points_at_all():
    mesh = bent_mesh(2)
    for field in (gridded(5, 3), gridded(5, 1), MeshField(mesh, phi(mesh.points))):
        assert field(np.zeros((0, 2))).shape == (0,)
        assert field.gradient(np.zeros((0, 2))).shape == (0, 2)


LINES = np.arange(5.0)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: GridField(LINES, LINES, np.zeros((5, 5)), 6), "degree is 6; expected 1 to 5"),
        (lambda: GridField(LINES, LINES, np.zeros((5, 5)), 0), "degree is 0"),
        (lambda: GridField(LINES[:3], LINES, np.zeros((3, 5))), r"x has shape \(3,\); expected at least 4 grid lines"),
        (lambda: GridField(LINES, LINES[::-1], np.zeros((5, 5))), r"y\[0\] = 4 is followed by 3; .* ascending"),
        (lambda: GridField([0, 1, 1, 2], LINES, np.zeros((4, 5))), r"x\[1\] = 1 is followed by 1"),
        (lambda: GridField([0, 1, np.nan, 3], LINES, np.zeros((4, 5))), r"x\[1\] = 1 is followed by nan"),
        (lambda: GridField(LINES, LINES[:4], np.zeros((4, 5))), r"\(4, 5\); expected \(5, 4\), x first\. Transpose"),
        (lambda: GridField(LINES, LINES, np.zeros((5, 4))), r"shape \(5, 4\); expected \(5, 5\), x first\.$"),
        (lambda: GridField(LINES, LINES, np.diag([0, 0, np.inf, 0, 0])), r"at \(2, 2\) is inf; .* Fill the gap"),
        (lambda: gridded(5, 3)(np.array([[0, 0], [2.5, 0.1]])), r"\(2\.5, 0\.1\) is outside the grid .*\[-2, 2\] ×"),
        (lambda: gridded(5, 3).gradient(np.array([[np.nan, 0.0]])), r"\(nan, 0\) is outside the grid"),
        (lambda: MeshField(bent_mesh(2), np.zeros(3)), r"have shape \(3,\); expected \(49,\), one for each"),
        (lambda: MeshField(bent_mesh(1), np.full(16, np.nan)), "the value of node 0 is nan"),
        (lambda: MeshField(bent_mesh(1), np.zeros(16))(np.array([[0.0, 9.0]])), r"\(0, 9\) is outside the mesh with"),
    ],
)  # fmt: skip
def test_errors(make, match):
    with pytest.raises(FieldError, match=match):
        make()
