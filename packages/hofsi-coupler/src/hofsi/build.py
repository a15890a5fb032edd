"""From a case to a problem that can be simulated: only what the case needs is imported and built."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hoblock import BlockStructure, HoblockError, MoverError, QuadMesh, det_jacobian_bounds, generate
from hoblock.building import build_structure
from hofsi import case
from hofsi.case_checks import check_order
from hofsi.clock import Clock
from hofsi.counts import Counts
from hofsi.errors import CaseError
from hofsi.marching import FluidMarch, March, SolidMarch

if TYPE_CHECKING:
    from hoblock.motion import DrivenEdges
    from hofsi.coupling.interface import Interface
    from hofsi.coupling.relaxation import Accelerator
    from hofsi.motion import MeshMotion
    from hofsi.solvers.fluid import FluidSolver
    from hofsi.solvers.solid import SolidSolver

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["FluidPart", "Problem", "SolidPart", "build"]

_SAME_PLACE = 1e-9  # of the mesh's extent: motions that differ by more where they meet contradict each other


@dataclass(frozen=True, eq=False)
class FluidPart:
    """The fluid's share of the mesh, its solver, and its motion if it moves."""

    structure: BlockStructure
    mesh: QuadMesh
    solver: FluidSolver
    motion: MeshMotion | None = None


@dataclass(frozen=True, eq=False)
class SolidPart:
    """The solids' share of the mesh, and their solver."""

    structure: BlockStructure
    mesh: QuadMesh
    solver: SolidSolver


@dataclass(frozen=True, eq=False)
class Problem:
    """A case, built.

    Attributes
    ----------
    case : Case
    march : March
    fluid : FluidPart or None
    solid : SolidPart or None
    interface : Interface or None
    clock : Clock
        Seconds by phase.
    """

    case: case.Case
    march: March
    fluid: FluidPart | None
    solid: SolidPart | None
    interface: Interface | None
    clock: Clock

    @property
    def counts(self) -> dict[str, Counts]:
        """What the solvers did, by field."""
        parts = {"fluid": self.fluid, "solid": self.solid}
        return {name: part.solver.counts for name, part in parts.items() if part is not None}


def build(asked: case.Case) -> Problem:
    """Build meshes, solvers and coupling.

    Parameters
    ----------
    asked : Case

    Raises
    ------
    HoblockError
        If the mesh cannot be made.
    CaseError
        If the case asks for something that the mesh cannot give.
    """
    clock = Clock()
    with clock.phase("build"):
        structure = build_structure(asked.mesh)
        solid_blocks = [name for solid in asked.solids for name in solid.blocks]
        if asked.fluid is None:
            return _solid_alone(asked, structure, solid_blocks, clock)
        fluid = structure.restricted(asked.fluid.blocks)
        mesh = _mesh(fluid, asked.mesh.order)
        if not asked.solids:
            return _fluid_alone(asked, fluid, mesh, clock)
        return _coupled(asked, fluid, mesh, structure.restricted(solid_blocks), clock)


def _mesh(structure: BlockStructure, order: int) -> QuadMesh:
    try:
        return generate(structure, order)
    except HoblockError as error:
        raise CaseError(str(error), "mesh") from error


def _solid_alone(asked: case.Case, structure: BlockStructure, blocks: list[str], clock: Clock) -> Problem:
    from hofsi.solvers.solid import SolidSolver

    part = structure.restricted(blocks)
    mesh = _mesh(part, asked.mesh.order)
    solver = SolidSolver(mesh, asked.solids, asked.nonlinear, asked.linear, asked.scheme)
    return Problem(asked, SolidMarch(solver, clock), None, SolidPart(part, mesh, solver), None, clock)


def _fluid_alone(asked: case.Case, structure: BlockStructure, mesh: QuadMesh, clock: Clock) -> Problem:
    from hofsi.solvers.fluid import FluidSolver

    assert asked.fluid is not None
    check_order(asked)
    motion = displacement = moving = None
    if asked.motions:
        driven, displacement = _driven(asked, structure, mesh, ())
        motion = _motion(asked.mover, structure, mesh, driven)
        reference, moving = motion.reference, driven.nodes
    else:
        from hofsi.motion import MeshState

        nothing = np.zeros((0, 2))
        bound = float(det_jacobian_bounds(mesh)[0].min())
        reference = MeshState(mesh, structure.vertices, nothing, bound, structure_of=lambda: structure)
    nobody = np.zeros(0, dtype=np.int64)
    solver = FluidSolver(mesh, asked.fluid, asked.nonlinear, asked.linear, nobody, moving)
    march = FluidMarch(solver, reference, motion, displacement, clock)
    return Problem(asked, march, FluidPart(structure, mesh, solver, motion), None, None, clock)


