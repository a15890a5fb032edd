"""The warning about elements that are too coarse for the Reynolds number."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from io import StringIO
from pathlib import Path

from hofsi.build import build
from hofsi.case import Case
from hofsi.observers.resolution import FlowResolutionWatch
from hofsi.run import run
from hofsi.simulate import simulate

Read = Callable[..., Case]
COARSE = ("viscosity = 0.01", "viscosity = 1e-6")


def watched(case: Case, every: int = 10) -> tuple[list[str], dict[str, float | int]]:
    problem = build(case)
    assert problem.fluid is not None
    said: list[str] = []
    watch = FlowResolutionWatch(problem.fluid, said.append, every)
    for record in simulate(problem):
        watch.observe(record)
    watch.close()
    return said, watch.summary()


def test_a_reynolds_number_far_too_high_for_the_mesh_is_told_once(read_changed: Read, fluid_alone: str) -> None:
    case = read_changed(COARSE, ("end = 2.0", "steps = 8"), text=fluid_alone)
    said, found = watched(case, every=2)
    assert len(said) == 1
    assert "too coarse for this Reynolds number. Worst: element" in said[0]
    assert "in blocks.fluid at (" in said[0]
    assert "Take more elements there, a higher order or a lower Reynolds number" in said[0]
    assert 'convection_form = "skew-symmetric"' in said[0]
    assert found["roughness"] > 0.08
    assert found["peclet"] > 1e3
    assert found["peclet_max"] >= found["peclet"]
    assert 0.0 < found["x"] < 3.0


def test_the_form_that_keeps_energy_is_not_advised_twice(read_changed: Read, fluid_alone: str) -> None:
    form = ("viscosity = 1e-6", 'viscosity = 1e-6\nconvection_form = "skew-symmetric"')
    case = read_changed(COARSE, form, ("end = 2.0", "steps = 8"), text=fluid_alone)
    said, _ = watched(case, every=2)
    assert len(said) == 1
    assert "convection_form" not in said[0]


def test_a_viscous_flow_is_resolved(read_changed: Read, fluid_alone: str) -> None:
    case = read_changed(("viscosity = 0.01", "viscosity = 10"), ("end = 2.0", "steps = 8"), text=fluid_alone)
    said, found = watched(case)
    assert said == []
    assert found["peclet_max"] < 2.0
    assert "roughness" not in found


def test_the_warning_is_shown_and_kept(read_changed: Read, fluid_alone: str, tmp_path: Path) -> None:
    case = read_changed(COARSE, ("end = 2.0", "steps = 4"), text=fluid_alone)
    case = replace(case, output=replace(case.output, fields=False, plots=False))
    stream = StringIO()
    run(case, tmp_path, progress=stream)
    data = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    (note,) = [text for text in data["notes"] if "too coarse" in text]
    assert f"note: {note}.\n" in stream.getvalue()
    assert data["resolution"]["peclet"] > 1e3


def test_without_convection_there_is_nothing_to_resolve(read_changed: Read, fluid_alone: str, tmp_path: Path) -> None:
    stokes = ("density = 2.0", 'density = 2.0\nmodel = "stokes"')
    case = read_changed(COARSE, ("end = 2.0", "steps = 2"), stokes, text=fluid_alone)
    case = replace(case, output=replace(case.output, fields=False, plots=False))
    summary = run(case, tmp_path).summary
    assert summary["resolution"] == {}
    assert summary["notes"] == []
