"""What a run builds to move the mesh and to couple fluid and solid."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.mesh import QuadMesh
from hoblock.motion import driven_edges
from hofsi.case import (
    AngleOptimisationSettings,
    BarrierSettings,
    Case,
    PseudoSolidSettings,
    RuleSettings,
    Steady,
)
from hofsi.movers import placed_vertices
from hofsi.plan.facts import counted, is_coupled, moves
from hofsi.plan.meshes import Meshes
from hofsi.plan.report import Item
from hofsi.plan.sizes import linear_solvers

Index = NDArray[np.int64]

__all__ = ["coupling_items"]

_MOVERS = {
    BarrierSettings: "barrier energy",
    PseudoSolidSettings: "pseudo-solid",
    AngleOptimisationSettings: "angle optimisation",
    RuleSettings: "rule",
}
_ACCELERATIONS = {
    "iqn-ils": "IQN-ILS",
    "imvj": "IMVJ",
    "aitken": "Aitken's relaxation",
    "constant": "constant relaxation",
}


def _mover(case: Case, structure: BlockStructure, mesh: QuadMesh, edges: Index) -> str:
    """What the mover places."""
    driven = driven_edges(structure, mesh.order, edges)
    inside, sliding = placed_vertices(case.mover, structure, driven)
    kind = _MOVERS[type(case.mover)]
    if not inside.size and not sliding.size:
        return (
            f"{kind}: 0 free block vertices follow {len(driven.vertices)} driven ones; between the moving edges and "
            "the boundary the mesh is one block thick and can only be stretched. Add a ring of blocks if that fails"
        )
    free = "1 free block vertex follows" if len(inside) == 1 else f"{len(inside)} free block vertices follow"
    slides = f", {len(sliding)} slide along the boundary" if sliding.size else ""
    return f"{kind}: {free} {len(driven.vertices)} driven ones{slides}"


def coupling_items(case: Case, meshes: Meshes) -> Iterator[Item]:
    """The mover, the interface and the coupling."""
    if moves(case) and meshes.fluid is not None:
        yield Item("mover", _mover(case, *meshes.fluid, meshes.driven))
    if not is_coupled(case):
        return
    settings = case.coupling
    edges, nodes = meshes.wet
    yield Item("interface", f"{counted(edges, 'block edge')}, {nodes} nodes of fluid and solid matched one to one")
    yield Item(
        "coupling",
        f"{_ACCELERATIONS[settings.acceleration]} to {settings.tolerance:g} in displacement and "
        f"{settings.force_tolerance:g} in force, at most {settings.max_iterations} iterations",
    )
    if isinstance(case.time, Steady) or settings.geometry == "implicit":
        yield Item("geometry", "implicit: a new fluid mesh in every coupling iteration")
    else:
        yield Item("geometry", "extrapolated: one fluid mesh a step")
    direct = all(choice.solver == "direct" for choice in linear_solvers(case, meshes).values())
    if settings.condensed and not isinstance(case.time, Steady) and _linear(case) and direct:
        yield Item("condensation", "fluid condensed to the interface, and the solid solved together with it")


def _linear(case: Case) -> bool:
    """Whether steps begin with a linear fluid."""
    assert case.fluid is not None
    implicit = case.coupling.geometry == "implicit"
    return implicit or case.fluid.convection_of_steps(case.coupling) in ("linearised", "extrapolated")
