"""Element integrals of the fluid, against scikit-fem's assembly on the same curved mesh."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from hoblock import BlockStructure, generate
from hoblock.reference import differentiation_matrix, gauss_legendre, gauss_lobatto, lagrange
from hofsi.fem.element import element_table
from hofsi.fem.geometry import element_geometry, physical_gradients
from hofsi.kernels import navier_stokes as kernel
from hofsi.kernels import tensor_products

skfem = pytest.importorskip("skfem")
helpers = pytest.importorskip("skfem.helpers")
ddot, div, dot, grad, mul, sym_grad = (
    getattr(helpers, name) for name in ("ddot", "div", "dot", "grad", "mul", "sym_grad")
)

CORNERS_SIDES_CENTRE = [0, 2, 8, 6, 1, 5, 7, 3, 4]  # scikit-fem's order of the nine nodes in ours
COUNT = 4  # Gauss points in each direction, in both programs: 1/det J is not integrated exactly


class Peers:
    """The same nine-node elements and the same nodal field in both programs."""

    def __init__(self):
        vertices = {"a": (0, 0), "b": (2, 0.1), "c": (2.2, 1.1), "d": (-0.1, 0.9)}
        counts = {("a", "b"): 3, ("b", "c"): 2}
        structure = BlockStructure.build(vertices, {"fluid": [("a", "b", "c", "d")]}, counts=counts)
        mesh = generate(structure, 2)
        rng = np.random.default_rng(91)
        mesh = mesh.with_points(mesh.points + 0.03 * rng.uniform(-1.0, 1.0, mesh.points.shape))
        self.mesh, self.table = mesh, element_table(2, COUNT)
        self.geometry = element_geometry(mesh.points[mesh.cells], self.table)
        nodes, points = gauss_lobatto(2), gauss_legendre(COUNT)[0]
        values = lagrange(nodes, points)
        self.products = tensor_products.product_tables(values, values @ differentiation_matrix(nodes), np.arange(9))
        self.dNx, self.dNy = physical_gradients(self.geometry, self.table)
        self.u, self.a = rng.standard_normal((2, len(mesh.points), 2))
        peer = skfem.MeshQuad2(mesh.points.T, mesh.cells[:, CORNERS_SIDES_CENTRE].T)
        rule = skfem.quadrature.get_quadrature(skfem.ElementQuad2(), 2 * COUNT - 1)
        assert rule[1].size == COUNT**2
        self.velocity = skfem.Basis(peer, skfem.ElementVector(skfem.ElementQuad2()), quadrature=rule)
        self.pressure = skfem.Basis(peer, skfem.ElementQuad1(), quadrature=rule)
        self.our_of_velocity = self._interleaved(self.velocity)
        self.our_of_pressure = self._nearest(self.pressure.doflocs)

    def convection(self, density, a):
        c = kernel.convection(self.geometry.weights, self.geometry.J_inv, density, self.table.N @ a[self.mesh.cells])
        return tensor_products.transport(self.products, *c)

    def reaction(self, density, gradient):
        c = kernel.reaction(self.geometry.weights, density, gradient)
        return np.split(tensor_products.mass(self.products, c.reshape(-1, c.shape[-1])), 4)

    def _nearest(self, places):
        distance = np.hypot(*(self.mesh.points[:, :, None] - places[None]).transpose(1, 0, 2))
        assert distance.min(axis=0).max() < 1e-12
        return distance.argmin(axis=0)

    def _interleaved(self, basis):
        component = np.empty(basis.N, dtype=int)
        for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs):
            component[dofs] = np.arange(2)[:, None]
        return 2 * self._nearest(basis.doflocs) + component

    def theirs(self, form, test=None, trial=None, **fields):
        """Their matrix (dense) in our numbering, interleaved; ``trial`` may be the pressure's basis."""
        test, trial = test or self.velocity, trial or self.velocity
        theirs = {name: values.ravel()[self.our_of_velocity] for name, values in fields.items()}
        interpolated = {name: self.velocity.interpolate(values) for name, values in theirs.items()}
        matrix = skfem.BilinearForm(form).assemble(trial, test, **interpolated).toarray()
        return self._renumbered(self._renumbered(matrix, test).T, trial).T

    def _renumbered(self, rows, basis):
        if basis is self.velocity:
            result = np.zeros((2 * len(self.mesh.points), rows.shape[1]))
            result[self.our_of_velocity] = rows
        else:
            result = np.zeros((len(self.mesh.points), rows.shape[1]))
            result[self.our_of_pressure] = rows
        return result

    def ours(self, blocks):
        """Dense matrix of the blocks xx, xy, yx, yy (e, i, j), interleaved."""
        n, cells = len(self.mesh.points), self.mesh.cells
        total = np.zeros((n, 2, n, 2))
        for (a, b), block in zip(((0, 0), (0, 1), (1, 0), (1, 1)), blocks, strict=True):
            rows = np.broadcast_to(cells[:, :, None], block.shape)
            columns = np.broadcast_to(cells[:, None, :], block.shape)
            total[:, a, :, b] = sp.coo_matrix((block.ravel(), (rows.ravel(), columns.ravel())), (n, n)).toarray()
        return total.reshape(2 * n, 2 * n)

    def same(self, ours, theirs):
        scale = np.abs(theirs).max()
        assert scale > 1e-3
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-12 * max(scale, 1.0))


