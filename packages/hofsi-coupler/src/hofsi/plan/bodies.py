"""What a run builds of a fluid and of solids."""

from __future__ import annotations

from collections.abc import Iterator

from hoblock.blocks import BlockStructure
from hoblock.mesh import QuadMesh
from hoblock.quality import scaled_jacobian
from hofsi.case import Case, Fluid, Solid
from hofsi.plan.facts import convection_of_steps, counted, iterates
from hofsi.plan.meshes import Meshes
from hofsi.plan.report import Item
from hofsi.plan.sizes import condensed_fluid, condensed_solid, linear_solvers, pressures

__all__ = ["fluid_items", "solid_items"]

_LAWS = {"linear": "linear elasticity", "st-venant-kirchhoff": "St. Venant–Kirchhoff", "neo-hooke": "neo-Hookean"}
_MODELS = {"navier-stokes": "Navier–Stokes", "stokes": "Stokes"}


def _mesh(structure: BlockStructure, mesh: QuadMesh) -> str:
    worst = float(scaled_jacobian(mesh).min())
    return (
        f"{counted(len(structure.topology.quads), 'block')}, {counted(len(mesh.cells), 'element')} of order "
        f"{mesh.order}, {len(mesh.points)} nodes, worst scaled Jacobian {worst:.2f}"
    )


def fluid_items(case: Case, meshes: Meshes) -> Iterator[Item]:
    """The fluid, its mesh and how its equations are solved."""
    if case.fluid is None or meshes.fluid is None:
        return
    structure, mesh = meshes.fluid
    yield Item("fluid mesh", _mesh(structure, mesh))
    yield Item(
        "fluid",
        f"{_MODELS[case.fluid.model]}, ρ = {case.fluid.density:g}, μ = {case.fluid.viscosity:g}; "
        f"{2 * len(mesh.points)} unknowns of velocity and {pressures(mesh)} of pressure, given ones included",
    )
    form = "; in the skew-symmetric form" if case.fluid.skew_symmetric else ""
    if iterates(case, case.fluid):
        method = "Picard's" if case.fluid.convection == "picard" else "Newton's"
        yield Item("convection", f"{method} iteration to a relative residual of {case.nonlinear.tolerance:g}{form}")
    elif case.fluid.model == "navier-stokes":
        convects = convection_of_steps(case, case.fluid) == "extrapolated"
        how = "convection with" if convects else "Newton's linearisation about"
        yield Item("convection", f"{how} the velocity extrapolated to second order: linear steps{form}")
    solver = {
        "direct": f"sparse LU of {condensed_fluid(mesh)} unknowns after static condensation",
        "amg": f"FGMRES with multigrid on nested meshes to a relative residual of {case.linear.tolerance:g}",
    }
    choice = linear_solvers(case, meshes)["fluid"]
    why = f"; {choice.reason}" if case.linear.solver == "auto" else ""
    yield Item("fluid's linear solver", f"{solver[choice.solver]}{why}")


def solid_items(case: Case, meshes: Meshes) -> Iterator[Item]:
    """The solids, their mesh and how their equations are solved."""
    if meshes.solid is None:
        return
    structure, mesh = meshes.solid
    solver = {"direct": "sparse LU", "amg": f"algebraic multigrid to a relative residual of {case.linear.tolerance:g}"}
    yield Item("solid mesh", _mesh(structure, mesh))
    yield Item(
        "solid",
        f"{2 * len(mesh.points)} unknowns of displacement, given ones included; "
        f"{condensed_solid(mesh)} after static condensation, {solver[linear_solvers(case, meshes)['solid'].solver]}",
    )
    for solid in case.solids:
        yield Item(f"solid {solid.name!r}", _material(solid, case.fluid))
    if case.scheme.name == "generalised-alpha":
        yield Item("solid in time", f"generalised-α method, spectral radius {case.scheme.spectral_radius:g}")
    elif case.scheme.name == "energy-momentum":
        yield Item("solid in time", "midpoint rule with mean strains, which keeps energy and momentum")


def _material(solid: Solid, fluid: Fluid | None) -> str:
    ratio = f"; density ratio solid/fluid {solid.density / fluid.density:.4g}" if fluid else ""
    return (
        f"{_LAWS[solid.model]}, plane {solid.plane}, E = {solid.youngs_modulus:g}, ν = {solid.poissons_ratio:g}, "
        f"ρ = {solid.density:g}{ratio}"
    )
