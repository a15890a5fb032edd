"""An exact solution of the Navier–Stokes equations, written as in a scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoblock.expressions import Expression, compile_expression

Array = NDArray[np.float64]
Pair = tuple[str, str]

__all__ = ["Flow"]


@dataclass(frozen=True)
class Flow:
    """Velocity and pressure as expressions of x, y and t, with the body force that makes them a solution.

    Attributes
    ----------
    density, viscosity : float
    velocity, force : pair of str
    pressure : str
    traction : pair of str
        σ·n on a side with the normal (1, 0).
    initial : pair of str
        Velocity at t = 0.
    constants : mapping of str to float
        Used in the expressions.
    """

    density: float
    viscosity: float
    velocity: Pair
    pressure: str
    traction: Pair
    force: Pair = ("0", "0")
    initial: Pair = ("0", "0")
    constants: Mapping[str, float] = field(default_factory=dict)

    @cached_property
    def _compiled(self) -> dict[str, Expression]:
        texts = (*self.velocity, self.pressure, *self.force, *self.traction, *self.initial)
        return {text: compile_expression(text, ("x", "y", "t"), dict(self.constants)) for text in texts}

    def _at(self, text: str, points: Array, time: float) -> Array:
        values = self._compiled[text].evaluate(x=points[..., 0], y=points[..., 1], t=time)
        return np.broadcast_to(np.asarray(values, dtype=np.float64), points.shape[:-1])

    def _pair_at(self, pair: Pair, points: Array, time: float) -> Array:
        return np.stack([self._at(text, points, time) for text in pair], axis=-1)

    def velocity_at(self, points: Array, time: float) -> Array:
        """Velocity at points (..., 2)."""
        return self._pair_at(self.velocity, points, time)

    def initial_velocity_at(self, points: Array) -> Array:
        """Velocity at points (..., 2) and t = 0, as a scene has it."""
        return self._pair_at(self.initial, points, 0.0)

    def force_at(self, points: Array, time: float) -> Array:
        """Body force at points (..., 2)."""
        return self._pair_at(self.force, points, time)

    def traction_at(self, points: Array, time: float) -> Array:
        """Traction on a side with the normal (1, 0) at points (..., 2)."""
        return self._pair_at(self.traction, points, time)

    def pressure_at(self, points: Array, time: float) -> Array:
        """Pressure at points (..., 2), shape (...)."""
        return self._at(self.pressure, points, time)

    def scene(self, given: Sequence[str], open_side: str | None = None, convection: str | None = None) -> str:
        """The ``[constants]`` and ``[fluid]`` of a scene, with the exact velocity on the boundary.

        Parameters
        ----------
        given : sequence of str
            Names of edges.
        open_side : str, optional
            Edges with the normal (1, 0) where the exact traction acts instead.
        convection : str, optional
        """
        lines = ["[constants]", *(f"{name} = {value!r}" for name, value in self.constants.items()), "[fluid]"]
        lines += [f"density = {self.density}", f"viscosity = {self.viscosity}"]
        for name, (x, y) in (("body_force", self.force), ("initial_velocity", self.initial)):
            lines.append(f'{name} = ["{x}", "{y}"]')
        lines += [f'convection = "{convection}"'] if convection else []
        lines += _condition("velocity", given, self.velocity)
        lines += _condition("traction", [open_side], self.traction) if open_side else []
        return "\n".join(lines) + "\n"


def _condition(kind: str, on: Sequence[str], values: Pair) -> list[str]:
    names = ", ".join(f'"{name}"' for name in on)
    return ["[[fluid.boundary]]", f"on = [{names}]", f'type = "{kind}"', f'x = "{values[0]}"', f'y = "{values[1]}"']
