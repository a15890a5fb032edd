"""The exceptions of hoblock: one class for each cause.

Every exception that hoblock raises on purpose derives from `HoblockError`, so that a caller can catch
all of them and nothing else. A message says what is wrong, what was found, what was expected, where,
and a way out.
"""

from __future__ import annotations

from typing import Any

__all__ = [
    "CurveError",
    "ExpressionError",
    "FieldError",
    "GradingError",
    "HoblockError",
    "InvalidMeshError",
    "LocationError",
    "MeshFileError",
    "MissingExtraError",
    "MoverError",
    "SceneError",
    "TemplateError",
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


class TemplateError(HoblockError):
    """A template that does not exist, or a parameter that it cannot use.

    Parameters
    ----------
    message : str
        What is wrong, what was found, what was expected, and a way out.
    parameter : str, optional
        Name of the parameter, empty if it is none.

    Attributes
    ----------
    problem, parameter : str
        As given.
    """

    def __init__(self, message: str, parameter: str = "") -> None:
        super().__init__(message, parameter)
        self.problem = message
        self.parameter = parameter

    def __str__(self) -> str:
        return f"{self.parameter}: {self.problem}" if self.parameter else self.problem


class TopologyError(HoblockError):
    """Blocks that do not form a valid structure."""


class CurveError(HoblockError):
    """A curve that does not fit its edge or cannot be evaluated."""


class FieldError(HoblockError):
    """A field whose values do not fit its grid or mesh, or that is asked for outside of it."""


class GradingError(HoblockError):
    """A grading with impossible parameters or one that is not monotonic."""


class InvalidMeshError(HoblockError):
    """A mesh with elements whose Jacobian is not proven positive.

    Parameters
    ----------
    message : str
        How many elements are bad, which, where and why.
    elements : tuple of BadElement, optional
        The worst of them.
    certificate : Certificate, optional
        Of the mesh.

    Attributes
    ----------
    elements, certificate
        As given.
    """

    def __init__(self, message: str, elements: tuple[Any, ...] = (), certificate: Any = None) -> None:
        super().__init__(message, elements, certificate)
        self.elements = elements
        self.certificate = certificate

    def __str__(self) -> str:
        return str(self.args[0])


class LocationError(HoblockError):
    """A place that is outside a mesh."""


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
