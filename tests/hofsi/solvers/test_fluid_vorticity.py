"""Vorticity at nodes and places."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock.locate import Location, locate
from hofsi.solvers.fluid_vorticity import FluidVorticity, vorticity_at


def test_vorticity_of_a_polynomial_is_exact(flows):
    mesh = flows.grid(3)
    x, y = mesh.points.T
    velocity = np.stack([x * y**2, x**3 - y], axis=-1)
    exact = 3.0 * x**2 - 2.0 * x * y
    np.testing.assert_allclose(FluidVorticity(mesh).at_nodes(mesh.points, velocity), exact, atol=1e-12)
    found = vorticity_at(mesh, locate(mesh, (0.3, 0.7)), velocity)
    assert found == pytest.approx(3.0 * 0.09 - 2.0 * 0.21, abs=1e-12)


@pytest.mark.parametrize("order", [3, 5])
def test_vorticity_on_curved_elements_converges_at_their_order(flows, order):
    def error(rings):
        mesh = flows.annulus(order, sectors=6, rings=rings, count=rings)
        x, y = mesh.points.T
        velocity = np.stack([np.sin(y) * x, np.exp(x)], axis=-1)
        found = FluidVorticity(mesh).at_nodes(mesh.points, velocity)
        return np.abs(found - np.exp(x) + np.cos(y) * x).max()

    assert error(4) < error(2) / 2.0 ** (order - 0.6)


def test_the_mesh_may_have_moved(flows):
    mesh = flows.grid(2)
    moved = mesh.points @ flows.rotation(0.4).T + [2.0, 0.0]
    velocity = np.stack([-moved[:, 1], moved[:, 0]], axis=-1)
    np.testing.assert_allclose(FluidVorticity(mesh).at_nodes(moved, velocity), 2.0, atol=1e-12)


def test_where_elements_meet_each_has_its_own_and_a_node_the_mean(flows):
    mesh = flows.rectangle(2, 2, 1)
    velocity = np.stack([np.zeros(len(mesh.points)), np.abs(mesh.points[:, 0] - 0.5)], axis=-1)
    left, right = (vorticity_at(mesh, Location(e, xi, 0.3), velocity) for e, xi in ((0, 1.0), (1, -1.0)))
    assert (left, right) == pytest.approx((-1.0, 1.0), abs=1e-13)
    node = int(np.argmin(np.hypot(*(mesh.points - [0.5, 0.5]).T)))
    assert FluidVorticity(mesh).at_nodes(mesh.points, velocity)[node] == pytest.approx(0.0, abs=1e-13)