@pytest.fixture(scope="module")
def peers():
    return Peers()


def test_viscous_term(peers):
    blocks = kernel.viscous(peers.dNx, peers.dNy, peers.geometry.weights, 0.7)
    peers.same(peers.ours(blocks), peers.theirs(lambda u, v, w: 2.0 * 0.7 * ddot(sym_grad(u), sym_grad(v))))


def test_grad_div_term(peers):
    blocks = kernel.grad_div(peers.dNx, peers.dNy, peers.geometry.weights, 0.7)
    peers.same(peers.ours(blocks), peers.theirs(lambda u, v, w: 0.7 * div(u) * div(v)))


def test_mass(peers):
    block = tensor_products.mass(peers.products, 3.0 * peers.geometry.weights)
    zero = np.zeros_like(block)
    peers.same(peers.ours((block, zero, zero, block)), peers.theirs(lambda u, v, w: 3.0 * dot(u, v)))


def test_convection(peers):
    block = peers.convection(2.0, peers.a)
    zero = np.zeros_like(block)
    theirs = peers.theirs(lambda u, v, w: 2.0 * dot(mul(grad(u), w["a"]), v), a=peers.a)
    peers.same(peers.ours((block, zero, zero, block)), theirs)


def test_newtons_term(peers):
    gradient = kernel.velocity_gradient(peers.table.dN, peers.geometry.J_inv, peers.u[peers.mesh.cells])
    blocks = peers.reaction(2.0, gradient)
    peers.same(peers.ours(blocks), peers.theirs(lambda u, v, w: 2.0 * dot(mul(grad(w["u"]), u), v), u=peers.u))


def test_convection_and_newtons_term_are_the_derivative_of_convection(peers):
    def convection(u):
        block = peers.convection(2.0, u)
        zero = np.zeros_like(block)
        return peers.ours((block, zero, zero, block))

    gradient = kernel.velocity_gradient(peers.table.dN, peers.geometry.J_inv, peers.u[peers.mesh.cells])
    newton = peers.ours(peers.reaction(2.0, gradient))
    # Convection is quadratic: c(u + d) - c(u - d) = 2 c'(u) d without remainder.
    d = peers.a
    difference = convection(peers.u + d) @ (peers.u + d).ravel() - convection(peers.u - d) @ (peers.u - d).ravel()
    peers.same(2.0 * (convection(peers.u) + newton) @ d.ravel(), difference)


