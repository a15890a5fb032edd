"""A case, run into a folder."""

from __future__ import annotations

import csv
import importlib
import io
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hoblock.errors import MissingExtraError
from hofsi.build import Problem
from hofsi.case import Case, OutputSettings
from hofsi.errors import CaseError
from hofsi.records import StepRecord
from hofsi.run import run

RUN = importlib.import_module("hofsi.run")  # the attribute of the package is the function
REPORT = importlib.import_module("hofsi.report")
TABLES_ONLY = OutputSettings(fields=False, plots=False, period_of="u_x")
Reader = Callable[..., Case]
# From t = 0.25 on a load tears the flap away.
TORN = ("youngs_modulus = 1e3", 'youngs_modulus = 1e3\nbody_force = ["1e8 if t > 0.25 else 0", 0]')


@pytest.fixture
def short(read_changed: Reader) -> Case:
    """Three steps of the flap, without fields and plots."""
    return replace(read_changed(("end = 2.0", "end = 0.3")), output=TABLES_ONLY)


def table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def summary(folder: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return data


def test_a_run_that_is_completed(short: Case, tmp_path: Path) -> None:
    folder = tmp_path / "results" / "flap"
    stream = io.StringIO()
    result = run(short, folder, progress=stream, changes=["time.end=0.3"])
    assert sorted(path.name for path in folder.iterdir()) == ["quantities.csv", "steps.csv", "summary.json"]
    assert (result.status, result.reason) == ("completed", "end of the time interval reached")
    assert result.directory == folder
    np.testing.assert_allclose(result.times, [0.1, 0.2, 0.3])
    rows = table(folder / "quantities.csv")
    for name in ("u_x", "lift"):
        assert [float(row[name]) for row in rows] == list(result.series[name])
        assert np.abs(result.series[name]).min() > 0.0
    assert any(line.startswith("step 3/3  t 0.3  dt 0.1  ") for line in stream.getvalue().splitlines())


def test_the_summary_is_complete(short: Case, tmp_path: Path) -> None:
    result = run(short, tmp_path, changes=["time.end=0.3"])
    data = summary(tmp_path)
    assert data == json.loads(json.dumps(result.summary))
    assert data["scene"] == {"title": "Flap in a channel", "file": "flap.toml", "changes": ["time.end=0.3"]}
    assert (data["status"], data["t"], data["period_of"]) == ("completed", pytest.approx(0.3), "u_x")
    seconds = data["seconds"]
    assert {"total", "build", "mesh", "fluid", "solid", "coupling", "quantities"} <= set(seconds)
    assert sum(seconds.values()) - seconds["total"] == pytest.approx(seconds["total"], rel=0.02, abs=2e-3)
    steps = table(tmp_path / "steps.csv")
    counts = data["counts"]
    assert counts["steps"] == len(steps) == 3
    assert counts["coupling_iterations"] == sum(int(row["coupling_iterations"]) for row in steps)
    assert counts["blocks_regenerated"] == sum(int(row["blocks_regenerated"]) for row in steps) > 0
    assert counts["factorisations"] == int(steps[-1]["factorisations"]) > 0
    assert counts["factorisations"] == counts["fluid"]["factorisations"] + counts["solid"]["factorisations"]
    assert counts["assemblies"] == int(steps[-1]["assemblies"]) > 0
    assert counts["solid"]["elements"] == 1
    assert data["quality"]["min_det_J"] == min(float(row["min_det_J"]) for row in steps)
    assert 0.0 < data["quality"]["scaled_jacobian_min"] <= data["quality"]["scaled_jacobian_mean"] <= 1.0
    u_x = data["quantities"]["u_x"]
    assert set(u_x) == {"last", "max", "t_max", "min", "t_min", "mean", "amplitude", "frequency", "harmonic", "phase"}
    assert u_x["last"] == result.series["u_x"][-1]
    assert (u_x["max"], u_x["t_max"]) == (max(result.series["u_x"]), result.times[result.series["u_x"].argmax()])
    assert (u_x["mean"], u_x["amplitude"], u_x["frequency"]) == (None, None, None)


def test_fields_and_plots_are_written_when_asked_for(short: Case, tmp_path: Path, vtk_module: object) -> None:
    pytest.importorskip("matplotlib")
    result = run(replace(short, output=OutputSettings(every=2, period_of="u_x")), tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert {"fluid.pvd", "solid.pvd", "mesh.png", "quantities.png"} <= names
    pvd = (tmp_path / "fluid.pvd").read_text(encoding="utf-8")
    assert pvd.count("<DataSet ") == 2  # steps 2 and 3
    assert {"fields", "plots"} <= set(result.summary["seconds"])


def test_a_steady_case(read_changed: Reader, solid_alone: str, tmp_path: Path) -> None:
    used = re.sub(r"^(a\d|d\d|b2|c2) = .*\n", "", solid_alone, flags=re.MULTILINE)
    case = read_changed(("dt = 0.1\nend = 2.0", "steady = true"), text=used)
    result = run(replace(case, output=TABLES_ONLY), tmp_path)
    assert (result.status, result.reason) == ("completed", "steady state found")
    (step,) = table(tmp_path / "steps.csv")
    assert (step["t"], step["dt"], step["coupling_iterations"]) == ("0.0", "0.0", "")
    assert summary(tmp_path)["quality"]["mesh"] == "solid"


def test_a_step_that_fails_loses_nothing(read_changed: Reader, tmp_path: Path) -> None:
    """The force sets in at t = 0.25, within the third step: as much of the time before as the halved steps reach."""
    case = replace(read_changed(TORN), output=TABLES_ONLY)
    good = run(replace(read_changed(("end = 2.0", "end = 0.2")), output=TABLES_ONLY), tmp_path / "good")
    result = run(case, tmp_path / "torn")
    assert result.status == "failed"
    assert "t = 0.25" in result.reason
    assert "halved time.halvings = 4 times" in result.reason
    assert list(result.times[:2]) == list(good.times)
    assert list(result.series["u_x"][:2]) == list(good.series["u_x"])
    assert result.times[-1] == pytest.approx(0.25, abs=0.0063)
    steps = table(tmp_path / "torn" / "steps.csv")
    assert len(steps) == len(result.times) > 2
    assert int(steps[2]["rejected"]) >= 1
    cause = steps[2]["rejected_because"]  # the solid finds no equilibrium, or one far from the mesh of the step
    assert cause in ("NewtonError", "CouplingError")
    data = summary(tmp_path / "torn")
    assert (data["status"], data["reason"], data["counts"]["steps"]) == ("failed", result.reason, len(steps))
    assert data["quantities"]["u_x"]["last"] == result.series["u_x"][-1]
    rejected = sum(int(step["rejected"]) for step in steps)
    assert data["time_steps"]["dt_max"] == 0.1
    assert sum(data["time_steps"]["rejected"].values()) == rejected
    assert any("The step of 0.1 was divided" in note for note in data["notes"])


def test_a_first_step_that_fails_leaves_a_summary(read_changed: Reader, tmp_path: Path) -> None:
    case = read_changed((TORN[0], TORN[1].replace("t > 0.25", "t > 0")))
    result = run(replace(case, output=replace(TABLES_ONLY, plots=True)), tmp_path)
    data = summary(tmp_path)
    assert (data["status"], data["t"], data["counts"]["steps"], data["quality"]) == ("failed", None, 0, {})
    assert data["quantities"]["u_x"]["last"] is None
    assert data["time_steps"] == {}
    assert table(tmp_path / "quantities.csv") == []
    assert result.times.size == 0


def break_off(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    """Let the simulation raise an exception after its second step."""
    simulate = RUN.simulate

    def broken(problem: Problem, after: StepRecord | None = None) -> Iterator[StepRecord]:
        for record in simulate(problem, after):
            if record.step == 3:
                raise error
            yield record

    monkeypatch.setattr(RUN, "simulate", broken)


def test_an_interruption_loses_nothing(short: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    break_off(monkeypatch, KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt):
        run(short, tmp_path)
    data = summary(tmp_path)
    assert (data["status"], data["reason"]) == ("interrupted", "interrupted after step 2, t = 0.2")
    assert len(table(tmp_path / "quantities.csv")) == len(table(tmp_path / "steps.csv")) == 2


def test_an_unexpected_error_loses_nothing_and_is_not_hidden(
    short: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    break_off(monkeypatch, MemoryError("no room"))
    with pytest.raises(MemoryError, match="no room"):
        run(short, tmp_path)
    data = summary(tmp_path)
    assert (data["status"], data["reason"], data["counts"]["steps"]) == ("failed", "MemoryError: no room", 2)


def test_one_observer_that_cannot_close_does_not_keep_the_others_from_it(
    short: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    close = REPORT.StepTable.close
    closed = []

    def fail(self: Any) -> None:
        close(self)
        raise OSError("disk full")

    monkeypatch.setattr(REPORT.StepTable, "close", fail)
    monkeypatch.setattr(REPORT.MeshQuality, "close", lambda self: closed.append(self))
    with pytest.raises(OSError, match="disk full"):
        run(short, tmp_path)
    assert len(closed) == 1
    assert summary(tmp_path)["counts"]["steps"] == 3


def test_while_it_runs_the_summary_says_so(short: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "summary.json").write_text('{"status": "completed"}', encoding="utf-8")
    seen = []
    observe = REPORT.StepTable.observe

    def watched(self: Any, record: StepRecord) -> None:
        seen.append(summary(tmp_path)["status"])
        observe(self, record)

    monkeypatch.setattr(REPORT.StepTable, "observe", watched)
    run(short, tmp_path)
    assert seen == ["running"] * 3
    assert summary(tmp_path)["status"] == "completed"


def test_what_cannot_be_built_leaves_no_folder(read_changed: Reader, tmp_path: Path) -> None:
    case = replace(read_changed(('at = "b1"', "at = [0.5, 0.5]")), output=TABLES_ONLY)
    with pytest.raises(CaseError, match=r"outside the solid's mesh") as error:
        run(case, tmp_path / "results")
    assert (error.value.file, error.value.place) == ("flap.toml", "quantities.u_x.at")
    assert not (tmp_path / "results").exists()


def test_missing_matplotlib_is_found_out_before_the_first_step(
    short: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(RUN, "find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match=r'pip install "hofsi-coupler\[plot\]"'):
        run(replace(short, output=OutputSettings(fields=False)), tmp_path / "results")
    assert not (tmp_path / "results").exists()
    assert run(short, tmp_path).status == "completed"
