"""Benchmarks on their smallest settings, each run once."""

from __future__ import annotations

import importlib
import io
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"
TINY = {
    "curve_accuracy": ["--orders", "1", "3", "--elements", "8", "16", "--kinds", "arc", "nurbs, degree 3", "spline"],
    "flag_oscillations": ["fsi3", "--orders", "2", "--set", "time.end=0.01"],
    "fluid_linear_solvers": ["--orders", "2", "--k", "2", "--problems", "stokes", "step 0.01"],
    "fluid_order": ["--orders", "2", "--elements", "1", "2", "--meshes", "blocks", "pseudo-solid"],
    "fsi_order": [
        "--orders",
        "2",
        "--cases",
        "piston",
        "--geometries",
        "extrapolated",
        "--steps",
        "10",
        "20",
        "--flap",
        "6",
        "12",
        "24",
    ],
    "fluid_work_precision": ["--orders", "2", "4", "--counts", "1,2,6,2"],
    "fsi1_work_precision": ["--quick"],
    "guard": ["--steps", "1", "--cases", "CSM"],
    "mesh_generation": ["--nodes", "2000", "--orders", "2", "--blocks", "1", "4", "--repeats", "2"],
    "mesh_scaling": ["--nodes", "2000", "9000", "--order", "2", "--repeats", "2"],
    "mesh_motion": [
        "--steps",
        "6",
        "--orders",
        "2",
        "--elements",
        "1",
        "--tests",
        "T3a",
        "--layouts",
        "cross4x",
    ],
    "mesh_motion_cost": ["--elements", "1", "--order", "2", "--repeats", "2"],
    "mesh_motion_histograms": ["--elements", "1", "--order", "2", "--steps", "5"],
    "mesh_motion_return": ["--cycles", "2", "--steps", "12", "--order", "2", "--elements", "1"],
    "mesh_motion_smoothness": ["--steps", "12", "--halvings", "1", "--order", "2"],
    "skipping": ["--quick", "--needs", "convection", "time loop", "solid"],
    "solid_work_precision": ["--orders", "2"],
    "step_profile": ["--quick", "--set", "mesh.order=2"],
    "wall_ramm": ["--orders", "2", "--end", "0.03", "--movers", "barrier", "angles, published"],
}

DRAWN = (
    "flag_oscillations",
    "fluid_work_precision",
    "fsi1_work_precision",
    "mesh_motion",
    "mesh_motion_histograms",
    "mesh_motion_smoothness",
    "solid_work_precision",
    "wall_ramm",
)
HELPERS = ("_force_noise", "_precision", "_result", "_wall_ramm_pictures")
PACKAGES = ("csm1_scikit_fem", "exact_fsi", "full_mesh_movers", "manufactured_flows", "motion_cases", "motion_contest")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run tests that take ``script_name`` for every script."""
    if "script_name" in metafunc.fixturenames:
        metafunc.parametrize("script_name", sorted(TINY))


@pytest.fixture
def tiny() -> dict[str, list[str]]:
    """The smallest settings of each script."""
    return TINY


@dataclass(frozen=True)
class Measured:
    """What a benchmark returned, wrote and printed, and the folder of its files."""

    result: Any
    written: dict[str, Any]
    printed: str
    folder: Path


@pytest.fixture(scope="session")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[str], Measured]]:
    """A function that runs a benchmark on its smallest settings, each once."""
    before, known = set(sys.modules), dict[str, Measured]()
    sys.path.insert(0, str(FOLDER))

    def run(name: str) -> Measured:
        if name not in known:
            folder = tmp_path_factory.mktemp(name)
            file = folder / f"{name}.json"
            picture = ["--picture", str(folder / f"{name}.png")] if name in DRAWN else []
            with redirect_stdout(io.StringIO()) as printed:
                result = importlib.import_module(name).main([*TINY[name], *picture, "--json", str(file)])
            written = json.loads(file.read_text(encoding="utf-8"), parse_constant=lambda word: pytest.fail(word))
            known[name] = Measured(result, written, printed.getvalue(), folder)
        return known[name]

    yield run
    sys.path.remove(str(FOLDER))
    for name in set(sys.modules) - before:
        if name in (*HELPERS, *TINY) or name.partition(".")[0] in PACKAGES:
            sys.modules.pop(name)
