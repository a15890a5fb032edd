"""Small solids: meshes with straight, bent and curved elements, conditions from strings, equilibrium and steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hoblock import Arc, BlockStructure, generate
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.solvers.solid import SolidSolver


class Solids:
    """Ways to make solids and to solve for them."""

    E, NU, RHO = 210.0, 0.3, 4.0
    LAME, MU = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), E / (2.0 * (1.0 + NU))
    around = ("bottom", "right", "top", "left")

    @staticmethod
    def expression(text):
        return compile_expression(str(text), ("x", "y", "t"))

    @staticmethod
    def displacement(on, x=None, y=None):
        components = (None if c is None else Solids.expression(c) for c in (x, y))
        return case.Displacement((on,) if isinstance(on, str) else on, *components)

    @staticmethod
    def traction(on, x, y):
        return case.Traction((on,), Solids.expression(x), Solids.expression(y))

    @staticmethod
    def pressure(on, value):
        return case.Pressure((on,), Solids.expression(value))

    @staticmethod
    def pair(x, y):
        return Solids.expression(x), Solids.expression(y)

    @staticmethod
    def initial(x, y):
        return tuple(compile_expression(str(text), ("x", "y")) for text in (x, y))

    @staticmethod
    def solver(mesh, boundaries, tolerance=1e-11, max_iterations=25, **changes):
        material, blocks = (Solids.RHO, Solids.E, Solids.NU), tuple(mesh.cell_groups)
        body = replace(case.Solid("block", *material, blocks, tuple(boundaries)), **changes)
        return SolidSolver(mesh, [body], case.NonlinearSettings(tolerance, max_iterations))

    @staticmethod
    def rectangle(order, columns=2, rows=2, size=(1.0, 1.0), turn=0.0, shape=None):
        corners = np.array([(0.0, 0.0), (size[0], 0.0), size, (0.0, size[1])]) @ Solids.rotation(turn).T
        edges = {"bottom": [(0, 1)], "right": [(1, 2)], "top": [(2, 3)], "left": [(3, 0)]}
        counts = {(0, 1): columns, (1, 2): rows}
        mesh = generate(BlockStructure.build(corners, {"solid": [(0, 1, 2, 3)]}, counts=counts, edges=edges), order)
        return mesh if shape is None else mesh.with_points(shape(mesh.points))

    @staticmethod
    def bent(points):
        x, y = points.T
        return np.stack(
            [x + 0.08 * np.sin(2.1 * y + 0.3) * (1 + x), y + 0.1 * x**2 - 0.06 * np.cos(1.7 * x) * y], axis=-1
        )

    @staticmethod
    def quarter_ring(order, rings, count, inner=1.0, outer=2.0):
        vertices = {"a": (inner, 0.0), "b": (outer, 0.0), "c": (0.0, outer), "d": (0.0, inner)}
        curves = {
            ("b", "c"): Arc.from_center((0.0, 0.0), vertices["b"], vertices["c"]),
            ("a", "d"): Arc.from_center((0.0, 0.0), vertices["a"], vertices["d"]),
        }
        edges = {"bottom": [("a", "b")], "outer": [("b", "c")], "left": [("c", "d")], "inner": [("d", "a")]}
        counts = {("a", "b"): rings, ("b", "c"): count}
        return generate(
            BlockStructure.build(
                vertices, {"solid": [("a", "b", "c", "d")]}, counts=counts, curves=curves, edges=edges
            ),
            order,
        )

    @staticmethod
    def rotation(angle):
        return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    @staticmethod
    def equilibrium(s, load=None):
        step = s.begin_static()
        return step.solve(load)

    @staticmethod
    def march(s, state, dt, count, guess=None):
        steps = []
        for _ in range(count):
            steps = [dt, *steps][:2]
            step = s.begin_step(state, steps, state.time + dt)
            state = step.accept(step.solve(guess=None if guess is None else guess(state)))
        return state

    @staticmethod
    def plate(order=4, elements=8, **changes):
        """The plate of Wall and Ramm: 4 × 0.06, clamped at its left end."""
        mesh = Solids.rectangle(order, elements, 1, (4.0, 0.06))
        material = {"density": 0.1, "youngs_modulus": 2.5e6, "poissons_ratio": 0.35} | changes
        tip = int(np.argmax(mesh.points.sum(axis=1)))
        return Solids.solver(mesh, [Solids.displacement("left", 0, 0)], 1e-10, **material), tip


@pytest.fixture(scope="session")
def solids():
    return Solids
