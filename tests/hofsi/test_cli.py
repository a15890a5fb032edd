"""The command line: exit codes, messages, files."""

from __future__ import annotations

import csv
import importlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import hofsi
from hofsi.cli import main

TABLES_ONLY = ["--set", "output.fields=false", "--set", "output.plots=false"]
Write = Callable[[str], str]


@pytest.fixture
def scene(tmp_path: Path) -> Write:
    """A function that writes a scene and returns its name."""

    def write(text: str) -> str:
        path = tmp_path / "scene.toml"
        path.write_text(text, encoding="utf-8")
        return str(path)

    return write


def changed(text: str, old: str, new: str) -> str:
    assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times"
    return text.replace(old, new)


def run(scene: str, folder: Path, *others: str) -> int:
    return main(["run", scene, "-o", str(folder), *TABLES_ONLY, *others])


def one_message(capsys: pytest.CaptureFixture[str]) -> str:
    """Standard error is one line, standard output nothing."""
    output = capsys.readouterr()
    assert output.out == ""
    assert (output.err[:7], output.err[-1], output.err.count("\n")) == ("hofsi: ", "\n", 1)
    return output.err[7:-1]


def test_a_run_ends_with_a_table(flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "out"
    assert run(scene(flap), folder, "--set", "time.end=0.3") == 0
    output = capsys.readouterr()
    assert "step 3/3" in output.err
    lines = output.out.splitlines()
    assert lines[0].startswith("completed: 3 steps in ")
    assert lines[1].split() == ["quantity", "last", "mean", "±", "amplitude", "frequency"]
    with (folder / "quantities.csv").open(encoding="utf-8", newline="") as file:
        last = list(csv.DictReader(file))[-1]
    for line, name in zip(lines[2:4], ("u_x", "lift"), strict=True):
        assert line.split() == [name, f"{float(last[name]):.7g}", "–", "–"]
    assert lines[4].startswith("seconds: ")
    assert lines[5] == f"{folder}: quantities.csv, steps.csv, summary.json"
    data = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert data["scene"]["changes"][-1] == "time.end=0.3"


def test_oscillations_are_in_the_table(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = changed(changed(flap, "sin(t)", "sin(2*pi*t/0.8)"), "youngs_modulus = 1e3", "youngs_modulus = 1e4")
    changes = ["--set", "time.dt=0.05", "--set", "output.period_of=lift"]
    assert run(scene(text), tmp_path / "out", "--quiet", *changes) == 0
    data = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    lift = data["quantities"]["lift"]
    # Inertia dominates: the load has the frequency of the inflow.
    assert lift["frequency"] == pytest.approx(1.0 / 0.8, rel=0.05)
    assert lift["amplitude"] > 0.0
    assert capsys.readouterr() == ("", "")


def test_quiet_says_nothing(flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(scene(flap), tmp_path / "out", "--quiet", "--set", "time.end=0.2") == 0
    assert capsys.readouterr() == ("", "")


def test_check_says_what_would_be_done_and_writes_nothing(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = scene(flap)
    assert main(["check", name, "--set", "coupling.acceleration=aitken"]) == 0
    output = capsys.readouterr()
    assert output.err == ""
    assert output.out.startswith("Flap in a channel\nbuilt:\n")
    assert "Aitken" in output.out
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


def test_a_run_that_does_not_converge_returns_3_and_says_where_its_results_are(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = changed(flap, "youngs_modulus = 1e3", 'youngs_modulus = 1e3\nbody_force = ["1e8 if t > 0.25 else 0", 0]')
    folder = tmp_path / "out"
    assert run(scene(text), folder, "--quiet") == 3
    message = one_message(capsys)
    assert "t = 0.25" in message
    assert f"What was computed until then is in {folder}." in message
    data = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert (data["status"], data["t"]) == ("failed", pytest.approx(0.25, abs=0.0063))
    assert data["reason"] in message


BROKEN = {
    "a typo in a key": ("viscosity = 0.01", "viscosty = 0.01", "fluid.viscosity", "Is it misspelt as 'viscosty'?"),
    "an inverted block": (
        "a0 = [0, 0]",
        "a0 = [2, 0.9]",
        "blocks.fluid[0] (a0, b0, b1, a1)",
        "List its vertices counter-clockwise",
    ),
    "a block listed clockwise": (
        '["a0", "b0", "b1", "a1"]',
        '["a0", "a1", "b1", "b0"]',
        "blocks.fluid[0] (a0, a1, b1, b0)",
        "List its vertices counter-clockwise",
    ),
    "an unknown name": ('on = "outlet"', 'on = "outlett"', "fluid.boundary[2].on", "Did you mean 'outlet'?"),
    "an expression with __import__": (
        '"4*U*y*(H - y)/H**2*sin(t)"',
        "\"__import__('os').getcwd()\"",
        "fluid.boundary[0].x",
        "__import__",
    ),
    "a curve that misses its vertex": (
        "[fluid]\n",
        '[[mesh.curve]]\non = [["a2", "b2"]]\nkind = "parametric"\nx = "s"\ny = "H + 0.1*s"\n\n[fluid]\n',
        "mesh.curve[0]",
        "must coincide",
    ),
    "a missing boundary condition": (
        '[[fluid.boundary]]\non = "outlet"\ntype = "do-nothing"\n',
        "",
        "fluid.boundary",
        "add a [[fluid.boundary]]",
    ),
    "a negative density": ("density = 2.0", "density = -2.0", "fluid.density", "expected a number above 0"),
    "a non-conforming count": (
        "[fluid]\n",
        '[[mesh.count]]\non = [["a0", "b0"]]\nelements = 2\n\n'
        '[[mesh.count]]\non = [["a2", "b2"]]\nelements = 3\n\n[fluid]\n',
        "mesh.count[1]",
        "Change or remove one",
    ),
    "a wrong type": ("order = 2", 'order = "two"', "mesh.order", "expected"),
    "an empty file": (None, "", "", "expected at least [mesh]"),
    "a probe in the wrong body": ('at = "b1"', "at = [0.5, 0.5]", "quantities.u_x.at", "Correct the coordinates"),
    "a fluid of first order": ("order = 2", "order = 1", "mesh.order", "2 or higher"),
}


@pytest.mark.parametrize("command", ["run", "check"])
@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_scene_gets_one_message_with_place_and_remedy(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, command: str
) -> None:
    old, new, place, remedy = BROKEN[name]
    file = scene(new if old is None else changed(flap, old, new))
    folder = tmp_path / "out"
    code = main(["check", file]) if command == "check" else run(file, folder)
    message = one_message(capsys)
    assert code == 2
    assert message.startswith(f"{file}: ")
    assert message.count(file) == 1
    assert place in message
    assert remedy in message
    assert not folder.exists()


def test_a_file_that_does_not_exist(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(tmp_path / "scene.toml")]) == 2
    assert one_message(capsys) == f"{tmp_path / 'scene.toml'}: no such file. Check the name and the folder"


@pytest.mark.parametrize(
    ("change", "message"),
    [("mesh.order", "expected key=value"), ("mesh.ordr=3", "mesh.ordr"), ("time.dt=-1", "time.dt")],
)
def test_a_change_that_makes_no_sense(
    flap: str, scene: Write, capsys: pytest.CaptureFixture[str], change: str, message: str
) -> None:
    assert main(["check", scene(flap), "--set", change]) == 2
    assert message in one_message(capsys)


def test_an_output_directory_that_is_a_file(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "out"
    folder.write_text("mine", encoding="utf-8")
    assert run(scene(flap), folder) == 2
    message = one_message(capsys)
    assert message.startswith(f"{folder}: ")
    assert "Check the output directory" in message
    assert folder.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("arguments", [[], ["run", "scene.toml"], ["fly", "scene.toml"], ["check"]])
def test_a_command_that_makes_no_sense(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as error:
        main(arguments)
    assert error.value.code == 2
    assert "usage: hofsi" in capsys.readouterr().err


def test_the_version(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as error:
        main(["--version"])
    assert error.value.code == 0
    assert capsys.readouterr().out == f"hofsi {hofsi.__version__}\n"


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}


def lines_of(path: Path) -> int:
    return path.read_text(encoding="utf-8").count("\n") if path.exists() else 0


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT to send")
def test_an_interrupted_process_writes_everything_and_returns_130(flap: str, scene: Write, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    command = [sys.executable, "-m", "hofsi", "run", scene(flap), "-o", str(folder), *TABLES_ONLY]
    process = subprocess.Popen(
        [*command, "--set", "time.end=1e4"],
        env=environment(),
        text=True,
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        # A shell that runs the tests in the background makes them, and their children, ignore SIGINT.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    limit = time.monotonic() + 60.0
    while lines_of(folder / "quantities.csv") < 4 and time.monotonic() < limit and process.poll() is None:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60.0)
    assert process.returncode == 130
    kept = f"hofsi: interrupted. What was computed until then is in {folder}. Go on with: hofsi run "
    assert errors.splitlines()[-1].startswith(kept)
    assert "Traceback" not in errors
    data = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert data["status"] == "interrupted"
    assert lines_of(folder / "steps.csv") == data["counts"]["steps"] + 1 >= 4


def test_an_interruption_before_the_first_step_does_not_point_to_old_results(
    flap: str, scene: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "out"
    assert run(scene(flap), folder, "--quiet", "--set", "time.end=0.1") == 0

    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(importlib.import_module("hofsi.run"), "build", interrupt)
    assert run(scene(flap), folder) == 130
    assert one_message(capsys) == "interrupted."


def test_python_m_hofsi_returns_the_exit_code(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "hofsi", "check", str(tmp_path / "none.toml")]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("hofsi: ")
