"""Errors of displacement, velocity and load against exact ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from exact_fsi.settings import Settings
from hoblock import QuadMesh
from hofsi.build import Problem
from hofsi.fem.element import element_table
from hofsi.fem.geometry import element_geometry
from hofsi.quantities import evaluators
from hofsi.records import StepRecord

Array = NDArray[np.float64]

__all__ = ["Errors", "Exact", "Wave", "errors_at", "load_errors", "orders"]

_MORE = 6
"""Quadrature points in each direction beyond order + 1."""


class Exact(Protocol):
    """What a study needs of an exact solution."""

    @property
    def quantities(self) -> tuple[str, ...]:
        """Of the scene: the load on the solid."""
        ...

    def displacement_at(self, points: Array, time: float) -> Array:
        """Of the solid."""
        ...

    def velocity_at(self, points: Array, time: float) -> Array:
        """Of the fluid."""
        ...

    def load_at(self, time: float) -> Array:
        """Of the fluid on the solid."""
        ...

    def scene(self, given: Settings) -> str:
        """The scene, started from the exact state."""
        ...


class Wave(Exact, Protocol):
    """One that started long ago."""

    def solid_velocity_at(self, points: Array, time: float) -> Array:
        """Of the solid."""
        ...


@dataclass(frozen=True)
class Errors:
    """Errors of displacement and velocity in L², and of the load on the solid, all relative; or orders of them.

    Attributes
    ----------
    displacement, velocity, load : float
    """

    displacement: float
    velocity: float
    load: float


def errors_at(exact: Exact, problem: Problem, record: StepRecord) -> Errors:
    """Errors at a step."""
    state, t = record.state, record.time
    assert problem.solid is not None
    assert state.solid is not None
    assert state.fluid is not None
    assert state.mesh is not None
    d = _l2(problem.solid.mesh, state.solid.displacement, lambda x: exact.displacement_at(x, t))
    v = _l2(state.mesh.mesh, state.fluid.velocity, lambda x: exact.velocity_at(x, t))
    load = float(np.abs(load_errors(exact, problem, [record])).max())
    return Errors(d, v, load / float(np.abs(exact.load_at(t)).max()))


def load_errors(exact: Exact, problem: Problem, records: Sequence[StepRecord]) -> Array:
    """Errors of the load at some steps, shape (k, number of quantities)."""
    read = evaluators(problem)
    return np.array(
        [[read[name](record) for name in exact.quantities] - exact.load_at(record.time) for record in records]
    )


def _l2(mesh: QuadMesh, values: Array, exact: Callable[[Array], Array]) -> float:
    """Relative error of a nodal field."""
    table = element_table(mesh.order, mesh.order + 1 + _MORE)
    geometry = element_geometry(mesh.points[mesh.cells], table)
    w = geometry.weights[..., None]
    right = exact(geometry.x)
    error = table.N @ values[mesh.cells] - right
    return float(np.sqrt(np.sum(w * error**2) / np.sum(w * right**2)))


def orders(coarse: Errors, fine: Errors, ratio: float) -> Errors:
    """Orders observed between two runs.

    Parameters
    ----------
    coarse, fine : Errors
    ratio : float
        Of the steps or the mesh widths, above 1.
    """
    pairs = (
        (coarse.displacement, fine.displacement),
        (coarse.velocity, fine.velocity),
        (coarse.load, fine.load),
    )
    return Errors(*(float(np.log(a / b) / np.log(ratio)) for a, b in pairs))