def test_what_advects_the_gradient_of_the_test_functions(peers):
    """-(a·∇v)·u as the work of a stress, and its derivative in a by transposed transport."""
    cells, geometry, N = peers.mesh.cells, peers.geometry, peers.table.N
    u, a = N @ peers.u[cells], N @ peers.a[cells]
    local = kernel.stress_work(peers.table.dN, geometry.J_inv, geometry.weights, 2.0 * kernel.advected_stress(u, a))
    ours = np.zeros(peers.mesh.points.shape)
    np.add.at(ours, cells, local)
    theirs = peers.theirs(lambda a, v, w: -2.0 * dot(mul(grad(v), a), w["u"]), u=peers.u)
    peers.same(ours.ravel(), theirs @ peers.a.ravel())
    c = kernel.advected_transport(geometry.weights, geometry.J_inv, 2.0, u)
    blocks = tensor_products.transport(peers.products, *(part.reshape(-1, part.shape[-1]) for part in c))
    peers.same(peers.ours(np.split(-blocks.transpose(0, 2, 1), 4)), theirs)


def test_divergence(peers):
    n = len(peers.mesh.points)
    pressure = element_table(1, COUNT)
    corners = peers.mesh.cells[:, [0, 2, 6, 8]]  # lexicographic, as the basis of order 1
    blocks = kernel.divergence(pressure.N, peers.dNx, peers.dNy, peers.geometry.weights)
    ours = np.zeros((n, n, 2))
    for a, block in enumerate(blocks):
        rows = np.broadcast_to(corners[:, :, None], block.shape).ravel()
        columns = np.broadcast_to(peers.mesh.cells[:, None, :], block.shape).ravel()
        ours[:, :, a] = sp.coo_matrix((block.ravel(), (rows, columns)), (n, n)).toarray()
    theirs = peers.theirs(lambda u, q, w: -q * div(u), test=peers.pressure)
    peers.same(ours.reshape(n, 2 * n), theirs)


def test_load(peers):
    f = peers.table.N @ peers.u[peers.mesh.cells]
    local = kernel.load(peers.table.N, peers.geometry.weights, f)
    ours = np.zeros(peers.mesh.points.shape)
    np.add.at(ours, peers.mesh.cells, local)
    mass = peers.theirs(lambda u, v, w: dot(u, v))
    peers.same(ours.ravel(), mass @ peers.u.ravel())


def test_velocity_gradient_of_a_linear_field(peers):
    G = np.array([[0.3, -1.2], [2.1, 0.4]])  # ∂_b u_a
    u = peers.mesh.points @ G.T
    gradient = kernel.velocity_gradient(peers.table.dN, peers.geometry.J_inv, u[peers.mesh.cells])
    assert gradient.shape == (2, 2, len(peers.mesh.cells), COUNT**2)
    np.testing.assert_allclose(gradient, np.broadcast_to(G[:, :, None, None], gradient.shape), rtol=0.0, atol=1e-12)


def test_advection_is_that_of_the_convection_matrix(peers):
    gradient = kernel.velocity_gradient(peers.table.dN, peers.geometry.J_inv, peers.u[peers.mesh.cells])
    density = 2.0 * kernel.advection(gradient, peers.table.N @ peers.a[peers.mesh.cells])
    local = kernel.load(peers.table.N, peers.geometry.weights, density)
    by_matrix = peers.convection(2.0, peers.a) @ peers.u[peers.mesh.cells]
    np.testing.assert_allclose(local, by_matrix, rtol=0.0, atol=1e-12)


def test_work_of_a_viscous_stress_is_that_of_the_viscous_matrix(peers):
    gradient = kernel.velocity_gradient(peers.table.dN, peers.geometry.J_inv, peers.u[peers.mesh.cells])
    stress = 0.7 * (gradient + gradient.swapaxes(0, 1))
    local = kernel.stress_work(peers.table.dN, peers.geometry.J_inv, peers.geometry.weights, stress)
    ours = np.zeros(peers.mesh.points.shape)
    np.add.at(ours, peers.mesh.cells, local)
    theirs = peers.theirs(lambda u, v, w: 2.0 * 0.7 * ddot(sym_grad(u), sym_grad(v)))
    peers.same(ours.ravel(), theirs @ peers.u.ravel())
