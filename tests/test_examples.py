"""The example scenes: they load, can be planned and meshed, and run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hoblock import build_structure, generate
from hoblock.cli import main as hoblock
from hoblock.io.scene import load_mesh_scene
from hofsi import build, evaluators, load_case, simulate
from hofsi.case import Steady
from hofsi.cli import main as hofsi
from hofsi.plan import plan

SCENES = sorted((Path(__file__).resolve().parent.parent / "examples").glob("*.toml"))

# What makes a run quick, for the scenes that take long at order 2.
QUICK = {
    "cfd3": ["time.end=0.01"],
    "fsi2": ["time.end=0.02"],
    "fsi3": ["time.end=0.01"],
    "fsi3_ring": ["time.end=0.01"],
    "oscillating_cylinder": ["time.end=0.1"],
    "pitching_airfoil": ["time.end=0.04"],
    "pressure_pulse": ["time.end=0.001"],
    "wall_ramm": ["time.dt=0.005", "time.end=0.01"],
}

pytestmark = pytest.mark.parametrize("scene", SCENES, ids=[scene.stem for scene in SCENES])


def test_example_can_be_planned(scene):
    found = plan(load_case(scene))
    assert any(item.name == "mesh" or "mesh" in item.name for item in found.built)


def test_commands_accept_example(scene, capsys):
    assert hoblock(["check", str(scene), "--order", "2"]) == 0
    assert hofsi(["check", str(scene)]) == 0
    printed = capsys.readouterr()
    assert "positive everywhere, certified" in printed.out
    assert printed.err == ""


@pytest.mark.parametrize("order", [2, 5])
def test_example_is_meshed(scene, order):
    part = load_mesh_scene(scene)
    mesh = generate(build_structure(part), order)
    assert part.title
    assert mesh.order == order
    assert set(mesh.edge_groups) == set(part.edges)


def test_example_runs_at_order_two(scene):
    changes = ["mesh.order=2", "output.fields=false", "output.plots=false", *QUICK.get(scene.stem, [])]
    problem = build(load_case(scene, changes))
    records = list(simulate(problem))
    assert len(records) == (1 if isinstance(problem.case.time, Steady) else problem.case.time.steps)
    values = [evaluate(records[-1]) for evaluate in evaluators(problem).values()]
    assert len(values) >= 2
    assert np.isfinite(values).all()
    assert np.any(np.abs(values) > 0.0)
