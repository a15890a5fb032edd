"""The exceptions of hoblock: one class for each cause.

Every exception that hoblock raises on purpose derives from `HoblockError`, so that a caller can catch
all of them and nothing else. A message says what is wrong, what was found, what was expected, where,
and a way out.
"""

from __future__ import annotations

__all__ = [
    "CurveError",
    "ExpressionError",
    "GradingError",
    "HoblockError",
    "InvalidMeshError",
    "MeshFileError",
    "MissingExtraError",
    "MoverError",
    "SceneError",
    "TopologyError",
]


class HoblockError(Exception):
    """Base of every exception raised on purpose by hoblock."""


class SceneError(HoblockError):
    """Bad input in a scene.

    Parameters
    ----------
    message : str
        What is wrong, what was found, what was expected, and a way out, without the place.
    place : str, optional
        Where in the scene, for example ``"mesh.curve[3].center"``. Empty if there is no such place.

    Attributes
    ----------
    place : str
        As given.
    problem : str
        The message without the place.
    file : str
        The scene file, once a reader has filled it in; empty before.
    """

    def __init__(self, message: str, place: str = "") -> None:
        super().__init__(message, place)
        self.problem = message
        self.place = place
        self.file = ""

    def __str__(self) -> str:
        return ": ".join(part for part in (self.file, self.place, self.problem) if part)


class ExpressionError(SceneError):
    """An expression that cannot be read, or whose value is not finite."""


class TopologyError(HoblockError):
    """Blocks that do not form a valid structure."""


class CurveError(HoblockError):
    """A curve that does not fit its edge or cannot be evaluated."""


class GradingError(HoblockError):
    """A grading with impossible parameters or one that is not monotonic."""


class InvalidMeshError(HoblockError):
    """A mesh with an element whose Jacobian is not positive."""


class MeshFileError(HoblockError):
    """A mesh that a file format cannot hold, or a file that holds no mesh."""


class MoverError(HoblockError):
    """A mesh mover that cannot produce a valid mesh."""


class MissingExtraError(HoblockError):
    """A feature that needs an optional package that is not installed.

    Parameters
    ----------
    message : str
        What is missing and the command that installs it.
    module : str, optional
        Name of the module that could not be imported.
    extra : str, optional
        Name of the extra that brings the module.

    Attributes
    ----------
    module, extra : str
        As given.
    """

    def __init__(self, message: str, module: str = "", extra: str = "") -> None:
        super().__init__(message, module, extra)
        self.module = module
        self.extra = extra

    def __str__(self) -> str:
        return str(self.args[0])
