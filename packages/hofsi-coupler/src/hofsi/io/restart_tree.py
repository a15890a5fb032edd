"""Trees of plain values, arrays and the records of a run, as JSON text and a list of arrays, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["TreeReader", "TreeWriter"]

Numbers = NDArray[Any]

_KIND = "kind"

_MODULES = {
    "AitkenMemory": "hofsi.coupling.relaxation",
    "ControlMemory": "hofsi.timestepping.control",
    "Counts": "hofsi.counts",
    "CoupledMemory": "hofsi.coupling.coupled_memory",
    "CouplingRecord": "hofsi.records",
    "CycleMemory": "hofsi.fem.saddle_point",
    "ErrorMemory": "hofsi.timestepping.local_error",
    "FactorsMemory": "hofsi.solvers.fluid_factors",
    "FluidMemory": "hofsi.solvers.fluid_memory",
    "FluidState": "hofsi.solvers.fluid_state",
    "JacobianMemory": "hofsi.coupling.multi_vector",
    "MatrixOrigin": "hofsi.solvers.fluid_matrices",
    "MeshPosition": "hofsi.motion",
    "Rejection": "hofsi.records",
    "RunMemory": "hofsi.records",
    "SecantMemory": "hofsi.coupling.quasi_newton",
    "SolidMemory": "hofsi.solvers.solid_state",
    "SolidState": "hofsi.solvers.solid_state",
    "State": "hofsi.records",
    "StepRecord": "hofsi.records",
    "SystemOrigin": "hofsi.solvers.fluid_system",
    "Unsteady": "hofsi.case",
}
"""The only classes whose objects a file may hold, and where they are."""


class TreeWriter:
    """Turns a tree into what JSON knows; arrays are put aside, each once.

    Parameters
    ----------
    known : mapping of str to ndarray
        Arrays that the reader has already, by name.

    Attributes
    ----------
    arrays : list of ndarray
    """

    def __init__(self, known: Mapping[str, Numbers]) -> None:
        self.arrays: list[Numbers] = []
        self._names: dict[int, dict[str, Any]] = {
            id(array): {_KIND: "known", "name": name} for name, array in known.items()
        }

    def plain(self, value: object) -> Any:
        """Return a value as JSON knows it.

        Raises
        ------
        TypeError
            If it is of a class that is not listed.
        """
        if value is None or isinstance(value, bool | str):
            return value
        if isinstance(value, np.ndarray):
            return self._named(value)
        if isinstance(value, np.generic):
            return self.plain(value.item())
        if isinstance(value, int):
            return value
        if isinstance(value, float):
            return value if math.isfinite(value) else {_KIND: "float", "value": repr(value)}
        if isinstance(value, tuple):
            return {_KIND: "tuple", "items": [self.plain(item) for item in value]}
        if isinstance(value, list):
            return [self.plain(item) for item in value]
        if isinstance(value, Mapping):
            return {_KIND: "mapping", "items": {str(key): self.plain(item) for key, item in value.items()}}
        name = type(value).__name__
        if is_dataclass(value) and _MODULES.get(name) is not None:
            return {
                _KIND: name,
                "fields": {item.name: self.plain(getattr(value, item.name)) for item in fields(value) if item.init},
            }
        raise TypeError(f"restart file: got a {name}; expected plain values, arrays, or one of {sorted(_MODULES)}.")

    def _named(self, array: Numbers) -> dict[str, Any]:
        if id(array) not in self._names:
            self._names[id(array)] = {_KIND: "array", "number": len(self.arrays)}
            self.arrays.append(array)
        return self._names[id(array)]


class TreeReader:
    """Turns what `TreeWriter` made into the tree again; what was one array is one array again.

    Parameters
    ----------
    arrays : list of ndarray
        An array may be exchanged for another with the same numbers before a tree that has it is read.
    known : mapping of str to ndarray
    """

    def __init__(self, arrays: list[Numbers], known: Mapping[str, Numbers]) -> None:
        self.arrays, self._known = arrays, known

    def value(self, plain: Any) -> Any:
        """Return a value.

        Raises
        ------
        ValueError, KeyError, TypeError, IndexError
            If it is not one that was written.
        """
        if isinstance(plain, list):
            return [self.value(item) for item in plain]
        if not isinstance(plain, dict):
            return plain
        match plain[_KIND]:
            case "array":
                return self.arrays[plain["number"]]
            case "known":
                return self._known[plain["name"]]
            case "float":
                return float(plain["value"])
            case "tuple":
                return tuple(self.value(item) for item in plain["items"])
            case "mapping":
                return {key: self.value(item) for key, item in plain["items"].items()}
            case name:
                kind = getattr(import_module(_MODULES[name]), name)
                return kind(**{key: self.value(item) for key, item in plain["fields"].items()})

    def exchange(self, old: Numbers, new: Numbers) -> None:
        """Let another array with the same numbers take the place of one."""
        self.arrays[:] = [new if array is old else array for array in self.arrays]
