"""Coupled scenes built to fail end with an exit code and a message that names the cause."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from hofsi.cli import main

TIME, COUPLING, YOUNG = "dt = 0.1\nend = 2.0", "[coupling]", "youngs_modulus = 1e3"
STEADY = [(TIME, "steady = true"), ("*sin(t)", "")]
LIGHT = [("density = 3.0", "density = 0.01"), (TIME, "dt = 0.001\nend = 0.02")]
OUTPUT = ("[output]", "[output]\nfields = false\nplots = false")

# Changes and parts of the message of scenes that end with exit code 3.
GIVEN_UP = {
    "an absurd inflow": (
        [("U = 1.5", "U = 1e4")],
        ["t = 0.00625: the interface ends ", "from where it was predicted", "That was the smallest step"],
    ),
    "an inflow that breaks the solid at large steps": (
        [(TIME, "dt = 2.0\nend = 20.0"), ("U = 1.5", "U = 40"), (COUPLING, "[coupling]\ncondensed = false")],
        ["solid, t = 0.125: Newton's method stopped", "apply the load more slowly"],
    ),
    "a weight that crushes": (
        [(YOUNG, "youngs_modulus = 10\ngravity = [0, -900]")],
        ["solid, t = ", "the solid is turned inside out", "check the loads"],
    ),
    "a steady solid that is too soft": (
        [*STEADY, (YOUNG, "youngs_modulus = 1")],
        ["fluid mesh, ", "of the fluid's load was reached: there may be no steady state", "or march in time"],
    ),
    "a steady solid that buckles": (
        [*STEADY, (YOUNG, f'{YOUNG}\nbody_force = [0, "-3e3"]')],
        ["fluid mesh, ", "cross near", "as of a solid that buckles", "stiffen the solid"],
    ),
    "added mass with constant relaxation": (
        [*LIGHT, (COUPLING, '[coupling]\ncondensed = false\nacceleration = "constant"')],
        ["coupling, t = ", "diverging: ", "its added mass dominates a light solid", "is not halved again"],
    ),
    "added mass with few iterations of Aitken": (
        [*LIGHT, (COUPLING, '[coupling]\ncondensed = false\nacceleration = "aitken"\nmax_iterations = 10')],
        [
            "not converged after 10 iterations",
            "its added mass",
            "Leave coupling.condensed on, or set coupling.acceleration",
        ],
    ),
    "steps whose accelerations are rounding": (
        [(TIME, "dt = 1e-9\nsteps = 3"), ("*sin(t)", ""), (COUPLING, '[coupling]\ngeometry = "implicit"')],
        ["coupling, t = ", "so small that rounding of positions makes", "raise time.dt"],
    ),
    "too few iterations": (
        [(COUPLING, "[coupling]\ncondensed = false\nmax_iterations = 2")],
        ["coupling, t = ", "not converged after 2 iterations", "raise coupling.max_iterations"],
    ),
}
# Changes and messages of scenes that are bad input.
REFUSED = {
    "inflow into an enclosed fluid": (
        [('type = "do-nothing"', 'type = "no-slip"')],
        "leaves the solid no room to move",
    ),
    "steady inflow into an enclosed fluid": (
        [*STEADY, ('type = "do-nothing"', 'type = "no-slip"')],
        "bring in 1 per unit time more than they let out",
    ),
}
Run = Callable[[list[tuple[str, str]]], tuple[int, str, Path]]


@pytest.fixture
def run(tmp_path: Path, flap: str, capsys: pytest.CaptureFixture[str]) -> Run:
    """A function that changes the flap's scene and runs it: exit code, message and folder."""

    def run_changed(changes: list[tuple[str, str]]) -> tuple[int, str, Path]:
        text = flap
        for old, new in [*changes, OUTPUT]:
            assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times"
            text = text.replace(old, new)
        path = tmp_path / "scene.toml"
        path.write_text(text, encoding="utf-8")
        code = main(["run", str(path), "-o", str(tmp_path / "out"), "--quiet"])
        return code, capsys.readouterr().err, tmp_path / "out"

    return run_changed


@pytest.mark.parametrize("name", GIVEN_UP)
def test_a_hopeless_scene_ends_with_its_cause(run: Run, name: str) -> None:
    changes, parts = GIVEN_UP[name]
    code, message, folder = run(changes)
    assert code == 3
    assert message.count("\n") == 1
    for part in parts:
        assert part in message
    assert json.loads((folder / "summary.json").read_text(encoding="utf-8"))["status"] == "failed"


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_solution_is_refused(run: Run, name: str) -> None:
    changes, part = REFUSED[name]
    code, message, _ = run(changes)
    assert code == 2
    assert part in message


@pytest.mark.parametrize("acceleration", ["iqn-ils", "imvj"])
def test_a_light_solid_is_no_trouble_for_quasi_newton_methods(run: Run, acceleration: str) -> None:
    code, message, folder = run([*LIGHT, (COUPLING, f'[coupling]\nacceleration = "{acceleration}"')])
    assert (code, message) == (0, "")
    counts = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["counts"]
    assert 20 <= counts["steps"] <= 24  # the sudden start may want smaller steps
    assert counts["coupling_iterations"] <= 15 * counts["steps"]


@pytest.mark.parametrize("geometry", ["implicit", "extrapolated"])
@pytest.mark.parametrize("inflow", ["0", "1e-13*y*(H - y)", "4*U*y*(H - y)/H**2*(t - 0.35) if t > 0.35 else 0"])
def test_a_fluid_that_hardly_moves_may_have_a_load_of_rounding(run: Run, inflow: str, geometry: str) -> None:
    changes = [(TIME, "dt = 0.1\nsteps = 5"), (COUPLING, f'[coupling]\ngeometry = "{geometry}"')]
    code, message, _ = run([*changes, ("4*U*y*(H - y)/H**2*sin(t)", inflow)])
    assert (code, message) == (0, "")
