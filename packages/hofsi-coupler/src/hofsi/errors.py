"""The exceptions of hofsi: one class for each cause, each with the exit code of the command line.

Every exception that hofsi raises on purpose derives from `HofsiError`. Errors of a mesh or of the ``[mesh]`` part of a
scene come from `hoblock.errors`.
"""

from __future__ import annotations

from copy import copy
from typing import ClassVar, Self

from hoblock.errors import SceneError

__all__ = [
    "AddedMassError",
    "CaseError",
    "ConvergenceError",
    "CouplingError",
    "HofsiError",
    "LinearSolverError",
    "MeshMotionError",
    "NewtonError",
    "RestartError",
]


class HofsiError(Exception):
    """Base of every exception raised on purpose by hofsi.

    Attributes
    ----------
    exit_code : int
        What the command line returns when this error ends a run: 2 for bad input, 3 for a computation that did not
        succeed, 1 for anything else.
    """

    exit_code: ClassVar[int] = 1


class CaseError(HofsiError, SceneError):
    """Bad input: a scene that is well-formed, but whose physics cannot be simulated as it is written.

    Being a `hoblock.errors.SceneError`, it has the attributes ``problem``, ``place`` (for example
    ``"fluid.boundary[2].on"``) and ``file``, and is caught together with mistakes of the format.
    """

    exit_code: ClassVar[int] = 2


class RestartError(HofsiError):
    """A restart file that cannot be read, or that the scene cannot go on from."""

    exit_code: ClassVar[int] = 2


class ConvergenceError(HofsiError):
    """A computation that did not succeed; a smaller time step may.

    Parameters
    ----------
    message : str
        What happened, with numbers, and a way out.
    reason : str, optional
        One or two words for programs, for example ``"max_iterations"``, ``"diverged"``, ``"stalled"``, ``"singular"``.
    where : str, optional
        Field, step and time, for example ``"fluid, step 12, t = 0.06"``.

    Attributes
    ----------
    reason, where : str
        As given.
    """

    exit_code: ClassVar[int] = 3

    def __init__(self, message: str, reason: str = "", where: str = "") -> None:
        super().__init__(message, reason, where)
        self.problem = message
        self.reason = reason
        self.where = where

    def extended(self, text: str) -> Self:
        """Return the same error with a sentence more."""
        problem = f"{self.problem} {text}"
        other = copy(self)
        other.args, other.problem = (problem, self.reason, self.where), problem
        return other

    def __str__(self) -> str:
        return f"{self.where}: {self.problem}" if self.where else self.problem


class NewtonError(ConvergenceError):
    """Newton's method did not reach its tolerance."""


class LinearSolverError(ConvergenceError):
    """A singular matrix, or an iterative solver that did not reach its tolerance."""


class CouplingError(ConvergenceError):
    """Fluid and solid were not brought to agree."""


class AddedMassError(CouplingError):
    """Fluid and solid were not brought to agree, and the fluid's added mass outweighs the solid.

    Smaller steps do not change that: the added mass stays while the solid's stiffness counts less and less.

    Attributes
    ----------
    gain : float
        How many times the loop of fluid and solid answered a displacement by the opposite one; above 1.
    residual : float
        The smallest that was reached, as a multiple of its tolerance.
    """

    def __init__(
        self, message: str, reason: str = "", where: str = "", gain: float = 1.0, residual: float = 1.0
    ) -> None:
        super().__init__(message, reason, where)
        self.gain = gain
        self.residual = residual


class MeshMotionError(ConvergenceError):
    """The fluid mesh cannot follow its moving boundary: an element would become invalid."""
