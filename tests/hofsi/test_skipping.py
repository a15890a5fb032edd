"""What a scene does not need is neither imported nor done."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

CODE = """
import json, sys
from {package}.cli import main
code = main({arguments!r})
print(json.dumps([code, sorted(sys.modules)]))
"""
DRAWING = ("matplotlib", "vtk", "vtkmodules")
COUPLING = ("hofsi.coupling", "pyamg")
TABLES_ONLY = ["--set", "output.fields=false", "--set", "output.plots=false"]


@dataclass
class Process:
    """Modules that were loaded, and the summary of a run."""

    modules: set[str]
    summary: dict[str, Any]

    def loaded(self, *names: str) -> set[str]:
        """Which of some modules, or modules in them, were loaded."""
        return {name for name in self.modules if name.startswith(tuple(f"{n}." for n in names)) or name in names}


@pytest.fixture
def execute(tmp_path: Path) -> Callable[..., Process]:
    """A function that runs a command on a scene in a process of its own."""

    def execute(text: str, package: str, task: str, output: str, *others: str) -> Process:
        scene, target = tmp_path / "scene.toml", tmp_path / output
        scene.write_text(text, encoding="utf-8")
        code = CODE.format(package=package, arguments=[task, str(scene), "-o", str(target), *others])
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        command = [sys.executable, "-c", code]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        returned, modules = json.loads(done.stdout.splitlines()[-1])
        assert returned == 0, done.stderr
        file = target / "summary.json"
        return Process(set(modules), json.loads(file.read_text(encoding="utf-8")) if file.exists() else {})

    return execute


@pytest.fixture
def solid_only(solid_alone: str) -> str:
    """The flap alone, without the vertices of the channel."""
    return re.sub(r"^(a\d|d\d|b2|c2) = .*\n", "", solid_alone, flags=re.MULTILINE).replace("end = 2.0", "end = 0.3")


@pytest.fixture
def fluid_only(fluid_alone: str) -> str:
    """The channel with a rigid flap."""
    return fluid_alone.replace("end = 2.0", "end = 0.5")


def test_importing_hofsi_loads_no_solver() -> None:
    code = "import sys, hofsi; print([m for m in sys.modules if 'solvers' in m or 'coupling' in m or m in %r])"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    heavy = (*DRAWING, "scipy", "meshio", "pyamg", "hofsi.io.scene", "hofsi.cli")
    done = subprocess.run(
        [sys.executable, "-c", code % (heavy,)], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout == "[]\n"


def test_a_mesh_alone_needs_numpy_only(execute: Callable[..., Process], flap: str) -> None:
    done = execute(flap, "hoblock", "mesh", "mesh.npz")
    assert done.loaded("hofsi", "scipy", "meshio", "skfem", "pyamg", *DRAWING) == set()


def test_a_fluid_alone(execute: Callable[..., Process], fluid_only: str) -> None:
    done = execute(fluid_only, "hofsi", "run", "out", *TABLES_ONLY)
    assert done.loaded("hofsi.solvers.solid", "hofsi.kernels.elasticity") == set()
    assert done.loaded(*COUPLING, *DRAWING) == set()
    assert done.loaded("hofsi.solvers.fluid") == {"hofsi.solvers.fluid"}
    counts = done.summary["counts"]
    assert "solid" not in counts
    assert (counts["steps"], counts["coupling_iterations"], counts["blocks_regenerated"]) == (5, 0, 0)
    # The mesh stands still: one geometry; a matrix without convection for the first step, one for all others.
    assert (counts["fluid"]["geometries"], counts["fluid"]["constant_assemblies"]) == (1, 2)
    # Linear steps; the start is impulsive, so that the first ones go on with Newton's method.
    assert counts["fluid"]["reasons"]["linear step"] == 5
    assert counts["fluid"]["solves"] == 5 + counts["fluid"]["iterations"] <= 7
    assert counts["fluid"]["factorisations"] <= 7
    assert {"mesh", "solid", "coupling", "fields", "plots"} & set(done.summary["seconds"]) == set()


def test_a_solid_alone(execute: Callable[..., Process], solid_only: str) -> None:
    done = execute(solid_only, "hofsi", "run", "out", *TABLES_ONLY)
    fluid = ("hofsi.solvers.fluid", "hofsi.solvers.fluid_forces", "hofsi.kernels.navier_stokes")
    assert done.loaded(*fluid, "hofsi.motion", "hoblock.movers") == set()
    assert done.loaded(*COUPLING, *DRAWING) == set()
    assert done.loaded("hofsi.solvers.solid") == {"hofsi.solvers.solid"}
    counts = done.summary["counts"]
    assert "fluid" not in counts
    assert (counts["steps"], counts["coupling_iterations"], counts["blocks_regenerated"]) == (3, 0, 0)
    assert counts["factorisations"] == counts["solid"]["factorisations"]
    assert {"mesh", "fluid", "coupling", "fields", "plots"} & set(done.summary["seconds"]) == set()


def test_fields_load_vtk_and_not_the_other_body(
    execute: Callable[..., Process], fluid_only: str, solid_only: str, vtk_module: object
) -> None:
    changes = ["--set", "output.plots=false"]
    fluid = execute(fluid_only, "hofsi", "run", "fluid", *changes)
    assert fluid.loaded("hofsi.solvers.solid", *COUPLING, "matplotlib") == set()
    solid = execute(solid_only, "hofsi", "run", "solid", *changes)
    assert solid.loaded("hofsi.solvers.fluid", *COUPLING, "matplotlib") == set()
    assert fluid.loaded("vtkmodules")
    assert solid.loaded("vtkmodules")


def test_plots_load_matplotlib_and_no_vtk(execute: Callable[..., Process], solid_only: str) -> None:
    pytest.importorskip("matplotlib")
    done = execute(solid_only, "hofsi", "run", "out", "--set", "output.fields=false")
    assert done.loaded("vtk", "vtkmodules") == set()
    assert "matplotlib" in done.modules
