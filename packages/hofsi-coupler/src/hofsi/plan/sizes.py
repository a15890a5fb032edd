"""Numbers of unknowns, and the linear solvers that they lead to."""

from __future__ import annotations

from hoblock.mesh import QuadMesh
from hoblock.numbering import number_nodes
from hofsi.case import Case
from hofsi.linear.choice import Choice, choose_solver
from hofsi.plan.meshes import Meshes

__all__ = ["condensed_fluid", "condensed_solid", "linear_solvers", "pressures"]


def pressures(mesh: QuadMesh) -> int:
    """Unknowns of the pressure."""
    return number_nodes(mesh.corners, mesh.order - 1)[1]


def condensed_fluid(mesh: QuadMesh) -> int:
    """Unknowns of the fluid after static condensation, given ones included."""
    p = mesh.order
    return 2 * len(mesh.points) + pressures(mesh) - 2 * _inner(mesh, p) - _inner(mesh, p - 1)


def condensed_solid(mesh: QuadMesh) -> int:
    """Unknowns of the solids after static condensation, given ones included."""
    return 2 * len(mesh.points) - 2 * _inner(mesh, mesh.order)


def _inner(mesh: QuadMesh, order: int) -> int:
    """Nodes of an order inside elements, which static condensation eliminates."""
    return len(mesh.cells) * (order - 1) ** 2


def linear_solvers(case: Case, meshes: Meshes) -> dict[str, Choice]:
    """The linear solvers of "fluid" and "solid", as far as there are such."""
    kept, periodic = {}, case.fluid is not None and case.fluid.periodic
    if meshes.fluid is not None:
        kept["fluid"] = condensed_fluid(meshes.fluid[1])
    if meshes.solid is not None:
        kept["solid"] = condensed_solid(meshes.solid[1])
    return {
        field: choose_solver(case.linear.solver, count, periodic=periodic and field == "fluid")
        for field, count in kept.items()
    }
