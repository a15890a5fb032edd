"""Runs that are broken off and go on: to the bit as if nothing had happened, or with other settings."""

from __future__ import annotations

import csv
import importlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hofsi.build import Problem
from hofsi.cli import main
from hofsi.records import StepRecord

TABLES_ONLY = ["output.fields=false", "output.plots=false"]
Write = Callable[[str], str]

DEADLY = """
import importlib, os, signal, sys

from hofsi.cli import main

module = importlib.import_module("hofsi.run")
simulate = module.simulate


def deadly(problem, after=None):
    for record in simulate(problem, after):
        if record.step == int(sys.argv[1]):
            os.kill(os.getpid(), getattr(signal, sys.argv[2]))
        yield record


module.simulate = deadly
sys.exit(main(sys.argv[3:]))
"""
"""A process that gets a signal when it has computed a step, before anybody has seen it."""

posix = pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")


@pytest.fixture
def scene(tmp_path: Path) -> Write:
    """A function that writes a scene and returns its name."""

    def write(text: str) -> str:
        path = tmp_path / "scene.toml"
        path.write_text(text, encoding="utf-8")
        return str(path)

    return write


def changed(text: str, *changes: tuple[str, str]) -> str:
    for old, new in changes:
        assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times"
        text = text.replace(old, new)
    return text


def run(scene: str, folder: Path, changes: list[str], *others: str) -> int:
    return main(["run", scene, "-o", str(folder), "--quiet", "--set", *changes, *others])


