"""Solids solved by multigrid give what LU gives."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock import BlockStructure, generate
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.counts import Counts
from hofsi.linear.krylov import KrylovSolver
from hofsi.solvers.solid_equations import SolidEquations
from hofsi.solvers.solid_supports import SolidSupports
from hofsi.solvers.solid_system import solid_system

pytest.importorskip("pyamg")

ZERO = compile_expression("0", ("x", "y", "t"))


def clamped(order, columns, rows, length, height, turn=0.0):
    """Equations and supports of a rectangle that is clamped on one side and rolls on half of another."""
    c, s = np.cos(turn), np.sin(turn)
    corners = np.array([(0, 0), (length / 2, 0), (length, 0), (length, height), (length / 2, height), (0, height)])
    edges = {"clamp": [(0, 5)], "floor": [(1, 2)]}
    structure = BlockStructure.build(
        corners @ np.array([[c, s], [-s, c]]),
        {"solid": [(0, 1, 4, 5), (1, 2, 3, 4)]},
        edges=edges,
        counts={(0, 1): columns, (1, 2): columns, (0, 5): rows},
    )
    mesh = generate(structure, order)
    held = (case.Displacement(("clamp",), ZERO, ZERO), case.Roller(("floor",)))
    solid = case.Solid("flag", 1000.0, 1.4e6, 0.4, ("solid",), held)
    equations = SolidEquations(mesh, [solid])
    return equations, SolidSupports(mesh, [solid], equations.cells_of)


@pytest.mark.parametrize("mass", [0.0, 1e4])
@pytest.mark.parametrize(("order", "columns", "rows", "height"), [(2, 6, 3, 0.5), (4, 5, 2, 0.05), (3, 24, 24, 1.0)])
def test_solution_is_that_of_the_factors(order, columns, rows, height, mass):
    equations, supports = clamped(order, columns, rows, 1.0, height, turn=0.4)
    points = equations.mesh.points
    bend = 0.05 * np.stack([points[:, 1] ** 2, points[:, 0] ** 2], axis=-1)
    gradient = equations.gradient(bend)
    K = equations.tangent(gradient, equations.stress(gradient), mass, ())
    load = equations.shared(np.random.default_rng(37).standard_normal(points.shape))
    counts = Counts()
    factors = [
        solid_system(equations, supports, case.LinearSettings(kind), counts).factorise(K) for kind in ("direct", "amg")
    ]
    expected, found = (factor.solve(load) for factor in factors)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-7 * np.abs(expected).max())
    iterative = factors[1].factor
    assert isinstance(iterative, KrylovSolver)
    assert 3 < iterative.iterations < 60
    assert (counts.preconditioners, counts.linear_iterations) == (1, iterative.iterations)