def _coupled(asked: case.Case, fluid: BlockStructure, mesh: QuadMesh, solid: BlockStructure, clock: Clock) -> Problem:
    from hofsi.coupling.interface import match_interface
    from hofsi.coupling.partitioned import CoupledMarch
    from hofsi.solvers.fluid import FluidSolver
    from hofsi.solvers.solid import SolidSolver

    assert asked.fluid is not None
    check_order(asked)
    order = asked.mesh.order
    interface = match_interface(fluid, solid, order)
    solid_mesh = _mesh(solid, order)
    driven, prescribed = _driven(asked, fluid, mesh, interface.fluid_edges)
    motion = _motion(asked.mover, fluid, mesh, driven)
    fluid_solver = FluidSolver(mesh, asked.fluid, asked.nonlinear, asked.linear, interface.fluid, driven.nodes)
    solid_solver = SolidSolver(solid_mesh, asked.solids, asked.nonlinear, asked.linear, asked.scheme)
    march = CoupledMarch(
        fluid_solver, solid_solver, interface, motion, prescribed, asked.coupling, _accelerator(asked.coupling), clock
    )
    parts = FluidPart(fluid, mesh, fluid_solver, motion), SolidPart(solid, solid_mesh, solid_solver)
    return Problem(asked, march, *parts, interface, clock)


def _motion(settings: case.MoverSettings, structure: BlockStructure, mesh: QuadMesh, driven: DrivenEdges) -> MeshMotion:
    """Mover and motion of the fluid's mesh."""
    from hofsi.motion import MeshMotion
    from hofsi.movers import make_mover

    try:
        mover = make_mover(settings, structure, mesh, driven)
        return MeshMotion(structure, mesh, mover, driven, inherit=settings.inherit, halvings=settings.halvings)
    except MoverError as error:
        raise CaseError(str(error), "mover") from error


def _driven(
    asked: case.Case, structure: BlockStructure, mesh: QuadMesh, wet: tuple[int, ...]
) -> tuple[DrivenEdges, Callable[[float], Array]]:
    """Driven edges of the fluid and their prescribed displacement as a function of time."""
    from hoblock.motion import driven_edges

    groups = structure.topology.edge_groups
    moving = [int(edge) for motion in asked.motions for name in motion.on for edge in groups[name]]
    driven = driven_edges(structure, mesh.order, tuple(dict.fromkeys([*wet, *moving])))
    terms = []
    for motion in asked.motions:
        nodes = np.unique(np.concatenate([mesh.edge_nodes(name) for name in motion.on]))
        terms.append((np.searchsorted(driven.nodes, nodes), *mesh.points[nodes].T, motion))

    extent = float(np.ptp(mesh.points, axis=0).max())

    def displacement(time: float) -> Array:
        result, given = np.zeros((len(driven.nodes), 2)), np.zeros(len(driven.nodes), dtype=bool)
        for rows, x, y, motion in terms:
            values = np.stack([component.evaluate(x=x, y=y, t=time) for component in (motion.x, motion.y)], axis=-1)
            apart = np.where(given[rows], np.abs(values - result[rows]).max(axis=1), 0.0)
            if apart.max(initial=0.0) > _SAME_PLACE * extent:
                k = int(np.argmax(apart))
                here, before = (f"({v[0]:.6g}, {v[1]:.6g})" for v in (values[k], result[rows[k]]))
                raise CaseError(
                    f"at ({x[k]:.6g}, {y[k]:.6g}) and t = {time:g} it gives the displacement {here}, and a motion "
                    f"before it {before}; expected the same where their edges meet. Correct one of them",
                    motion.place,
                )
            result[rows], given[rows] = values, True
        return result

    return driven, displacement


def _accelerator(settings: case.CouplingSettings) -> Accelerator:
    if settings.acceleration == "iqn-ils":
        from hofsi.coupling.quasi_newton import InverseLeastSquares

        return InverseLeastSquares(settings.reuse, settings.filter, settings.relaxation)
    if settings.acceleration == "imvj":
        from hofsi.coupling.multi_vector import MultiVector

        return MultiVector(settings.reuse, settings.filter, settings.relaxation)
    from hofsi.coupling.relaxation import Aitken, ConstantRelaxation

    return Aitken(settings.relaxation) if settings.acceleration == "aitken" else ConstantRelaxation(settings.relaxation)
