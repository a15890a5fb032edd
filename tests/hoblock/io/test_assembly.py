import numpy as np
import pytest

from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.assembly import assembled, directed_sides
from hoblock.quality import det_jacobian
from hoblock.reference import equispaced, gauss_lobatto, tensor_quadrature


def test_sides_run_around_their_element(layouts, rng):
    mesh = generate(layouts.random("disc", rng), 3)
    every = np.stack(np.divmod(np.arange(4 * len(mesh.cells)), 4), axis=-1)
    x = mesh.points[directed_sides(mesh, every)].reshape(len(mesh.cells), 4, 4, 2)
    np.testing.assert_array_equal(x[:, :, -1], np.roll(x[:, :, 0], -1, axis=1))


@pytest.mark.parametrize("order", [1, 2, 5])
def test_any_rotation_and_reflection_of_elements(order, layouts, rng):
    mesh = generate(layouts.annulus(4, counts=2), order)
    cells = mesh.cells.reshape(-1, order + 1, order + 1).copy()
    for k in range(len(cells)):
        turned = np.rot90(cells[k], rng.integers(4))
        cells[k] = turned.T if rng.random() < 0.5 else turned
    ends = {name: directed_sides(mesh, sides)[:, [0, -1]] for name, sides in mesh.edge_groups.items()}
    again = assembled("f", mesh.points, cells.reshape(mesh.cells.shape), order, gauss_lobatto(order), lines=ends)
    where, weights = tensor_quadrature(order + 1)
    np.testing.assert_allclose(det_jacobian(again, where) @ weights, det_jacobian(mesh, where) @ weights, rtol=1e-12)
    for name in ends:
        np.testing.assert_array_equal(again.edge_nodes(name), mesh.edge_nodes(name))


def test_a_line_inside_belongs_to_the_element_on_its_left(layouts):
    mesh = generate(layouts.square(counts=2), 2)
    for side in ([0, 1], [1, 3]):
        ends = directed_sides(mesh, np.array([side]))[:, [0, -1]]
        again = assembled("f", mesh.points, mesh.cells.copy(), 2, gauss_lobatto(2), lines={"cut": ends})
        assert again.edge_groups["cut"].tolist() == [side]


def test_unused_nodes_are_left_out(layouts):
    mesh = generate(layouts.square(), 3)
    points = np.concatenate([np.full((4, 2), np.nan), mesh.points])
    again = assembled("f", points, mesh.cells + 4, 3, equispaced(3))
    assert len(again.points) == 16
    assert again.cells.tolist() == mesh.cells.tolist()


def test_nothing_to_assemble():
    with pytest.raises(MeshFileError, match="f: there are no quadrilaterals; expected at least one"):
        assembled("f", np.zeros((4, 2)), np.zeros((0, 4), dtype=np.int64), 1, gauss_lobatto(1))