def killed(step: int, name: str, scene: str, folder: Path, changes: list[str]) -> subprocess.CompletedProcess[str]:
    """Run in a process that gets a signal in some step."""
    paths = os.pathsep.join(path for path in sys.path if path)
    command = [sys.executable, "-c", DEADLY, str(step), name]
    return subprocess.run(
        [*command, "run", scene, "-o", str(folder), "--quiet", "--set", *changes],
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=False,
        timeout=120.0,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return [{key: value for key, value in row.items() if key != "seconds"} for row in csv.DictReader(file)]


def summary(folder: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return data


def assert_same(one: Path, other: Path) -> None:
    """Two folders hold the same, to the byte, but for seconds and restart files."""
    names = [
        sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()) for folder in (one, other)
    ]
    assert names[0] == names[1]
    for name in names[0]:
        if name == "steps.csv":
            assert rows(one / name) == rows(other / name)
        elif name == "summary.json":
            first, second = summary(one), summary(other)
            assert first.pop("seconds").keys() == second.pop("seconds").keys()
            assert first == second
        elif name != "restart.npz":
            assert (one / name).read_bytes() == (other / name).read_bytes(), name


def newton(channel: str) -> str:
    """The channel with a flow that grows, solved by Newton's method with factors of earlier steps."""
    text = changed(channel, ('"4*y*(1 - y)"', '"4*y*(1 - y)*(1 + t)"'), ("steps = 5", "steps = 8"))
    text = changed(text, ("viscosity = 0.1", 'viscosity = 0.1\nconvection = "newton"'))
    return text + '\n[quantities.energy]\ntype = "kinetic-energy"\n'


def swinging(solid_alone: str, scheme: str) -> str:
    """The flap alone, in motion, advanced by a scheme."""
    alone = re.sub(r"^(a\d|d\d|b2|c2) = .*\n", "", solid_alone, flags=re.MULTILINE)
    moving = 'youngs_modulus = 1e3\ninitial_velocity = ["y", "0"]'
    text = changed(alone, ("youngs_modulus = 1e3", moving), ("end = 2.0", f'end = 0.8\nsolid = "{scheme}"'))
    return text + '\n[quantities.u_x]\ntype = "probe"\nfield = "displacement"\ncomponent = "x"\nat = "b1"\n'


def interrupted_and_resumed(scene: str, tmp_path: Path, changes: list[str], step: int, name: str) -> None:
    assert run(scene, tmp_path / "whole", changes) == 0
    done = killed(step, name, scene, tmp_path / "parts", changes)
    assert done.returncode == -getattr(signal, name), done.stderr
    assert len(rows(tmp_path / "parts" / "quantities.csv")) == step - 1
    assert summary(tmp_path / "parts")["status"] == "running"
    assert run(scene, tmp_path / "parts", changes, "--resume") == 0
    assert_same(tmp_path / "whole", tmp_path / "parts")


@posix
def test_a_coupled_run_that_was_killed_goes_on_to_the_bit(
    flap: str, scene: Write, tmp_path: Path, vtk_module: object
) -> None:
    """Killed in step 6, resumed after step 4: the row of step 5 and its files are made again."""
    changes = ["output.plots=false", "output.every=3", "output.checkpoint_every=2", "time.end=1.0"]
    interrupted_and_resumed(scene(flap), tmp_path, changes, 6, "SIGKILL")
    assert len(list((tmp_path / "parts" / "fields").iterdir())) == 8  # steps 3, 6, 9 and 10, fluid and solid


@posix
@pytest.mark.parametrize("count", [3, 5])
def test_a_run_that_is_killed_at_any_moment_goes_on_to_the_bit(
    flap: str, scene: Write, tmp_path: Path, vtk_module: object, count: int
) -> None:
    """Killed from outside, while it computes or writes."""
    text, folder = scene(flap), tmp_path / "parts"
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
    assert run(text, folder, changes, "--resume") == 0
    assert run(text, tmp_path / "whole", changes) == 0
    assert_same(tmp_path / "whole", folder)


@posix
def test_a_fluid_with_factors_of_earlier_steps_goes_on_to_the_bit(channel: str, scene: Write, tmp_path: Path) -> None:
    changes = [*TABLES_ONLY, "output.checkpoint_every=3"]
    interrupted_and_resumed(scene(newton(channel)), tmp_path, changes, 5, "SIGKILL")
    steps = rows(tmp_path / "parts" / "steps.csv")
    assert steps[-1]["factorisations"] == steps[3]["factorisations"] != "0"  # of a step before the restart file's


@posix
@pytest.mark.parametrize("scheme", ["bdf2", "generalised-alpha", "energy-momentum"])
def test_a_solid_goes_on_to_the_bit(solid_alone: str, scene: Write, tmp_path: Path, scheme: str) -> None:
    changes = [*TABLES_ONLY, "output.checkpoint_every=3"]
    interrupted_and_resumed(scene(swinging(solid_alone, scheme)), tmp_path, changes, 6, "SIGKILL")


@posix
def test_steps_chosen_by_their_error_go_on_to_the_bit(flap: str, scene: Write, tmp_path: Path) -> None:
    changes = [*TABLES_ONLY, "output.checkpoint_every=1", "time.end=0.5", "time.tolerance=1e-2"]
    whole = scene(flap)
    assert run(whole, tmp_path / "whole", changes) == 0
    steps = rows(tmp_path / "whole" / "steps.csv")
    assert len({row["dt"] for row in steps}) > 1
    # In the middle of a divided step, after one whole step at least.
    middle = next(k for k, row in enumerate(steps) if float(row["t"]) > 0.25)
    assert killed(middle, "SIGKILL", whole, tmp_path / "parts", changes).returncode == -signal.SIGKILL
    assert run(whole, tmp_path / "parts", changes, "--resume") == 0
    assert_same(tmp_path / "whole", tmp_path / "parts")


@pytest.mark.parametrize("step", [1, 2, 5, 9, 10, 11, 12])
def test_what_observers_know_goes_on_too(
    flap: str, scene: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, vtk_module: object, step: int
) -> None:
    """Broken off after any step: fields are written every fourth step, quality and resolution looked at every tenth."""
    text, changes = scene(flap), ["output.plots=false", "output.every=4", "time.end=1.2"]
    assert run(text, tmp_path / "whole", changes) == 0
    module = importlib.import_module("hofsi.run")  # the attribute of the package is the function
    simulate = module.simulate

    def broken(problem: Problem, after: StepRecord | None = None) -> Iterator[StepRecord]:
        for record in simulate(problem, after):
            yield record
            if record.step == step:
                raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(module, "simulate", broken)
        assert run(text, tmp_path / "parts", changes) == 130
    assert run(text, tmp_path / "parts", changes, "--resume") == 0
    (tmp_path / "parts" / "restart.npz").unlink()
    assert_same(tmp_path / "whole", tmp_path / "parts")


@posix
@pytest.mark.parametrize(("name", "code"), [("SIGTERM", 143), ("SIGINT", 130)])
def test_a_run_that_is_asked_to_end_says_how_to_go_on(
    flap: str, scene: Write, tmp_path: Path, name: str, code: int
) -> None:
    """The step at hand is given up; without checkpoint_every the file is that of the last step, all the same."""
    text, folder, changes = scene(flap), tmp_path / "parts", [*TABLES_ONLY, "time.end=0.6"]
    done = killed(4, name, text, folder, changes)
    assert (done.returncode, done.stdout) == (code, "")
    command = f"hofsi run {text} -o {folder} --set {' '.join(changes)} --resume"
    kept = f"What was computed until then is in {folder}."
    assert done.stderr == f"hofsi: interrupted. {kept} Go on with: {command}\n"
    data = summary(folder)
    assert (data["status"], data["reason"]) == ("interrupted", "interrupted after step 3, t = 0.3")
    assert run(text, folder, changes, "--resume") == 0
    assert run(text, tmp_path / "whole", changes) == 0
    (folder / "restart.npz").unlink()
    assert_same(tmp_path / "whole", folder)


@posix
def test_after_a_step_that_was_divided_a_run_goes_on_to_the_bit(flap: str, scene: Write, tmp_path: Path) -> None:
    """A gust that a step of 0.1 does not bear with 12 iterations, but two of 0.05: broken off between them."""
    gust = '"4*U*y*(H - y)/H**2*sin(t)*(1 + 3*exp(-((t - 0.4)/0.1)**2))"'
    text = scene(changed(flap, ('"4*U*y*(H - y)/H**2*sin(t)"', gust)))
    changes = [*TABLES_ONLY, "time.end=0.3", "coupling.max_iterations=12", "coupling.condensed=false"]
    assert run(text, tmp_path / "whole", changes) == 0
    steps = rows(tmp_path / "whole" / "steps.csv")
    assert [(row["dt"], row["rejected_because"]) for row in steps[2:]] == [("0.05", "AddedMassError"), ("0.05", "")]
    assert killed(4, "SIGTERM", text, tmp_path / "parts", changes).returncode == 143
    assert run(text, tmp_path / "parts", changes, "--resume") == 0
    (tmp_path / "parts" / "restart.npz").unlink()
    assert_same(tmp_path / "whole", tmp_path / "parts")


def test_a_run_that_gave_up_goes_on_with_smaller_steps(
    channel: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A gust that Newton's method follows in small steps only; steps are not halved."""
    text = changed(channel, ('"4*y*(1 - y)"', '"4*y*(1 - y)*(1 + 30*exp(-((t - 0.4)/0.1)**2))"'))
    text = changed(text, ("viscosity = 0.1", 'viscosity = 0.02\nconvection = "newton"'), ("steps = 5", "end = 0.6"))
    text, folder = scene(text), tmp_path / "out"
    changes = [*TABLES_ONLY, "time.halvings=0", "nonlinear.max_iterations=4"]
    assert run(text, folder, changes) == 3
    message = capsys.readouterr().err
    assert f"The last good state, t = 0.2, is in {folder / 'restart.npz'}." in message
    assert f"Go on with: hofsi run {text} -o {folder} --set {' '.join(changes)} --resume, with a smaller" in message
    assert run(text, folder, [*changes, "time.dt=0.0125"], "--resume") == 0
    steps = rows(folder / "steps.csv")
    assert [float(row["dt"]) for row in steps] == [0.1, 0.1, *[0.0125] * 32]
    assert [int(row["step"]) for row in steps] == list(range(1, 35))
    assert float(steps[-1]["t"]) == pytest.approx(0.6)
    data = summary(folder)
    assert "resumed after step 2, t = 0.2, with time.dt = 0.0125 instead of 0.1" in data["notes"]
    assert data["status"] == "completed"


def test_with_another_step_size_the_order_of_the_scheme_stays(solid_alone: str, scene: Write, tmp_path: Path) -> None:
    """The history has steps of two sizes: half way, going on with half the step lies between whole runs with either."""
    text = scene(swinging(solid_alone, "bdf2"))
    ends = {}
    for dt in (0.01, 0.005, 0.00125):
        assert run(text, tmp_path / f"{dt}", [*TABLES_ONLY, f"time.dt={dt}"]) == 0
        ends[dt] = float(rows(tmp_path / f"{dt}" / "quantities.csv")[-1]["u_x"])
    folder = tmp_path / "mixed"
    assert run(text, folder, [*TABLES_ONLY, "time.dt=0.01", "time.end=0.4", "output.checkpoint_every=40"]) == 0
    assert run(text, folder, [*TABLES_ONLY, "time.dt=0.005"], "--resume") == 0
    mixed = rows(folder / "quantities.csv")
    assert (len(mixed), float(mixed[-1]["t"])) == (120, pytest.approx(0.8))
    error = {name: abs(end - ends[0.00125]) for name, end in {**ends, "mixed": float(mixed[-1]["u_x"])}.items()}
    assert error[0.01] > 3.0 * error[0.005]
    assert error["mixed"] < error[0.01]
    notes = summary(folder)["notes"]
    assert "resumed after step 40, t = 0.4, with time.dt = 0.005 instead of 0.01" in notes
    assert "resumed after step 40, t = 0.4, with time.end = 0.8 instead of 0.4" in notes


def test_a_later_end_changes_nothing_but_the_end(flap: str, scene: Write, tmp_path: Path) -> None:
    """A run to t = 0.25 has a short last step: the steps of 0.1 are counted from there."""
    text, every = scene(flap), [*TABLES_ONLY, "output.checkpoint_every=1"]
    assert run(text, tmp_path / "whole", [*every, "time.end=0.5"]) == 0
    assert run(text, tmp_path / "parts", [*every, "time.end=0.3"]) == 0
    assert run(text, tmp_path / "parts", [*every, "time.end=0.5"], "--resume") == 0
    assert rows(tmp_path / "parts" / "steps.csv") == rows(tmp_path / "whole" / "steps.csv")
    assert run(text, tmp_path / "short", [*every, "time.end=0.25"]) == 0
    assert run(text, tmp_path / "short", [*every, "time.end=0.45"], "--resume") == 0
    times = [float(row["t"]) for row in rows(tmp_path / "short" / "quantities.csv")]
    np.testing.assert_allclose(times, [0.1, 0.2, 0.25, 0.35, 0.45])


def test_a_run_may_go_on_in_another_directory(flap: str, scene: Write, tmp_path: Path) -> None:
    text, changes = scene(flap), [*TABLES_ONLY, "output.checkpoint_every=2", "time.end=0.4"]
    assert run(text, tmp_path / "one", changes) == 0
    before = (tmp_path / "one" / "steps.csv").read_bytes()
    restart = str(tmp_path / "one" / "restart.npz")
    other = [*changes[:-1], "time.end=0.6", "coupling.acceleration=aitken", "fluid.viscosity=0.02"]
    assert run(text, tmp_path / "two", other, "--resume", restart) == 0
    assert (tmp_path / "one" / "steps.csv").read_bytes() == before
    assert (tmp_path / "two" / "steps.csv").read_bytes().startswith(before)
    assert len(rows(tmp_path / "two" / "quantities.csv")) == 6
    notes = " ".join(summary(tmp_path / "two")["notes"])
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
def test_settings_of_solvers_may_change_and_results_stay(flap: str, scene: Write, tmp_path: Path, change: str) -> None:
    if "amg" in change:
        pytest.importorskip("pyamg")
    text = scene(changed(flap, ("viscosity = 0.01", 'viscosity = 0.01\nconvection = "newton"')))
    changes = [*TABLES_ONLY, "output.checkpoint_every=1"]
    assert run(text, tmp_path / "whole", [*changes, "time.end=0.6"]) == 0
    assert run(text, tmp_path / "parts", [*changes, "time.end=0.3"]) == 0
    assert run(text, tmp_path / "parts", [*changes, "time.end=0.6", change], "--resume") == 0
    one, other = (
        [float(row["lift"]) for row in rows(tmp_path / name / "quantities.csv")] for name in ("whole", "parts")
    )
    np.testing.assert_allclose(other, one, rtol=1e-4)
    assert f"with {change.partition('=')[0]} = " in " ".join(summary(tmp_path / "parts")["notes"])


@pytest.mark.parametrize(
    "change", ["mover.type='pseudo-solid'", "time.tolerance=1e-2", "solid[0].youngs_modulus=2e3", "constants.U=1.4"]
)
def test_what_makes_it_another_problem_may_change_and_is_told(
    flap: str, scene: Write, tmp_path: Path, change: str
) -> None:
    text, changes = scene(flap), [*TABLES_ONLY, "output.checkpoint_every=1"]
    assert run(text, tmp_path / "out", [*changes, "time.end=0.3"]) == 0
    assert run(text, tmp_path / "out", [*changes, "time.end=0.5", change], "--resume") == 0
    key = change.partition("=")[0].replace("constants.U", "fluid.boundary[0].x")
    assert f"resumed after step 3, t = 0.3, with {key}" in " ".join(summary(tmp_path / "out")["notes"])
    assert rows(tmp_path / "out" / "quantities.csv")[-1]["t"] == "0.5"


def refusal(capsys: pytest.CaptureFixture[str]) -> str:
    output = capsys.readouterr()
    assert output.out == ""
    assert (output.err[:7], output.err.count("\n")) == ("hofsi: ", 1)
    return output.err[7:-1]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("mesh.order=3", "mesh.order: got 3; expected 2, with which the run was made"),
        ("constants.H=1.1", "mesh.vertices.a2: got (0.0, 1.1); expected (0.0, 1.0)"),
        ("solid[0].model='linear'", "solid[0].model: got linear; expected st-venant-kirchhoff"),
        ("fluid.model='stokes'", "fluid.model: got stokes; expected navier-stokes"),
        ("fluid.boundary[1].type='slip'", "fluid.boundary[1].type: got Slip; expected NoSlip"),
        ("time.start=0.05", "time.start: got 0.05; expected 0.0"),
        ("time.solid='generalised-alpha'", "time.solid: got generalised-alpha; expected bdf2"),
        ("quantities.lift.component='x'", "quantities.lift.component: got x; expected y"),
        ("time.end=0.1", "time.end: got 0.1; expected at least 0.2, the time of the restart file"),
    ],
)
def test_what_cannot_change_is_refused(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str], change: str, message: str
) -> None:
    text, folder = scene(flap), tmp_path / "out"
    changes = [*TABLES_ONLY, "output.checkpoint_every=1", "time.end=0.2"]
    assert run(text, folder, changes) == 0
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert run(text, folder, [*changes, change], "--resume") == 2
    assert message in refusal(capsys)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


