"""Energies of solids: the strain energy is the potential of the internal forces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hoblock import BlockStructure, generate
from hofsi import case
from hofsi.solvers.solid import SolidSolver, SolidState
from hofsi.solvers.solid_integrals import kinetic_energy, strain_energy

RHO, E, NU = 4.0, 210.0, 0.3


def solver_of(*models, order=3):
    """Blocks side by side, one for each (model, plane)."""
    n = len(models)
    vertices = [(float(k), y) for y in (0.0, 1.0) for k in range(n + 1)]
    blocks = {f"s{k}": [(k, k + 1, n + k + 2, n + k + 1)] for k in range(n)}
    mesh = generate(BlockStructure.build(vertices, blocks, counts={(0, 1): 2}), order)
    x, y = mesh.points.T
    mesh = mesh.with_points(np.stack([x + 0.06 * np.sin(2.0 * y), y + 0.05 * x * (1.0 - y)], axis=-1))
    solids = [
        replace(case.Solid(f"s{k}", RHO, E, NU, (f"s{k}",), ()), model=model, plane=plane)
        for k, (model, plane) in enumerate(models)
    ]
    return SolidSolver(mesh, solids, case.NonlinearSettings())


def fields(solver):
    rng = np.random.default_rng(11)
    x, y = solver.mesh.points.T
    d = np.stack([0.1 * np.sin(x + y) + 0.05 * x * y, 0.15 * x**2 - 0.1 * y], axis=-1)
    return d, rng.standard_normal(d.shape)


def energy(solver, d):
    return strain_energy(solver, SolidState((d,), (np.zeros(d.shape),), 0.0))


@pytest.mark.parametrize("plane", ["strain", "stress"])
@pytest.mark.parametrize("model", ["linear", "st-venant-kirchhoff", "neo-hooke"])
def test_the_derivative_of_the_strain_energy_is_the_internal_force(model, plane):
    solver = solver_of((model, plane))
    d, v = fields(solver)
    H = solver.equations.gradient(d)
    force = solver.equations.internal_force(H, solver.equations.stress(H))
    h = 1e-4
    # Fourth-order differences.
    slope = sum(w * energy(solver, d + k * h * v) for k, w in ((1, 8), (-1, -8), (2, -1), (-2, 1))) / (12.0 * h)
    assert slope == pytest.approx(float((force * v).sum()), rel=1e-8)
    assert energy(solver, np.zeros(d.shape)) == 0.0


def test_small_strains_have_the_energy_of_hookes_law():
    linear = solver_of(("linear", "strain"))
    d, _ = fields(linear)
    d *= 1e-6
    for model in ("st-venant-kirchhoff", "neo-hooke"):
        assert energy(solver_of((model, "strain")), d) == pytest.approx(energy(linear, d), rel=1e-4)


def test_energies_of_several_solids_add_up():
    kinds = ("linear", "stress"), ("neo-hooke", "strain"), ("st-venant-kirchhoff", "strain"), ("neo-hooke", "stress")
    solver = solver_of(*kinds)
    x = solver.mesh.points
    d = np.stack([0.1 * x[:, 0] + 0.02 * x[:, 1], -0.05 * x[:, 1]], axis=-1)  # the same strain everywhere
    areas = [float(solver.equations._weights[cells].sum()) for cells in solver.equations.cells_of]
    alone = []
    for kind, area in zip(kinds, areas, strict=True):
        one = solver_of(kind)
        y = one.mesh.points
        each = np.stack([0.1 * y[:, 0] + 0.02 * y[:, 1], -0.05 * y[:, 1]], axis=-1)
        alone.append(energy(one, each) * area / float(one.equations._weights.sum()))
    assert energy(solver, d) == pytest.approx(sum(alone), rel=1e-12)


def test_kinetic_energy_of_a_turning_body():
    solver = solver_of(("linear", "strain"), order=4)
    x, y = solver.mesh.points.T
    v = np.stack([0.7 - 2.0 * y, 0.3 + 2.0 * x], axis=-1)
    got = kinetic_energy(solver, SolidState((np.zeros(v.shape),), (v,), 0.0))
    from hofsi.fem.element import element_table
    from hofsi.fem.geometry import element_geometry

    geometry = element_geometry(solver.mesh.coordinates, element_table(4, 9))
    X, Y = geometry.x[..., 0], geometry.x[..., 1]
    exact = 0.5 * RHO * float((geometry.weights * ((0.7 - 2.0 * Y) ** 2 + (0.3 + 2.0 * X) ** 2)).sum())
    assert got == pytest.approx(exact, rel=1e-12)
