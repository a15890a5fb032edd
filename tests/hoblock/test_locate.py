"""Places in meshes."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc
from hoblock.errors import LocationError
from hoblock.generate import generate
from hoblock.grading import Exponential
from hoblock.locate import Location, Locator, find, interpolation_weights, locate, location_of_node
from hoblock.mesh import QuadMesh
from hoblock.reference import gauss_lobatto, tensor_basis


def ring(order: int, count: int = 3) -> QuadMesh:
    """A ring of four blocks between the circle of radius 1 and a square, graded towards the circle."""
    h = np.sqrt(0.5)
    vertices = {
        "a": (h, h),
        "b": (-h, h),
        "c": (-h, -h),
        "d": (h, -h),
        "A": (2.0, 2.0),
        "B": (-2.0, 2.0),
        "C": (-2.0, -2.0),
        "D": (2.0, -2.0),
    }
    pairs = [("a", "b"), ("b", "c"), ("c", "d"), ("d", "a")]
    blocks = {"ring": [(p, p.upper(), q.upper(), q) for p, q in pairs]}
    curves = {(p, q): Arc.from_center((0.0, 0.0), vertices[p], vertices[q]) for p, q in pairs}
    structure = BlockStructure.build(
        vertices, blocks, counts=count, curves=curves, gradings={(v, v.upper()): Exponential(1.5) for v in "abcd"}
    )
    return generate(structure, order)


def position(mesh: QuadMesh, location: Location) -> np.ndarray:
    return interpolation_weights(location, mesh.order) @ mesh.points[mesh.cells[location.element]]


@pytest.mark.parametrize("order", [1, 2, 4, 7])
def test_every_place_is_found_again(order: int) -> None:
    mesh = ring(order)
    rng = np.random.default_rng(7)
    xi = rng.uniform(-1.0, 1.0, (3, 2))
    for element in range(len(mesh.cells)):
        places = tensor_basis(gauss_lobatto(order), xi) @ mesh.points[mesh.cells[element]]
        for place, expected in zip(places, xi, strict=True):
            found = locate(mesh, tuple(place))
            assert found.element == element
            np.testing.assert_allclose((found.xi, found.eta), expected, atol=1e-9)


def test_interpolation_is_exact_for_the_mesh_itself() -> None:
    mesh = ring(5)
    for place in [(1.2, 0.4), (-1.7, 1.1), (0.3, -1.9)]:
        np.testing.assert_allclose(position(mesh, locate(mesh, place)), place, atol=1e-12)


def test_on_shared_faces_and_corners_the_lowest_element_wins() -> None:
    mesh = ring(3)
    shared = [node for node in np.unique(mesh.corners) if (mesh.corners == node).any(axis=1).sum() > 1]
    assert len(shared) > 10
    for node in shared:
        owners = np.flatnonzero((mesh.corners == node).any(axis=1))
        assert locate(mesh, tuple(mesh.points[node])).element == owners.min()
    middle = mesh.points[mesh.cells[4, 1 + 4 * 3]], mesh.points[mesh.cells[4, 2]]  # nodes inside sides
    for point in middle:
        owners = np.flatnonzero((np.hypot(*(mesh.coordinates - point).T) < 1e-12).any(axis=0))
        assert locate(mesh, tuple(point)).element == owners.min()


def test_points_on_an_approximated_circle_are_taken_to_the_boundary() -> None:
    mesh = ring(2, count=2)
    angle = 0.3
    inside = 0.999 * np.array([np.cos(angle), np.sin(angle)])  # in the hole, 0.001 off; elements are about 0.5 wide
    found = locate(mesh, tuple(inside))
    assert 0.0 < np.hypot(*(position(mesh, found) - inside)) < 0.01
    assert max(abs(found.xi), abs(found.eta)) == 1.0


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.9, 0.1), (5.0, 0.0), (2.1, 2.1)])
def test_places_outside_are_named_with_the_nearest_node(place: tuple[float, float]) -> None:
    mesh = ring(4)
    assert find(mesh, place) is None
    with pytest.raises(LocationError, match=r"outside the ring; expected a place inside\. The nearest node is"):
        locate(mesh, place, of="the ring")


def test_places_are_followed_through_a_moving_mesh() -> None:
    mesh = ring(4)
    place = (1.3, 0.2)
    last = locate(mesh, place)
    visited = {last.element}
    for angle in np.linspace(0.0, 1.5, 40):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        moved = mesh.with_points(mesh.points @ turn)
        found = find(moved, place, last)
        assert found is not None
        np.testing.assert_allclose(position(moved, found), place, atol=1e-10)
        visited.add(found.element)
        last = found
    assert len(visited) > 1


@pytest.mark.parametrize("order", [1, 4])
def test_on_a_face_the_answer_does_not_depend_on_where_the_place_was(order: int) -> None:
    mesh = ring(order, count=3)
    X = mesh.coordinates
    face = X[:, order + (order + 1) * (order // 2)]  # a node on side 1 of every element
    for place in face:
        expected = locate(mesh, tuple(place))
        around = np.flatnonzero(np.abs(X - place).max(axis=2).min(axis=1) < 1e-12)
        assert expected.element == around.min()
        for element in around:
            assert find(mesh, tuple(place), Location(int(element), 0.1, -0.2)) == expected


def test_a_place_that_the_mesh_has_left_is_not_found() -> None:
    mesh = ring(3)
    last = locate(mesh, (1.3, 0.2))
    assert find(mesh.with_points(mesh.points + np.array([1.0, 0.0])), (1.3, 0.2), last) is None


def test_tiny_elements_far_from_the_origin_are_inverted() -> None:
    mesh = ring(4)
    far = mesh.with_points(1e-4 * mesh.points + 1e3)
    target = 1e-4 * np.array([1.3, 0.2]) + 1e3
    found = locate(far, tuple(target))
    same = locate(mesh, (1.3, 0.2))
    np.testing.assert_allclose((found.xi, found.eta), (same.xi, same.eta), atol=1e-6)


def test_corner_nodes_have_a_location() -> None:
    mesh = ring(3)
    for node in np.unique(mesh.corners):
        location = location_of_node(mesh, int(node))
        np.testing.assert_allclose(position(mesh, location), mesh.points[node], atol=1e-14)
    inner = int(mesh.cells[0, 5])
    with pytest.raises(ValueError, match=f"node {inner} is not a corner"):
        location_of_node(mesh, inner)


@pytest.mark.parametrize("order", [1, 3, 6])
def test_many_places_are_found_at_once(order: int) -> None:
    mesh = ring(order, count=4)
    rng = np.random.default_rng(7302)
    elements = rng.integers(len(mesh.cells), size=6000)
    xi = rng.uniform(-1.0, 1.0, (len(elements), 2))
    X = mesh.points[mesh.cells[elements]]
    places = np.einsum("km,kmd->kd", tensor_basis(gauss_lobatto(order), xi), X)
    found = Locator(mesh).find(places)
    assert found.found.all()
    np.testing.assert_array_equal(found.elements, elements)
    np.testing.assert_allclose(found.xi, xi, atol=1e-9)


def test_one_place_and_many_are_found_alike() -> None:
    mesh = ring(4)
    places = np.random.default_rng(7303).uniform(-2.3, 2.3, (200, 2))
    found = Locator(mesh).find(places)
    assert len(found) == 200
    assert 0 < found.found.sum() < 200
    assert np.isnan(found.xi[~found.found]).all()
    for k, place in enumerate(places):
        assert found[k] == find(mesh, tuple(place))


def test_no_place_at_all_is_found_nowhere() -> None:
    assert len(Locator(ring(2)).find(np.zeros((0, 2)))) == 0


def test_element_of_thin_layers_is_found() -> None:
    x, y = np.linspace(0.0, 1.0, 3), np.array([0.0, 1e-7, 1e-3, 1.0])
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    cells = np.array([(k, k + 1, k + 3, k + 4) for row in range(3) for k in (3 * row, 3 * row + 1)])
    found = Locator(QuadMesh(points, cells, 1, {}, {})).find(np.array([[0.7, 5e-8], [0.2, 6e-4], [0.9, 0.5]]))
    assert found.elements.tolist() == [1, 2, 5]
