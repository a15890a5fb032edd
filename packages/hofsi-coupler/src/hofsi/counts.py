"""How often a solver did its expensive things."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

__all__ = ["Counts"]


@dataclass
class Counts:
    """How often a solver did its expensive things.

    Attributes
    ----------
    geometries : int
        Geometry factors of a whole mesh.
    constant_assemblies : int
        Element matrices without the terms that change from iteration to iteration.
    elements_kept : int
        Elements of new meshes that stand where they stood: these matrices are kept.
    assemblies : int
        Element matrices that are factorised.
    factorisations, solves : int
    responses : int
        Answers of a fluid to another velocity of its interface that took a product with a small matrix only.
    iterations : int
        Nonlinear iterations.
    continuation_steps : int
        Easier problems, and the one asked for, that were tried where Newton's method alone had failed.
    backflows : int
        Matrices in which fluid comes back through a stabilised outlet.
    iterations_below : int
        Nonlinear iterations at lower orders that found where to start.
    linear_iterations : int
        Of linear solutions that are iterated, summed.
    preconditioners : int
        Preconditioners of iterative solvers that were made; each serves as long as it pays.
    reasons : dict of str to int
        Why matrices were factorised, and how often.
    """

    geometries: int = 0
    constant_assemblies: int = 0
    elements_kept: int = 0
    assemblies: int = 0
    factorisations: int = 0
    solves: int = 0
    responses: int = 0
    iterations: int = 0
    continuation_steps: int = 0
    backflows: int = 0
    iterations_below: int = 0
    linear_iterations: int = 0
    preconditioners: int = 0
    reasons: dict[str, int] = field(default_factory=dict)

    def copy(self) -> Counts:
        """Return the counts as they stand now."""
        return replace(self, reasons=dict(self.reasons))

    def recall(self, counts: Counts) -> None:
        """Take over other counts."""
        vars(self).update(vars(counts.copy()))

    def factorised(self, reason: str) -> None:
        """Count a factorisation and why it was made."""
        self.factorisations += 1
        self.reasons[reason] = self.reasons.get(reason, 0) + 1
