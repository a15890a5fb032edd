"""How often a solver did its expensive things."""

from __future__ import annotations

from dataclasses import dataclass

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
    assemblies : int
        Element matrices that are factorised.
    factorisations, solves : int
    iterations : int
        Nonlinear iterations.
    continuation_steps : int
        Easier problems, and the one asked for, that were tried where Newton's method alone had failed.
    linear_iterations : int
        Of iterative linear solvers, summed over their solutions.
    preconditioners : int
        Preconditioners that were made; each serves as long as it pays.
    """

    geometries: int = 0
    constant_assemblies: int = 0
    assemblies: int = 0
    factorisations: int = 0
    solves: int = 0
    iterations: int = 0
    continuation_steps: int = 0
    linear_iterations: int = 0
    preconditioners: int = 0
