"""The linear systems of solids, direct or iterative as the case asks for."""

from __future__ import annotations

from functools import partial

import scipy.sparse as sp

from hofsi.case import LinearSettings
from hofsi.counts import Counts
from hofsi.fem.coarsening import skeleton_coarsening
from hofsi.fem.condensation import CondensedSystem
from hofsi.linear.amg import Coarsening, PatchMultigrid
from hofsi.linear.choice import choose_solver
from hofsi.linear.krylov import KrylovSolver
from hofsi.solvers.solid_equations import SolidEquations
from hofsi.solvers.solid_supports import SolidSupports

__all__ = ["solid_system"]


def solid_system(
    equations: SolidEquations, supports: SolidSupports, linear: LinearSettings, counts: Counts
) -> CondensedSystem:
    """Choose the linear systems of solids.

    With "amg" the condensed matrix is solved by FGMRES, preconditioned by one multigrid cycle that knows the rigid body
    motions. The residual then reaches the tolerance or, in thin plates, what rounding leaves.

    Parameters
    ----------
    equations : SolidEquations
    supports : SolidSupports
    linear : LinearSettings
    counts : Counts
        Where iterations and preconditioners are counted.
    """
    mesh = equations.mesh
    size, constraints = 2 * len(mesh.points), supports.constraints
    places = mesh.points[mesh.cells].mean(axis=1)
    system = CondensedSystem(equations.dofs, equations.boundary, size, constraints, places=places)
    if choose_solver(linear.solver, size - system.inner * len(system.dofs)).solver == "direct":
        return system
    nodes = equations.dofs[:, : equations.boundary : 2] // 2
    coarsening = skeleton_coarsening(nodes, mesh.order, constraints, system.unknowns, mesh.points)
    return system.solved_by(partial(_multigrid_solver, coarsening, linear.tolerance, counts))


def _multigrid_solver(coarsening: Coarsening, tolerance: float, counts: Counts, matrix: sp.csc_matrix) -> KrylovSolver:
    counts.preconditioners += 1
    return KrylovSolver(matrix, PatchMultigrid(matrix, coarsening, symmetric=True), tolerance, counts)
