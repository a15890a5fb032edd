"""Runs that are broken off go on with other settings, and say so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest


def test_a_run_that_gave_up_goes_on_with_smaller_steps(
    channel: str, runs: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A gust that Newton's method follows in small steps only; steps are not halved."""
    text = runs.changed(channel, ('"4*y*(1 - y)"', '"4*y*(1 - y)*(1 + 30*exp(-((t - 0.4)/0.1)**2))"'))
    text = runs.changed(
        text, ("viscosity = 0.1", 'viscosity = 0.02\nconvection = "newton"'), ("steps = 5", "end = 0.6")
    )
    text, folder = runs.scene(text), tmp_path / "out"
    changes = [*runs.tables_only, "time.halvings=0", "nonlinear.max_iterations=4"]
    assert runs.run(text, folder, changes) == 3
    message = capsys.readouterr().err
    assert f"The last good state, t = 0.2, is in {folder / 'restart.npz'}." in message
    assert f"Go on with: hofsi run {text} -o {folder} --set {' '.join(changes)} --resume, with a smaller" in message
    assert runs.run(text, folder, [*changes, "time.dt=0.0125"], "--resume") == 0
    steps = runs.rows(folder / "steps.csv")
    assert [float(row["dt"]) for row in steps] == [0.1, 0.1, *[0.0125] * 32]
    assert [int(row["step"]) for row in steps] == list(range(1, 35))
    assert float(steps[-1]["t"]) == pytest.approx(0.6)
    data = runs.summary(folder)
    assert "resumed after step 2, t = 0.2, with time.dt = 0.0125 instead of 0.1" in data["notes"]
    assert data["status"] == "completed"


def test_with_another_step_size_the_order_of_the_scheme_stays(solid_alone: str, runs: Any, tmp_path: Path) -> None:
    """The history has steps of two sizes: half way, going on with half the step lies between whole runs with either."""
    text = runs.scene(runs.swinging(solid_alone, "bdf2"))
    ends = {}
    for dt in (0.01, 0.005, 0.00125):
        assert runs.run(text, tmp_path / f"{dt}", [*runs.tables_only, f"time.dt={dt}"]) == 0
        ends[dt] = float(runs.rows(tmp_path / f"{dt}" / "quantities.csv")[-1]["u_x"])
    folder = tmp_path / "mixed"
    assert (
        runs.run(text, folder, [*runs.tables_only, "time.dt=0.01", "time.end=0.4", "output.checkpoint_every=40"]) == 0
    )
    assert runs.run(text, folder, [*runs.tables_only, "time.dt=0.005"], "--resume") == 0
    mixed = runs.rows(folder / "quantities.csv")
    assert (len(mixed), float(mixed[-1]["t"])) == (120, pytest.approx(0.8))
    error = {name: abs(end - ends[0.00125]) for name, end in {**ends, "mixed": float(mixed[-1]["u_x"])}.items()}
    assert error[0.01] > 3.0 * error[0.005]
    assert error["mixed"] < error[0.01]
    notes = runs.summary(folder)["notes"]
    assert "resumed after step 40, t = 0.4, with time.dt = 0.005 instead of 0.01" in notes
    assert "resumed after step 40, t = 0.4, with time.end = 0.8 instead of 0.4" in notes


def test_a_later_end_changes_nothing_but_the_end(flap: str, runs: Any, tmp_path: Path) -> None:
    """A run to t = 0.25 has a short last step: the steps of 0.1 are counted from there."""
    text, every = runs.scene(flap), [*runs.tables_only, "output.checkpoint_every=1"]
    assert runs.run(text, tmp_path / "whole", [*every, "time.end=0.5"]) == 0
    assert runs.run(text, tmp_path / "parts", [*every, "time.end=0.3"]) == 0
    assert runs.run(text, tmp_path / "parts", [*every, "time.end=0.5"], "--resume") == 0
    assert runs.rows(tmp_path / "parts" / "steps.csv") == runs.rows(tmp_path / "whole" / "steps.csv")
    assert runs.run(text, tmp_path / "short", [*every, "time.end=0.25"]) == 0
    assert runs.run(text, tmp_path / "short", [*every, "time.end=0.45"], "--resume") == 0
    times = [float(row["t"]) for row in runs.rows(tmp_path / "short" / "quantities.csv")]
    np.testing.assert_allclose(times, [0.1, 0.2, 0.25, 0.35, 0.45])


