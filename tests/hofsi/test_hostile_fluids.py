"""Fluids that cannot be simulated, as a user meets them: an exit code and one message with a way out, no traceback."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from hofsi.cli import main

VISCOSITY, INFLOW, TIME = "viscosity = 0.1", 'x = "4*y*(1 - y)"', "dt = 0.1\nsteps = 5"
OUTLET, STEADY = 'type = "do-nothing"', "steady = true"
INLET = f'type = "velocity"\n{INFLOW}\ny = 0'

# Changes, exit code and message of check, of run.
BAD = {
    "zero viscosity": ([(VISCOSITY, "viscosity = 0")], "fluid.viscosity: got 0; expected a number above 0"),
    "negative density": ([("density = 1.0", "density = -1")], "fluid.density: got -1; expected a number above 0"),
    "infinite density": ([("density = 1.0", "density = inf")], "fluid.density: got inf; expected a number that is fin"),
    "an edge twice in a condition": ([('on = "left"', 'on = ["left", "left"]')], "'left' is listed more than once"),
    "an edge in two conditions": (
        [('on = "right"', 'on = ["right", "left"]')],
        "fluid.boundary[2].on: edge a–d of 'left' has two conditions: this one and fluid.boundary[1]; expected one",
    ),
    "a force that is no number": ([(VISCOSITY, f"{VISCOSITY}\nbody_force = [nan, 0]")], 'expression "nan" is nan'),
    "an inflow without an outlet": ([(OUTLET, 'type = "no-slip"')], "bring in 0.6667 per unit time more than they let"),
    "a steady inflow without an outlet": (
        [(OUTLET, 'type = "no-slip"'), (TIME, STEADY)],
        "Correct the given velocities, open a boundary",
    ),
    "an initial velocity that is no number": (
        [(VISCOSITY, f'{VISCOSITY}\ninitial_velocity = ["1/x", 0]')],
        'fluid.initial_velocity[0]: expression "1/x" is inf at x = 0',
    ),
    "a steady fluid that nothing holds": (
        [(INLET, 'type = "pressure"\nvalue = 1'), ('type = "no-slip"', 'type = "do-nothing"'), (TIME, STEADY)],
        "no condition gives a velocity, only tractions or pressures",
    ),
    "no time step": ([("dt = 0.1", "dt = 0")], "time.dt: got 0; expected a number above 0"),
}
# What only the run can find.
LATE = {
    "a force that is no number everywhere": (
        [(VISCOSITY, f'{VISCOSITY}\nbody_force = ["log(x - 1)", 0]')],
        2,
        'fluid.body_force[0]: expression "log(x - 1)" is nan at x = ',
    ),
    "an inflow that is no number later": ([(INFLOW, 'x = "sqrt(0.25 - t)"')], 2, "is nan at x = 0, y = 0, t = 0.3"),
    "an outlet that closes": (
        [(OUTLET, f'type = "velocity"\n{INFLOW[:-1]}*(t < 0.25)"\ny = 0')],
        2,
        "fluid.boundary: the velocities around an enclosed part of the fluid bring in 0.6667 per unit time more",
    ),
    "an initial velocity beyond all numbers": (
        [(VISCOSITY, f'{VISCOSITY}\ninitial_velocity = ["1e200*y", 0]')],
        3,
        "check the given velocities",
    ),
    "steps that few iterations do not reach": (
        [
            (VISCOSITY, 'viscosity = 1e-3\nconvection = "newton"'),
            ("[output]", "[nonlinear]\nmax_iterations = 1\n[output]"),
        ],
        3,
        "Newton's method stopped at a relative residual of",
    ),
    "a mesh that a motion turns over": (
        [("[time]", '[[motion]]\non = "right"\nx = "-9*t"\ny = 0\n\n[time]')],
        3,
        "Use smaller steps, another [mover], or more blocks around the moving body",
    ),
}


Written = Callable[[list[tuple[str, str]]], str]


@pytest.fixture
def written(tmp_path: Path, channel: str) -> Written:
    """A function that changes the channel, writes it to a file, and returns the file's name."""

    def write(changes: list[tuple[str, str]]) -> str:
        text = channel + "\n[output]\nfields = false\nplots = false\n"
        for old, new in changes:
            assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times"
            text = text.replace(old, new)
        path = tmp_path / "scene.toml"
        path.write_text(text, encoding="utf-8")
        return str(path)

    return write


def one_message(capsys: pytest.CaptureFixture[str]) -> str:
    output = capsys.readouterr()
    assert output.out == ""
    assert (output.err[:7], output.err.count("\n")) == ("hofsi: ", 1)
    return output.err


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_refused_before_anything_is_computed(
    tmp_path: Path, written: Written, capsys: pytest.CaptureFixture[str], name: str, command: str
) -> None:
    changes, message = BAD[name]
    scene, folder = written(changes), tmp_path / "out"
    arguments = ["check", scene] if command == "check" else ["run", scene, "-o", str(folder), "--quiet"]
    assert main(arguments) == 2
    text = one_message(capsys)
    assert text.startswith(f"hofsi: {scene}: ")
    assert message in text
    assert not folder.exists()


@pytest.mark.parametrize("name", LATE)
def test_what_only_a_run_can_find_ends_it_with_a_message(
    tmp_path: Path, written: Written, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    changes, code, message = LATE[name]
    folder = tmp_path / "out"
    assert main(["run", written(changes), "-o", str(folder), "--quiet"]) == code
    assert message in one_message(capsys)
    assert json.loads((folder / "summary.json").read_text(encoding="utf-8"))["status"] == "failed"


def test_notes_are_part_of_check_and_of_a_run(
    tmp_path: Path, written: Written, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = written([(OUTLET, INLET.replace("4*y", "4.04*y"))])
    assert main(["check", scene]) == 0
    output = capsys.readouterr()
    assert output.err == ""
    notes = output.out[output.out.index("notes:\n") :]
    assert "\n  The fluid is enclosed by given velocities: the pressure is determined but for a constant" in notes
    assert main(["run", scene, "-o", str(tmp_path / "out")]) == 0
    assert "note: The fluid is enclosed by given velocities" in capsys.readouterr().err
    kept = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["notes"]
    assert len(kept) == 2  # that it is enclosed, and that something is left over
    assert [f"  {note}." for note in kept] == notes.splitlines()[1:]
