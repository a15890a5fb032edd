"""The methods that are compared, each made ready for a case."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from full_mesh_movers import (
    Biharmonic,
    Elastic,
    FullMeshMover,
    InterpolatedVertices,
    InverseDistance,
    Laplace,
    MacroElements,
    NeoHooke,
    RadialBasis,
)
from hoblock import QuadMesh, generate
from hoblock.motion import MeshMotion, driven_edges
from hoblock.movers import AngleOptimisation, BarrierEnergy, Mover, PseudoSolid, Rule
from motion_cases import MotionCase

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Move = Callable[[Array], QuadMesh]

__all__ = ["CONTESTANTS", "Contestant", "chosen"]


@dataclass(frozen=True)
class Contestant:
    """A method.

    Attributes
    ----------
    name, family : str
        Family: "blocks" (this project's and the paper's methods, generated anew), "hybrid" or "full mesh".
    begin : callable
        (case, order) → (mesh of the reference, positions of the body's nodes → mesh); each call of the latter goes on
        from the last mesh, which methods that depend on the way need.
    """

    name: str
    family: str
    begin: Callable[[MotionCase, int], tuple[QuadMesh, Array, Move]]


def _blocks(name: str, make: Callable[[MotionCase], Mover], family: str = "blocks") -> Contestant:
    def begin(case: MotionCase, order: int) -> tuple[QuadMesh, Array, Move]:
        motion = MeshMotion(case.structure, order, case.edges, make(case), halvings=0)
        state = motion.start()

        def move(positions: Array) -> QuadMesh:
            nonlocal state
            state = motion.move(state, positions)
            return state.mesh

        return state.mesh, motion.reference.positions, move

    return Contestant(name, family, begin)


def _full_mesh(
    name: str, make: Callable[[QuadMesh, Index, Index], FullMeshMover], family: str = "full mesh"
) -> Contestant:
    def begin(case: MotionCase, order: int) -> tuple[QuadMesh, Array, Move]:
        mesh = generate(case.structure, order)
        driven = driven_edges(case.structure, order, case.edges).nodes
        mover = make(mesh, driven, np.setdiff1d(boundary_nodes(case, order), driven))
        points = mesh.points

        def move(positions: Array) -> QuadMesh:
            nonlocal points
            points = mover.move(points, positions)
            return mesh.with_points(points)

        return mesh, mesh.points[driven], move

    return Contestant(name, family, begin)


def boundary_nodes(case: MotionCase, order: int) -> Index:
    """All nodes on the boundary of a case's mesh."""
    outer = np.flatnonzero(case.structure.topology.blocks_per_edge == 1)
    return driven_edges(case.structure, order, outer).nodes


def _barrier(energy: str, slides: bool) -> Callable[[MotionCase], Mover]:
    return lambda case: BarrierEnergy(
        case.structure, case.driven, edges=case.edges, energy=energy, sliding=case.sliding if slides else None
    )


def _solid(exponent: float, incremental: bool = False, slides: bool = False) -> Callable[[MotionCase], Mover]:
    return lambda case: PseudoSolid(
        case.structure,
        case.driven,
        exponent=exponent,
        incremental=incremental,
        sliding=case.sliding if slides else None,
    )


def _interpolated(method: str) -> Callable[[MotionCase], Mover]:
    def make(case: MotionCase) -> Mover:
        matrix = InterpolatedVertices(case.structure, case.driven, method).matrix
        return Rule(case.structure, case.driven, lambda displacement: matrix @ displacement)

    return make


CONTESTANTS: tuple[Contestant, ...] = (
    _blocks("barrier, bar", _barrier("bar", False)),
    _blocks("barrier, bar, sliding", _barrier("bar", True)),
    _blocks("barrier, ang", _barrier("ang", False)),
    _blocks("barrier, ang, sliding", _barrier("ang", True)),
    _blocks("pseudo-solid, m = -2", _solid(-2.0)),
    _blocks("pseudo-solid, m = -1", _solid(-1.0)),
    _blocks("pseudo-solid, m = -1, sliding", _solid(-1.0, slides=True)),
    _blocks("pseudo-solid, m = 1 (published)", _solid(1.0)),
    _blocks("pseudo-solid, m = 3 (published)", _solid(3.0)),
    _blocks("pseudo-solid, m = -1, incremental", _solid(-1.0, incremental=True)),
    _blocks("pseudo-solid, m = 1, incremental", _solid(1.0, incremental=True)),
    _blocks("angles, published", lambda case: AngleOptimisation.as_published(case.structure, case.driven)),
    _blocks("angles, best setting", lambda case: AngleOptimisation(case.structure, case.driven)),
    _blocks(
        "angles, best setting, sliding",
        lambda case: AngleOptimisation(case.structure, case.driven, sliding=case.sliding),
    ),
    _blocks("RBF on block vertices", _interpolated("rbf"), "hybrid"),
    _blocks("IDW on block vertices", _interpolated("idw"), "hybrid"),
    _full_mesh("macro-elements", MacroElements, "hybrid"),
    _full_mesh("macro-elements, incremental", lambda *a: MacroElements(*a, incremental=True), "hybrid"),
    _full_mesh("Laplace", Laplace),
    _full_mesh("Laplace, incremental", lambda *a: Laplace(*a, incremental=True)),
    _full_mesh("pseudo-solid, det J dropped", lambda *a: Elastic(*a, stiffening="jacobian")),
    _full_mesh("pseudo-solid", Elastic),
    _full_mesh("pseudo-solid, incremental", lambda *a: Elastic(*a, exponent=-1.5, incremental=True)),
    _full_mesh("biharmonic", Biharmonic),
    _full_mesh("biharmonic, incremental", lambda *a: Biharmonic(*a, normals="turned", incremental=True)),
    _full_mesh("neo-Hooke", NeoHooke),
    _full_mesh("RBF", RadialBasis),
    _full_mesh("RBF, incremental", lambda *a: RadialBasis(*a, incremental=True)),
    _full_mesh("IDW", InverseDistance),
    _full_mesh("IDW, with rotations", lambda *a: InverseDistance(*a, rotations=True)),
)


def chosen(families: list[str] | None, names: list[str] | None) -> list[Contestant]:
    """The contestants of some families whose names contain one of some words; all by default."""
    return [
        one
        for one in CONTESTANTS
        if (not families or one.family in families) and (not names or any(name in one.name for name in names))
    ]
