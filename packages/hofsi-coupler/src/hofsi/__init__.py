"""hofsi: strongly coupled fluid-structure interaction on moving high-order meshes.

A scene file becomes a `Case`, a case a `Problem`, and `simulate` yields its steps one by one::

    case = hofsi.load_case("scene.toml", ["mesh.order=4"])
    for record in hofsi.simulate(hofsi.build(case)):
        ...

`run` does the same and writes tables, fields and a summary. Importing this package loads NumPy only; solvers are loaded
by `build` as far as a case needs them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

# These functions are called like their modules. Were they loaded on demand, a later import of such a module would put
# it in the function's place.
from hofsi.build import build
from hofsi.run import run
from hofsi.simulate import simulate
from hofsi.version import __version__

if TYPE_CHECKING:
    from hofsi.build import Problem
    from hofsi.case import Case
    from hofsi.errors import (
        AddedMassError,
        CaseError,
        ConvergenceError,
        CouplingError,
        HofsiError,
        LinearSolverError,
        MeshMotionError,
        NewtonError,
        RestartError,
    )
    from hofsi.io.scene import load_case, read_case
    from hofsi.quantities import evaluators
    from hofsi.records import CouplingRecord, State, StepRecord
    from hofsi.report import Result

_MODULES = {
    "AddedMassError": "hofsi.errors",
    "Case": "hofsi.case",
    "CaseError": "hofsi.errors",
    "ConvergenceError": "hofsi.errors",
    "CouplingError": "hofsi.errors",
    "CouplingRecord": "hofsi.records",
    "HofsiError": "hofsi.errors",
    "LinearSolverError": "hofsi.errors",
    "MeshMotionError": "hofsi.errors",
    "NewtonError": "hofsi.errors",
    "RestartError": "hofsi.errors",
    "Problem": "hofsi.build",
    "Result": "hofsi.report",
    "State": "hofsi.records",
    "StepRecord": "hofsi.records",
    "evaluators": "hofsi.quantities",
    "load_case": "hofsi.io.scene",
    "read_case": "hofsi.io.scene",
}

__all__ = [
    "AddedMassError",
    "Case",
    "CaseError",
    "ConvergenceError",
    "CouplingError",
    "CouplingRecord",
    "HofsiError",
    "LinearSolverError",
    "MeshMotionError",
    "NewtonError",
    "Problem",
    "RestartError",
    "Result",
    "State",
    "StepRecord",
    "__version__",
    "build",
    "evaluators",
    "load_case",
    "read_case",
    "run",
    "simulate",
]


def __getattr__(name: str) -> Any:
    """Load a public name when it is first asked for."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_MODULES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Public names, loaded or not."""
    return sorted({*globals(), *__all__})
