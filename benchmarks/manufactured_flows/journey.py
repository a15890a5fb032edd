"""A flow on a mesh that moves, from an exact start: with blocks made anew, or with all nodes moved."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from full_mesh_movers import FullMeshMover
from hoblock import QuadMesh, certify
from hofsi.build import Problem, build
from hofsi.clock import Clock
from hofsi.io.scene import read_case
from hofsi.marching import FluidMarch
from hofsi.motion import MeshState
from hofsi.records import State
from hofsi.solvers.fluid import FluidState
from manufactured_flows.flow import Flow

Array = NDArray[np.float64]
Index = NDArray[np.int64]
MakeMover = Callable[[QuadMesh, Index, Index], FullMeshMover]

__all__ = ["FullMeshMotion", "MakeMover", "built", "displacement_of", "journey"]


class Motion(Protocol):
    """What a march needs of `hofsi.motion.MeshMotion`."""

    reference: MeshState

    def move(self, current: MeshState, displacement: Array, time: float) -> MeshState: ...


class FullMeshMotion:
    """Moves the nodes of a problem's mesh one by one instead of its blocks, from the same driven nodes.

    Parameters
    ----------
    problem : Problem
        With a moving fluid.
    make : callable
        (mesh, moving nodes, other nodes of the boundary) → mover.
    """

    def __init__(self, problem: Problem, make: MakeMover) -> None:
        assert problem.fluid is not None
        assert problem.fluid.motion is not None
        mesh, moving = problem.fluid.mesh, problem.fluid.motion.driven.nodes
        boundary = np.unique(np.concatenate([mesh.edge_nodes(name) for name in mesh.edge_groups]))
        self.reference = problem.fluid.motion.reference
        self._start = mesh.points[moving]
        self._mover = make(mesh, moving, np.setdiff1d(boundary, moving))

    def move(self, current: MeshState, displacement: Array, time: float) -> MeshState:
        """Return the moved mesh, certified.

        Raises
        ------
        ValueError
            If it is not valid.
        """
        positions = self._start + displacement
        mesh = current.mesh.with_points(self._mover.move(current.mesh.points, positions))
        certificate = certify(mesh)
        if not certificate.valid:
            raise ValueError(f"t = {time:g}: the moved mesh is not valid. Use more steps or a smaller displacement.")
        return MeshState(mesh, current.vertices, positions, certificate.min_det_J)


def built(scene: str) -> Problem:
    """The problem of a scene."""
    return build(read_case(tomllib.loads(scene), "scene.toml"))


def journey(
    flow: Flow, problem: Problem, times: Sequence[float], make: MakeMover | None = None, *, approach: int = 1
) -> FluidState:
    """Solve a moving problem from the exact velocity at the first two of some times to the last of them.

    Parameters
    ----------
    flow : Flow
    problem : Problem
        Its scene's end does not matter.
    times : sequence of float
        Ascending.
    make : callable, optional
        As of `FullMeshMotion`; by default the problem's blocks move.
    approach : int
        Equal moves from the reference, at t = 0, to the first time.
    """
    assert problem.fluid is not None
    assert problem.fluid.motion is not None
    solver = problem.fluid.solver
    motion: Motion = FullMeshMotion(problem, make) if make else problem.fluid.motion
    displacement = displacement_of(problem)
    mesh = motion.reference
    for time in np.linspace(0.0, times[0], approach + 1)[1:].tolist():
        mesh = motion.move(mesh, displacement(time), time)
    first = mesh.mesh.points
    mesh = motion.move(mesh, displacement(times[1]), times[1])
    points = (mesh.mesh.points, first)
    velocities = tuple(flow.velocity_at(x, t) for x, t in zip(points, (times[1], times[0]), strict=True))
    pressure = np.zeros(solver.space.pressure_count)
    state = State(fluid=FluidState(velocities, pressure, points, np.zeros_like(first), times[1]), mesh=mesh)
    march = FluidMarch(solver, motion.reference, motion, displacement, Clock())
    for k in range(2, len(times)):
        steps = np.diff(times[k - 2 : k + 1])[::-1].tolist()
        state = march.step(state, steps, times[k])[0]
    assert state.fluid is not None
    return state.fluid


def displacement_of(problem: Problem) -> Callable[[float], Array]:
    """Displacement (k, 2) of the driven nodes as a function of time, of a scene with one motion."""
    assert problem.fluid is not None
    assert problem.fluid.motion is not None
    (motion,) = problem.case.motions
    x, y = problem.fluid.mesh.points[problem.fluid.motion.driven.nodes].T

    def displacement(time: float) -> Array:
        return np.stack([part.evaluate(x=x, y=y, t=time) for part in (motion.x, motion.y)], axis=-1)

    return displacement