def test_a_run_may_go_on_in_another_directory(flap: str, runs: Any, tmp_path: Path) -> None:
    text, changes = runs.scene(flap), [*runs.tables_only, "output.checkpoint_every=2", "time.end=0.4"]
    assert runs.run(text, tmp_path / "one", changes) == 0
    before = (tmp_path / "one" / "steps.csv").read_bytes()
    restart = str(tmp_path / "one" / "restart.npz")
    other = [*changes[:-1], "time.end=0.6", "coupling.acceleration=aitken", "fluid.viscosity=0.02"]
    assert runs.run(text, tmp_path / "two", other, "--resume", restart) == 0
    assert (tmp_path / "one" / "steps.csv").read_bytes() == before
    assert (tmp_path / "two" / "steps.csv").read_bytes().startswith(before)
    assert len(runs.rows(tmp_path / "two" / "quantities.csv")) == 6
    notes = " ".join(runs.summary(tmp_path / "two")["notes"])
    assert "coupling.acceleration = aitken instead of iqn-ils" in notes
    assert "fluid.viscosity = 0.02 instead of 0.01" in notes


@pytest.mark.parametrize(
    "change",
    [
        "coupling.tolerance=1e-8",
        "coupling.acceleration='aitken'",
        "coupling.reuse=1",
        "coupling.filter=1e-2",
        "linear.lag=false",
        "linear.solver='amg'",
        "nonlinear.tolerance=1e-9",
        "time.halvings=2",
        "output.every=3",
    ],
)
def test_settings_of_solvers_may_change_and_results_stay(flap: str, runs: Any, tmp_path: Path, change: str) -> None:
    if "amg" in change:
        pytest.importorskip("pyamg")
    text = runs.scene(runs.changed(flap, ("viscosity = 0.01", 'viscosity = 0.01\nconvection = "newton"')))
    changes = [*runs.tables_only, "output.checkpoint_every=1"]
    assert runs.run(text, tmp_path / "whole", [*changes, "time.end=0.6"]) == 0
    assert runs.run(text, tmp_path / "parts", [*changes, "time.end=0.3"]) == 0
    assert runs.run(text, tmp_path / "parts", [*changes, "time.end=0.6", change], "--resume") == 0
    one, other = (
        [float(row["lift"]) for row in runs.rows(tmp_path / name / "quantities.csv")] for name in ("whole", "parts")
    )
    np.testing.assert_allclose(other, one, rtol=1e-4)
    assert f"with {change.partition('=')[0]} = " in " ".join(runs.summary(tmp_path / "parts")["notes"])


@pytest.mark.parametrize(
    "change", ["mover.type='pseudo-solid'", "time.tolerance=1e-2", "solid[0].youngs_modulus=2e3", "constants.U=1.4"]
)
def test_what_makes_it_another_problem_may_change_and_is_told(
    flap: str, runs: Any, tmp_path: Path, change: str
) -> None:
    text, changes = runs.scene(flap), [*runs.tables_only, "output.checkpoint_every=1"]
    assert runs.run(text, tmp_path / "out", [*changes, "time.end=0.3"]) == 0
    assert runs.run(text, tmp_path / "out", [*changes, "time.end=0.5", change], "--resume") == 0
    key = change.partition("=")[0].replace("constants.U", "fluid.boundary[0].x")
    assert f"resumed after step 3, t = 0.3, with {key}" in " ".join(runs.summary(tmp_path / "out")["notes"])
    assert runs.rows(tmp_path / "out" / "quantities.csv")[-1]["t"] == "0.5"


def test_a_new_run_removes_the_restart_file_of_an_older_one(flap: str, runs: Any, tmp_path: Path) -> None:
    text, folder = runs.scene(flap), tmp_path / "out"
    assert runs.run(text, folder, [*runs.tables_only, "output.checkpoint_every=1", "time.end=0.2"]) == 0
    assert (folder / "restart.npz").is_file()
    assert runs.run(text, folder, [*runs.tables_only, "time.end=0.1"]) == 0
    assert not (folder / "restart.npz").exists()
