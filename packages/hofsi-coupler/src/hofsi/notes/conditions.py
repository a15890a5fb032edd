"""Boundary conditions that contradict each other where edges meet."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hofsi import case
from hofsi.build import FluidPart
from hofsi.fem.normals import consistent_normals

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["contradictions"]

_SAME = 1e-9  # of the largest given velocity: differences that are rounding


def contradictions(fluid: FluidPart, time: float) -> Iterator[str]:
    """Say which conditions do not hold at some nodes because others come first there, at a time.

    Nodes that a motion or a solid drives are left out: what they give is known only during the run.
    """
    solver, points = fluid.solver, fluid.mesh.points
    still, nobody = np.zeros(points.shape), np.zeros((len(solver.boundary.interface), 2))
    velocity = solver.boundary.impose(still, points, still, nobody, time)
    moving = np.zeros(0, dtype=np.int64) if fluid.motion is None else fluid.motion.driven.nodes
    scale = float(np.abs(velocity).max())
    for condition in solver.fluid.boundaries:
        for nodes, asked, has in _expected(fluid, condition, velocity, time):
            apart = np.where(np.isin(nodes, moving), 0.0, np.abs(asked - has))
            if apart.max(initial=0.0) > _SAME * max(scale, float(np.abs(asked).max())):
                yield _sentence(condition.place, points, nodes[apart > _SAME * scale], nodes, asked, has, apart)
                break


def _expected(
    fluid: FluidPart, condition: case.FluidCondition, velocity: Array, time: float
) -> Iterator[tuple[Index, Array, Array]]:
    """Nodes of a condition, what it wants of the velocity there, and what is there."""
    mesh, space = fluid.mesh, fluid.solver.space
    if isinstance(condition, case.Velocity):
        nodes = np.unique(np.concatenate([mesh.edge_nodes(name) for name in condition.on]))
        x, y = mesh.points[nodes].T
        for axis, component in enumerate((condition.x, condition.y)):
            if component is not None:
                yield nodes, component.evaluate(x=x, y=y, t=time), velocity[nodes, axis]
    elif isinstance(condition, case.Slip):
        sides = np.concatenate([mesh.edge_groups[name] for name in condition.on])
        X, nodes = mesh.points[space.velocity_cells], space.velocity_unknowns
        for entry in consistent_normals(X, nodes, sides, space.velocity_sides):
            yield entry.nodes, np.zeros(len(entry.nodes)), np.sum(entry.directions * velocity[entry.nodes], axis=1)


def _sentence(place: str, points: Array, wrong: Index, nodes: Index, asked: Array, has: Array, apart: Array) -> str:
    worst = int(np.argmax(apart))
    x, y = points[nodes[worst]]
    more = "" if len(wrong) < 2 else f" and {len(wrong) - 1} more node" + ("s" if len(wrong) > 2 else "")
    return (
        f"{place}: at ({x:.6g}, {y:.6g}){more} it gives the velocity {asked[worst]:.4g}, and a condition that comes "
        f"first there {has[worst]:.4g}, which counts (no-slip, then given velocities in the order of the scene, then "
        "slip). Let them agree where their edges meet if the jump is not meant"
    )
