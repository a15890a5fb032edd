"""Gmsh's own measures of the same mesh, read from the file that is written for it.

Gmsh bounds det J by Bernstein coefficients of its own, with a tolerance of some percent of the range; they agree with
ours. Its minSIGE is our scaled Jacobian. Its minSJ is neither that nor our Jacobian ratio: it is the smallest det J
over that of the straight-sided element at its middle.
"""

from __future__ import annotations

import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.io.msh import write_msh
from hoblock.quality import certify, det_jacobian, jacobian_ratio, scaled_jacobian


@pytest.fixture
def gmsh_qualities(gmsh_module, tmp_path):
    """Return a function that reads a mesh's measures from Gmsh, in the sequence of our elements."""
    gmsh_module.initialize(interruptible=False)
    gmsh_module.option.setNumber("General.Terminal", 0)

    def measure(mesh, *names):
        gmsh_module.clear()
        write_msh(tmp_path / "mesh.msh", mesh)
        gmsh_module.open(str(tmp_path / "mesh.msh"))
        (kind,), (tags,), _ = gmsh_module.model.mesh.getElements(2)
        # Ours and Gmsh's elements are matched by the means of their corners.
        centres = np.reshape(gmsh_module.model.mesh.getBarycenters(kind, -1, False, True), (-1, 3))[:, :2]
        ours = mesh.points[mesh.corners].mean(axis=1)
        sequence = [int(np.hypot(*(centres - place).T).argmin()) for place in ours]
        assert len(set(sequence)) == len(ours)
        return [np.asarray(gmsh_module.model.mesh.getElementQualities(tags, name))[sequence] for name in names]

    yield measure
    gmsh_module.finalize()


@pytest.mark.parametrize("order", range(1, 11))
def test_det_jacobian_agrees(order, gmsh_qualities, layouts, rng):
    mesh = generate(layouts.random("disc", rng), order)
    smallest, largest = gmsh_qualities(mesh, "minDetJac", "maxDetJac")
    fine = np.linspace(-1, 1, 8 * order + 1)
    sampled = det_jacobian(mesh, np.stack(np.meshgrid(fine, fine), axis=-1).reshape(-1, 2))
    tolerance = 0.05 * np.ptp(sampled, axis=1) + 1e-9
    assert np.all(np.abs(smallest - sampled.min(axis=1)) < tolerance)
    assert np.all(np.abs(largest - sampled.max(axis=1)) < tolerance)
    proof = certify(mesh)
    assert proof.valid
    assert np.all(proof.lower <= smallest + tolerance)
    assert np.all(proof.upper >= largest - tolerance)


@pytest.mark.parametrize("order", range(1, 11))
def test_validity_agrees(order, gmsh_qualities, elements, rng):
    """Elements distorted at random: Gmsh's bound and our certificate have the same sign where both are sharp."""
    mesh = elements.perturbed(rng, order, 0.35 / np.sqrt(order), 40)
    mesh = mesh.with_points(mesh.points + np.repeat(3.0 * np.arange(40), (order + 1) ** 2)[:, None])
    (smallest,) = gmsh_qualities(mesh, "minDetJac")
    status = certify(mesh).status
    assert 0 < (status == 2).sum() < 40
    clear = np.abs(smallest) > 0.05
    np.testing.assert_array_equal((status == 0)[clear], (smallest > 0.0)[clear])


@pytest.mark.parametrize("order", range(1, 11))
def test_sige_of_gmsh_is_our_scaled_jacobian(order, gmsh_qualities, layouts, rng):
    for kind in layouts.valences:
        mesh = generate(layouts.random(kind, rng), order)
        (theirs,) = gmsh_qualities(mesh, "minSIGE")
        difference = theirs - scaled_jacobian(mesh)
        assert difference.min() > -1e-6  # both are samples, ours are more
        assert difference.max() < 5e-3


@pytest.mark.parametrize("order", range(1, 10))
def test_sj_of_gmsh_is_relative_to_the_straight_element(order, gmsh_qualities, layouts, rng):
    """At order 10 Gmsh's minSJ is lost in its rounding errors, even for a parallelogram."""
    mesh = generate(layouts.random("disc", rng), order)
    (theirs,) = gmsh_qualities(mesh, "minSJ")
    fine = np.linspace(-1, 1, 8 * order + 1)
    smallest = det_jacobian(mesh, np.stack(np.meshgrid(fine, fine), axis=-1).reshape(-1, 2)).min(axis=1)
    a, b, c, d = mesh.points[mesh.corners].transpose(1, 2, 0)
    straight = ((c - a)[0] * (d - b)[1] - (c - a)[1] * (d - b)[0]) / 8.0  # a quarter of the area
    np.testing.assert_allclose(theirs, smallest / straight, atol=0.1)
    if order == 1:
        np.testing.assert_allclose(theirs, smallest / straight, rtol=1e-12)


def test_measures_agree_on_a_parallelogram(gmsh_qualities, elements):
    shear = np.array([np.cos(1.0), np.sin(1.0)])
    for order in (1, 2, 4, 6):
        mesh = elements.bilinear([(0, 0), (3, 0), shear + np.array([3, 0]), shear], order)
        theirs, ratio = gmsh_qualities(mesh, "minSIGE", "minSJ")
        assert theirs == pytest.approx(scaled_jacobian(mesh), rel=1e-9)
        assert ratio == pytest.approx(jacobian_ratio(mesh), rel=1e-6)
