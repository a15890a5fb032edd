"""Runs that are broken off go on to the bit as if nothing had happened."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from hofsi.build import Problem
from hofsi.records import StepRecord

posix = pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")


@posix
def test_a_coupled_run_that_was_killed_goes_on_to_the_bit(
    flap: str, runs: Any, tmp_path: Path, vtk_module: object
) -> None:
    """Killed in step 6, resumed after step 4: the row of step 5 and its files are made again."""
    changes = ["output.plots=false", "output.every=3", "output.checkpoint_every=2", "time.end=1.0"]
    runs.interrupted_and_resumed(runs.scene(flap), changes, 6, "SIGKILL")
    assert len(list((tmp_path / "parts" / "fields").iterdir())) == 8  # steps 3, 6, 9 and 10, fluid and solid


@posix
@pytest.mark.parametrize("count", [3, 5])
def test_a_run_that_is_killed_at_any_moment_goes_on_to_the_bit(
    flap: str, runs: Any, tmp_path: Path, vtk_module: object, count: int
) -> None:
    """Killed from outside, while it computes or writes."""
    text, folder = runs.scene(flap), tmp_path / "parts"
    changes = ["output.plots=false", "output.every=1", "output.checkpoint_every=1", "time.end=0.8"]
    command = [sys.executable, "-m", "hofsi", "run", text, "-o", str(folder), "--quiet", "--set", *changes]
    process = subprocess.Popen(command, env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))})
    limit = time.monotonic() + 60.0
    while process.poll() is None and time.monotonic() < limit:
        if (folder / f"fields/fluid_{count:06d}.vtu").exists() and (folder / "restart.npz").exists():
            process.kill()
            break
        time.sleep(0.001)
    process.wait(60.0)
    assert runs.run(text, folder, changes, "--resume") == 0
    assert runs.run(text, tmp_path / "whole", changes) == 0
    runs.assert_same(tmp_path / "whole", folder)


@posix
def test_a_fluid_with_factors_of_earlier_steps_goes_on_to_the_bit(channel: str, runs: Any, tmp_path: Path) -> None:
    changes = [*runs.tables_only, "output.checkpoint_every=3"]
    runs.interrupted_and_resumed(runs.scene(runs.newton(channel)), changes, 5, "SIGKILL")
    steps = runs.rows(tmp_path / "parts" / "steps.csv")
    assert steps[-1]["factorisations"] == steps[3]["factorisations"] != "0"  # of a step before the restart file's


@posix
@pytest.mark.parametrize("scheme", ["bdf2", "generalised-alpha", "energy-momentum"])
def test_a_solid_goes_on_to_the_bit(solid_alone: str, runs: Any, tmp_path: Path, scheme: str) -> None:
    changes = [*runs.tables_only, "output.checkpoint_every=3"]
    runs.interrupted_and_resumed(runs.scene(runs.swinging(solid_alone, scheme)), changes, 6, "SIGKILL")


@posix
def test_steps_chosen_by_their_error_go_on_to_the_bit(flap: str, runs: Any, tmp_path: Path) -> None:
    changes = [*runs.tables_only, "output.checkpoint_every=1", "time.end=0.5", "time.tolerance=1e-2"]
    whole = runs.scene(flap)
    assert runs.run(whole, tmp_path / "whole", changes) == 0
    steps = runs.rows(tmp_path / "whole" / "steps.csv")
    assert len({row["dt"] for row in steps}) > 1
    # In the middle of a divided step, after one whole step at least.
    middle = next(k for k, row in enumerate(steps) if float(row["t"]) > 0.25)
    assert runs.killed(middle, "SIGKILL", whole, tmp_path / "parts", changes).returncode == -signal.SIGKILL
    assert runs.run(whole, tmp_path / "parts", changes, "--resume") == 0
    runs.assert_same(tmp_path / "whole", tmp_path / "parts")


@pytest.mark.parametrize("step", [1, 2, 5, 9, 10, 11, 12])
def test_what_observers_know_goes_on_too(
    flap: str, runs: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, vtk_module: object, step: int
) -> None:
    """Broken off after any step: fields are written every fourth step, quality and resolution looked at every tenth."""
    text, changes = runs.scene(flap), ["output.plots=false", "output.every=4", "time.end=1.2"]
    assert runs.run(text, tmp_path / "whole", changes) == 0
    module = importlib.import_module("hofsi.run")  # the attribute of the package is the function
    simulate = module.simulate

    def broken(problem: Problem, after: StepRecord | None = None) -> Iterator[StepRecord]:
        for record in simulate(problem, after):
            yield record
            if record.step == step:
                raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(module, "simulate", broken)
        assert runs.run(text, tmp_path / "parts", changes) == 130
    assert runs.run(text, tmp_path / "parts", changes, "--resume") == 0
    (tmp_path / "parts" / "restart.npz").unlink()
    runs.assert_same(tmp_path / "whole", tmp_path / "parts")


@posix
@pytest.mark.parametrize(("name", "code"), [("SIGTERM", 143), ("SIGINT", 130)])
def test_a_run_that_is_asked_to_end_says_how_to_go_on(
    flap: str, runs: Any, tmp_path: Path, name: str, code: int
) -> None:
    """The step at hand is given up; without checkpoint_every the file is that of the last step, all the same."""
    text, folder, changes = runs.scene(flap), tmp_path / "parts", [*runs.tables_only, "time.end=0.6"]
    done = runs.killed(4, name, text, folder, changes)
    assert (done.returncode, done.stdout) == (code, "")
    command = f"hofsi run {text} -o {folder} --set {' '.join(changes)} --resume"
    kept = f"What was computed until then is in {folder}."
    assert done.stderr == f"hofsi: interrupted. {kept} Go on with: {command}\n"
    data = runs.summary(folder)
    assert (data["status"], data["reason"]) == ("interrupted", "interrupted after step 3, t = 0.3")
    assert runs.run(text, folder, changes, "--resume") == 0
    assert runs.run(text, tmp_path / "whole", changes) == 0
    (folder / "restart.npz").unlink()
    runs.assert_same(tmp_path / "whole", folder)


@posix
def test_after_a_step_that_was_divided_a_run_goes_on_to_the_bit(flap: str, runs: Any, tmp_path: Path) -> None:
    """A gust that a step of 0.1 does not bear with 12 iterations, but two of 0.05: broken off between them."""
    gust = '"4*U*y*(H - y)/H**2*sin(t)*(1 + 3*exp(-((t - 0.4)/0.1)**2))"'
    text = runs.scene(runs.changed(flap, ('"4*U*y*(H - y)/H**2*sin(t)"', gust)))
    changes = [*runs.tables_only, "time.end=0.3", "coupling.max_iterations=12", "coupling.condensed=false"]
    assert runs.run(text, tmp_path / "whole", changes) == 0
    steps = runs.rows(tmp_path / "whole" / "steps.csv")
    assert [(row["dt"], row["rejected_because"]) for row in steps[2:]] == [("0.05", "AddedMassError"), ("0.05", "")]
    assert runs.killed(4, "SIGTERM", text, tmp_path / "parts", changes).returncode == 143
    assert runs.run(text, tmp_path / "parts", changes, "--resume") == 0
    (tmp_path / "parts" / "restart.npz").unlink()
    runs.assert_same(tmp_path / "whole", tmp_path / "parts")
