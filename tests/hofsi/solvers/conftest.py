"""Small fluids: meshes with straight, distorted and curved elements, conditions from strings, steps in time."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock import Arc, BlockStructure, generate
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.solvers.fluid import FluidSolver

NOBODY = np.zeros((0, 2))


class Flows:
    """Ways to make a fluid and to solve for it."""

    parabola = "4*y*(1 - y)"
    around = ("left", "right", "bottom", "top")

    @staticmethod
    def expression(text, variables=("x", "y", "t")):
        return compile_expression(text, variables)

    @staticmethod
    def velocity(on, x=None, y=None, **tractions):
        make = Flows.expression
        return case.Velocity(
            (on,) if isinstance(on, str) else tuple(on),
            None if x is None else make(x),
            None if y is None else make(y),
            **{name: make(text) for name, text in tractions.items()},
        )

    @staticmethod
    def traction(on, x, y):
        return case.Traction((on,), Flows.expression(x), Flows.expression(y))

    @staticmethod
    def pressure(on, value):
        return case.Pressure((on,), Flows.expression(value))

    @staticmethod
    def grid(order, columns=3, rows=2, *, size=(1.0, 1.0), jitter=0.2, turn=0.0, seed=8123):
        """A rectangle of straight-sided quads with displaced vertices, turned about the origin; one block an element.

        On such quads polynomials in x and y up to the element's order are represented exactly.
        """
        x, y = np.meshgrid(np.linspace(0.0, size[0], columns + 1), np.linspace(0.0, size[1], rows + 1))
        cell = np.array([size[0] / columns, size[1] / rows])
        shift = jitter * cell * np.random.default_rng(seed).uniform(-1.0, 1.0, (*x.shape, 2))
        shift[[0, -1], :, 1] = 0.0
        shift[:, [0, -1], 0] = 0.0
        vertices = (np.stack([x, y], axis=-1) + shift).reshape(-1, 2) @ Flows.rotation(turn).T
        number = np.arange(x.size).reshape(x.shape)
        quads = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
        lines = {"bottom": number[0], "top": number[-1], "left": number[:, 0], "right": number[:, -1]}
        edges = {name: list(zip(map(int, line), map(int, line[1:]), strict=False)) for name, line in lines.items()}
        return generate(BlockStructure.build(vertices, {"fluid": quads.tolist()}, edges=edges), order)

    @staticmethod
    def rectangle(order, columns, rows, *, low=(0.0, 0.0), high=(1.0, 1.0), bend=0.0):
        """A rectangle of equal elements; ``bend`` curves the lines inside, boundary nodes slide along the sides."""
        vertices = {"a": low, "b": (high[0], low[1]), "c": high, "d": (low[0], high[1])}
        edges = {"bottom": [("a", "b")], "right": [("b", "c")], "top": [("c", "d")], "left": [("d", "a")]}
        structure = BlockStructure.build(
            vertices, {"fluid": [("a", "b", "c", "d")]}, edges=edges, counts={("a", "b"): columns, ("b", "c"): rows}
        )
        mesh = generate(structure, order)
        extent = np.subtract(high, low)
        s, t = ((mesh.points - low) / extent).T
        wave = np.stack([np.sin(np.pi * s) * np.cos(2.0 * np.pi * t), np.cos(np.pi * s) * np.sin(np.pi * t)], axis=-1)
        return mesh.with_points(mesh.points + bend * extent * wave)

    @staticmethod
    def annulus(order, sectors=4, rings=1, count=1, *, inner=0.5, outer=1.0):
        """Rings of curved elements with the names inner and outer."""
        angle = 2.0 * np.pi / sectors * np.arange(sectors)
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        vertices = np.concatenate([inner * circle, outer * circle])
        following = [(k + 1) % sectors for k in range(sectors)]
        pairs = {
            name: [(shift + k, shift + j) for k, j in enumerate(following)]
            for name, shift in (("inner", 0), ("outer", sectors))
        }
        curves = {
            pair: Arc.from_center((0.0, 0.0), vertices[pair[0]], vertices[pair[1]])
            for side in pairs.values()
            for pair in side
        }
        counts = {(0, sectors): rings} | dict.fromkeys(pairs["inner"], count)
        quads = {"fluid": [(k, sectors + k, sectors + j, j) for k, j in enumerate(following)]}
        return generate(BlockStructure.build(vertices, quads, counts=counts, curves=curves, edges=pairs), order)

    @staticmethod
    def wobble(X, t):
        """Smooth motion of all nodes, boundary included; large enough to bend every element."""
        x, y = X.T
        return X + 0.06 * np.stack(
            [
                np.sin(3.0 * t) * np.sin(2.0 * np.pi * y + 0.4) + 0.3 * np.cos(2.0 * x + t),
                np.sin(2.0 * t + 1.0) * np.sin(2.0 * np.pi * x + 0.2),
            ],
            axis=-1,
        )

    @staticmethod
    def channel(order=2, columns=3, rows=2, profile=None, **fluid):
        """Flow through a channel of length 3 and height 1."""
        inlet = Flows.velocity("left", profile or Flows.parabola, 0)
        conditions = [inlet, case.NoSlip(("top", "bottom")), case.DoNothing(("right",))]
        return Flows.solver(Flows.grid(order, columns, rows, size=(3.0, 1.0)), conditions, **fluid)

    @staticmethod
    def rotation(angle):
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, -s], [s, c]])

    @staticmethod
    def solver(
        mesh,
        conditions,
        *,
        density=1.0,
        viscosity=1.0,
        tolerance=1e-12,
        max_iterations=25,
        interface=(),
        driven=None,
        **fluid,
    ):
        for name, variables in (("body_force", ("x", "y", "t")), ("initial_velocity", ("x", "y"))):
            if name in fluid:
                fluid[name] = tuple(Flows.expression(text, variables) for text in fluid[name])
        return FluidSolver(
            mesh,
            case.Fluid(density, viscosity, ("fluid",), tuple(conditions), **fluid),
            case.NonlinearSettings(tolerance, max_iterations),
            case.LinearSettings(),
            np.array(interface, dtype=np.int64),
            driven,
        )

    @staticmethod
    def steady(solver):
        step = solver.begin_steady(solver.initial_state(), solver.mesh.points)
        step.solve(NOBODY)
        return step.accept()

    @staticmethod
    def convection(solver, linear):
        """The solver's own, where that is linear or not as asked for."""
        own, ways = solver.fluid.convection, ("linearised", "extrapolated") if linear else ("newton", "picard")
        return own if own in ways else ways[0]

    @staticmethod
    def march(solver, state, sizes, position=None, *, linear=False, steps=()):
        """Steps of the given sizes; ``position`` maps a time to node positions, ``steps`` are sizes made before."""
        time, made = state.time, list(steps)
        for size in sizes:
            time, made = time + size, [size, *made]
            points = state.points[0] if position is None else position(time)
            step = solver.begin_step(state, points, made, time, convection=Flows.convection(solver, linear))
            step.solve(NOBODY)
            state = step.accept()
        return state

    @staticmethod
    def field(points, x, y, time=0.0):
        """A vector field of expressions at points (n, 2)."""
        values = [Flows.expression(text).evaluate(x=points[:, 0], y=points[:, 1], t=time) for text in (x, y)]
        return np.stack(values, axis=-1)

    @staticmethod
    def pressure_error(solver, state, text, *, level=False):
        """Largest error of the pressure at quadrature points; with ``level`` the exact mean is removed first."""
        space = solver.space
        geometry = solver.geometry(state.points[0])
        computed = state.pressure[space.pressure_cells] @ space.pressure.N.T
        exact = Flows.expression(text).evaluate(x=geometry.x[..., 0], y=geometry.x[..., 1], t=state.time)
        if level:
            exact = exact - np.sum(geometry.weights * exact) / np.sum(geometry.weights)
        return float(np.abs(computed - exact).max())

    @staticmethod
    def velocity_norm_of_error(solver, state, x, y):
        """L² norm of the velocity's error."""
        space = solver.space
        geometry = solver.geometry(state.points[0])
        exact = Flows.field(geometry.x.reshape(-1, 2), x, y, state.time).reshape(geometry.x.shape)
        error = space.velocity.N @ state.velocity[space.velocity_cells] - exact
        return float(np.sqrt(np.sum(geometry.weights[..., None] * error**2)))

    @staticmethod
    def pressure_norm_of_error(solver, state, text):
        """L² norm of the pressure's error, both with zero mean."""
        space = solver.space
        geometry = solver.geometry(state.points[0])
        w = geometry.weights
        exact = Flows.expression(text).evaluate(x=geometry.x[..., 0], y=geometry.x[..., 1], t=state.time)
        error = state.pressure[space.pressure_cells] @ space.pressure.N.T - exact
        error -= np.sum(w * error) / np.sum(w)
        return float(np.sqrt(np.sum(w * error**2)))


@pytest.fixture(scope="session")
def flows():
    return Flows
