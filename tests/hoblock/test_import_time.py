"""``import hoblock`` is cheap: NumPy and little else."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

RUNS = 7
LIMIT = 2.5  # times as long as `import numpy`
HEAVY = ("gmsh", "matplotlib", "meshio", "pyamg", "scipy", "skfem", "vtk", "vtkmodules")

MEASURE = "import time; start = time.process_time(); import {}; print(time.process_time() - start)"
LOADED = "import sys, hoblock; print(*sorted({name.partition('.')[0] for name in sys.modules}))"


def _run(code: str) -> str:
    """Output of a new interpreter that finds the same hoblock as this one."""
    spec = importlib.util.find_spec("hoblock")
    assert spec is not None
    assert spec.origin is not None
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPATH"] = str(Path(spec.origin).parent.parent)
    command = [sys.executable, "-c", code]
    return subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout


def test_import_takes_little_longer_than_numpy() -> None:
    modules = ("numpy", "hoblock")
    for module in modules:  # the first run may compile
        _run(MEASURE.format(module))
    rounds = [[float(_run(MEASURE.format(module))) for module in modules] for _ in range(RUNS)]
    numpy_time, hoblock_time = (min(times) for times in zip(*rounds, strict=True))
    assert hoblock_time <= LIMIT * numpy_time, f"import hoblock {hoblock_time:.3f} s, import numpy {numpy_time:.3f} s"


def test_import_loads_no_heavy_library() -> None:
    loaded = _run(LOADED).split()
    assert "numpy" in loaded
    assert sorted(set(loaded) & set(HEAVY)) == []
