"""What the steps of solids have in common: discretisation, supports, linear systems, and a tangent that is kept."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hofsi import case
from hofsi.counts import Counts
from hofsi.linear.checked import CheckedSolver
from hofsi.solvers.load_response import unknowns_of
from hofsi.solvers.solid_equations import SolidEquations
from hofsi.solvers.solid_newton import Tangent
from hofsi.solvers.solid_state import SolidMemory
from hofsi.solvers.solid_supports import SolidSupports
from hofsi.solvers.solid_system import solid_system

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["SolidProblem"]


class SolidProblem:
    """Discretisation of one or several elastic solids.

    Parameters
    ----------
    mesh : QuadMesh
        The solids' blocks only, undeformed.
    solids : sequence of Solid
    nonlinear : NonlinearSettings
    linear : LinearSettings, optional
        By default sparse LU.
    scheme : SolidScheme, optional
        Of time steps; by default backward differences.

    Attributes
    ----------
    equations : SolidEquations
    supports : SolidSupports
    system : CondensedSystem
        The linear systems: LU or multigrid.
    counts : Counts
        What was done so far.
    """

    def __init__(
        self,
        mesh: QuadMesh,
        solids: Sequence[case.Solid],
        nonlinear: case.NonlinearSettings,
        linear: case.LinearSettings | None = None,
        scheme: case.SolidScheme | None = None,
    ) -> None:
        self.scheme = scheme or case.SolidScheme()
        self.mesh, self.solids, self.nonlinear = mesh, tuple(solids), nonlinear
        self.equations = SolidEquations(mesh, solids)
        self.supports = SolidSupports(mesh, solids, self.equations.cells_of)
        self.counts = Counts()
        self.system = solid_system(self.equations, self.supports, linear or case.LinearSettings(), self.counts)
        self._tangent: Tangent | None = None

    def takes_response(self, nodes: Index) -> bool:
        """Whether loads may answer to displacements of some nodes: not with iterative solvers or inclined rollers."""
        return self.system.tells_flexibility(unknowns_of(nodes))

    def keep(self, tangent: Tangent | None) -> None:
        """Keep a tangent for later steps if it holds for them: if all solids are linear."""
        if self.equations.linear:
            self._tangent = tangent

    def memory(self) -> SolidMemory:
        """What is kept between steps, so that `resume` can make it again."""
        kept = self._tangent
        if kept is None:
            return SolidMemory(self.counts.copy())
        factor = kept.factor.factor
        return SolidMemory(self.counts.copy(), kept.mass_factor, isinstance(factor, CheckedSolver) and factor.fell_back)

    def resume(self, memory: SolidMemory) -> None:
        """Become what the solver was when `memory` was asked for.

        The tangent of linear solids depends on neither displacement nor loads.
        """
        self._tangent = None
        if memory.mass_factor is not None and self.equations.linear:
            gradient = self.equations.gradient(np.zeros(self.mesh.points.shape))
            K = self.equations.tangent(gradient, self.equations.stress(gradient), memory.mass_factor, ())
            factor = self.system.factorise(K)
            if memory.fell_back and isinstance(factor.factor, CheckedSolver):
                factor.factor.fall_back()
            self._tangent = Tangent(memory.mass_factor, K, factor)
        self.counts.recall(memory.counts)

    def tangent(self, mass_factor: float) -> Tangent | None:
        """Return the tangent that was kept, if it holds for a step with this mass factor."""
        kept = self._tangent
        return kept if kept is not None and kept.mass_factor == mass_factor else None
