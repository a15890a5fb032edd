"""Stress at nodes against homogeneous deformations, whose stress is known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from hoblock import Arc, BlockStructure, generate
from hofsi.case import Solid
from hofsi.solvers.solid_stress import SolidStress, von_mises

E, NU = 1.7, 0.3
LAME, MU = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
G = np.array([[0.12, -0.2], [0.05, 0.3]])  # displacement gradient


@pytest.fixture(scope="module")
def mesh():
    vertices = {"a": (0, 0), "b": (1, 0), "c": (2, 0), "d": (0, 1), "e": (1.2, 1), "f": (2, 1)}
    blocks = {"left": [("a", "b", "e", "d")], "right": [("b", "c", "f", "e")]}
    arc = Arc.through(np.array([0.0, 1.0]), np.array([0.6, 1.2]), np.array([1.2, 1.0]))
    return generate(BlockStructure.build(vertices, blocks, counts=2, curves={("d", "e"): arc}), 3)


def _solid(blocks=("left", "right"), *, modulus=E, name="solid", **laws):
    return Solid(name, 1.0, modulus, NU, blocks, (), **laws)


def _hooke(strain, *, plane):
    across = 0.0 if plane == "strain" else -NU / (1 - NU) * np.trace(strain)
    trace = np.trace(strain) + across
    inside = LAME * trace * np.eye(2) + 2 * MU * strain
    return inside, LAME * trace + 2 * MU * across


@pytest.mark.parametrize("plane", ["strain", "stress"])
@pytest.mark.parametrize("model", ["linear", "st-venant-kirchhoff"])
def test_stress_of_a_homogeneous_deformation(mesh, model, plane):
    if model == "linear":
        F, strain = np.eye(2), 0.5 * (G + G.T)
    else:
        F = np.eye(2) + G
        strain = 0.5 * (F.T @ F - np.eye(2))
    S, across = _hooke(strain, plane=plane)
    sigma = F @ S @ F.T / np.linalg.det(F)
    expected = [sigma[0, 0], sigma[1, 1], across / np.linalg.det(F), sigma[0, 1]]
    found = SolidStress(mesh, [_solid(model=model, plane=plane)]).cauchy(mesh.points @ G.T)
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), rtol=0, atol=1e-12)


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_stress_of_a_neo_hookean_solid(mesh, plane):
    """σ = (μ (b - I) + λ ln J I)/J in all three directions."""
    F = np.eye(3)
    F[:2, :2] += G
    if plane == "stress":
        across = brentq(lambda a: MU * (a**2 - 1.0) + LAME * np.log(a * np.linalg.det(F)), 0.1, 10.0, xtol=1e-15)
        F[2, 2] = across
    J = np.linalg.det(F)
    sigma = (MU * (F @ F.T - np.eye(3)) + LAME * np.log(J) * np.eye(3)) / J
    expected = [sigma[0, 0], sigma[1, 1], sigma[2, 2], sigma[0, 1]]
    assert (abs(sigma[2, 2]) < 1e-13) == (plane == "stress")
    found = SolidStress(mesh, [_solid(model="neo-hooke", plane=plane)]).cauchy(mesh.points @ G.T)
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), rtol=0, atol=1e-12)


def test_a_rotation_makes_no_stress(mesh):
    c, s = np.cos(0.8), np.sin(0.8)
    rotation = np.array([[c - 1.0, -s], [s, c - 1.0]])
    found = SolidStress(mesh, [_solid()]).cauchy(mesh.points @ rotation.T)
    np.testing.assert_allclose(found, 0.0, atol=1e-12)


def test_two_solids_share_an_edge(mesh):
    pair = [_solid(("right",), modulus=3 * E, name="hard"), _solid(("left",), name="soft")]
    found = SolidStress(mesh, pair).cauchy(mesh.points @ G.T)
    alone = SolidStress(mesh, [_solid()]).cauchy(mesh.points @ G.T)
    left, right = (np.unique(mesh.cells[mesh.cell_groups[name]]) for name in ("left", "right"))
    both = np.intersect1d(left, right)
    assert len(both) == 7
    np.testing.assert_allclose(found[np.setdiff1d(left, both)], alone[np.setdiff1d(left, both)], rtol=1e-12)
    np.testing.assert_allclose(found[np.setdiff1d(right, both)], 3 * alone[np.setdiff1d(right, both)], rtol=1e-12)
    np.testing.assert_allclose(found[both], 2 * alone[both], rtol=1e-12)


def test_von_mises_of_tension_shear_and_pressure():
    stresses = np.array([[3.0, 0, 0, 0], [0, 0, 0, 2.0], [5.0, 5.0, 5.0, 0]])
    np.testing.assert_allclose(von_mises(stresses), [3.0, 2.0 * np.sqrt(3.0), 0.0], atol=1e-14)