@pytest.mark.parametrize("content", [b"", b"not a restart file", b"PK\x03\x04 but no more"])
def test_a_file_that_is_damaged_is_refused(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str], content: bytes
) -> None:
    path = tmp_path / "restart.npz"
    path.write_bytes(content)
    assert run(scene(flap), tmp_path / "out", TABLES_ONLY, "--resume", str(path)) == 2
    assert f"{path}: is not a restart file of hofsi, or is damaged" in refusal(capsys)
    assert not (tmp_path / "out").exists()


def rewritten(path: Path, **changes: object) -> None:
    """Change what a restart file says of itself."""
    with np.load(path) as archive:
        arrays = dict(archive)
    head = {**json.loads(arrays["head"].tobytes()), **changes}
    arrays["head"] = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
    with path.open("wb") as file:
        np.savez(file, **arrays)


def test_nodes_that_are_others_are_refused(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As those of a mesh file that has changed, although its name has not."""
    text, folder, changes = scene(flap), tmp_path / "out", [*TABLES_ONLY, "output.checkpoint_every=1", "time.end=0.2"]
    assert run(text, folder, changes) == 0
    rewritten(folder / "restart.npz", mesh="0123")
    assert run(text, folder, changes, "--resume") == 2
    assert f"mesh: its nodes are not those of the run that wrote {folder / 'restart.npz'}" in refusal(capsys)


def test_other_versions_of_libraries_are_told(flap: str, scene: Write, tmp_path: Path) -> None:
    text, folder, changes = scene(flap), tmp_path / "out", [*TABLES_ONLY, "output.checkpoint_every=1", "time.end=0.2"]
    assert run(text, folder, changes) == 0
    rewritten(folder / "restart.npz", versions={**summary(folder)["versions"], "numpy": "0.9"})
    assert run(text, folder, changes, "--resume") == 0
    (note,) = (note for note in summary(folder)["notes"] if "resumed" in note)
    assert note.startswith(f"resumed after step 2, t = 0.2, with numpy {np.__version__} instead of 0.9: rounding may")


def test_without_a_restart_file_nothing_can_be_resumed(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(scene(flap), tmp_path / "out", TABLES_ONLY, "--resume") == 2
    assert f"{tmp_path / 'out' / 'restart.npz'}: there is no restart file" in refusal(capsys)
    assert not (tmp_path / "out").exists()


def test_a_new_run_removes_the_restart_file_of_an_older_one(flap: str, scene: Write, tmp_path: Path) -> None:
    text, folder = scene(flap), tmp_path / "out"
    assert run(text, folder, [*TABLES_ONLY, "output.checkpoint_every=1", "time.end=0.2"]) == 0
    assert (folder / "restart.npz").is_file()
    assert run(text, folder, [*TABLES_ONLY, "time.end=0.1"]) == 0
    assert not (folder / "restart.npz").exists()


def test_a_table_that_lost_rows_is_not_continued(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, folder = scene(flap), tmp_path / "out"
    changes = [*TABLES_ONLY, "output.checkpoint_every=1", "time.end=0.2"]
    assert run(text, folder, changes) == 0
    table = folder / "steps.csv"
    table.write_bytes(table.read_bytes()[:-20])
    assert run(text, folder, [*changes, "time.end=0.3"], "--resume") == 2
    assert f"{table}: has {table.stat().st_size} bytes; expected at least" in refusal(capsys)


def test_a_steady_state_is_not_resumed(
    solid_alone: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = scene(swinging(solid_alone, "bdf2"))
    changes = [*TABLES_ONLY, "output.checkpoint_every=1", "time.end=0.2"]
    assert run(text, tmp_path / "out", changes) == 0
    others = [*changes[:-1], "time.steady=true"]
    assert run(text, tmp_path / "out", others, "--resume") == 2
    assert "time.steady: got true; a steady state has no steps to go on after" in refusal(capsys)
