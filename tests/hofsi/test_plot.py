"""Pictures: which files there are, and that what they show is where it should be."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from hoblock.errors import MissingExtraError
from hofsi.build import Problem, build
from hofsi.case import Case
from hofsi.plot import plot_run
from hofsi.plot.series import plot_series
from hofsi.records import StepRecord
from hofsi.simulate import simulate

pytest.importorskip("matplotlib")

Read = Callable[..., Case]
Array = NDArray[np.float64]

TWO = ("dt = 0.1\nend = 2.0", "dt = 0.1\nsteps = 2")
SOLID = np.array([0xB8, 0xBE, 0xC6]) / 255.0
TIMES = np.linspace(0.1, 6.0, 60)
SERIES = {"t": TIMES, "u_x": np.sin(TIMES), "lift": np.cos(2 * TIMES)}


@pytest.fixture
def coupled(read_changed: Read) -> tuple[Problem, StepRecord]:
    """The flap after two steps."""
    return _last(read_changed(TWO))


def _last(case: Case) -> tuple[Problem, StepRecord]:
    problem = build(case)
    return problem, list(simulate(problem))[-1]


def _pixels(path: Path) -> Array:
    from matplotlib.image import imread

    return np.asarray(imread(path)[..., :3], dtype=float)


def _colours(path: Path) -> int:
    return len(np.unique((255 * _pixels(path)).round().astype(int).reshape(-1, 3), axis=0))


def _names(paths: list[Path]) -> list[str]:
    return [path.name for path in paths]


def _interior(pixels: Array) -> tuple[slice, slice]:
    """Rows and columns of the coloured region: the largest box whose rim is not white."""
    coloured = (pixels.max(axis=2) - pixels.min(axis=2)) > 0.1
    rows, columns = coloured.mean(axis=1) > 0.3, coloured.mean(axis=0) > 0.3
    return (slice(*np.flatnonzero(rows)[[0, -1]]), slice(*np.flatnonzero(columns)[[0, -1]]))


def test_files_of_a_coupled_run(coupled: tuple[Problem, StepRecord], tmp_path: Path) -> None:
    written = plot_run(*coupled, SERIES, tmp_path / "out")
    expected = ["mesh.png", "velocity.png", "pressure.png", "quantities.png", "u_x.png"]
    assert _names(written) == expected
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(expected)
    for path in written:
        height, width, _ = _pixels(path).shape
        assert width > 1000
        assert height > 400
    assert _colours(tmp_path / "out" / "velocity.png") > 200
    assert _colours(tmp_path / "out" / "pressure.png") > 100
    for name in ("mesh.png", "velocity.png", "pressure.png"):
        _check_solid(tmp_path / "out" / name)


def _check_solid(path: Path) -> None:
    """The flap is 0.2 wide and 0.5 high."""
    solid = np.abs(_pixels(path) - SOLID).max(axis=2) < 0.01
    rows, columns = np.flatnonzero(solid.any(axis=1)), np.flatnonzero(solid.any(axis=0))
    assert np.ptp(rows) / np.ptp(columns) == pytest.approx(0.5 / 0.2, rel=0.15)
    assert solid.sum() > 0.8 * np.ptp(rows) * np.ptp(columns)


def test_colours_follow_the_field(read_changed: Read, fluid_alone: str, tmp_path: Path) -> None:
    problem, record = _last(read_changed(TWO, text=fluid_alone))
    assert problem.fluid is not None
    assert record.state.fluid is not None
    velocity = np.zeros(problem.fluid.mesh.points.shape)
    velocity[:, 1] = -problem.fluid.mesh.points[:, 0]  # speed x, from 0 to 3
    fluid = replace(record.state.fluid, velocities=(velocity,))
    plot_run(problem, replace(record, state=replace(record.state, fluid=fluid)), {"t": TIMES}, tmp_path)
    pixels = _pixels(tmp_path / "velocity.png")
    rows, columns = _interior(pixels)
    line = pixels[rows.start + (rows.stop - rows.start) // 8, columns].mean(axis=1)  # above the flap
    places = np.linspace(0.05, 0.95, 12)
    brightness = np.interp(places, np.linspace(0.0, 1.0, len(line)), line)
    assert (np.diff(brightness) > 0.0).all()


def test_a_steady_case_has_fields_only(read_changed: Read, tmp_path: Path) -> None:
    stiff = ("youngs_modulus = 1e3", "youngs_modulus = 1e6")
    steady = ("dt = 0.1\nend = 2.0", "steady = true"), ("*sin(t)", "")
    case = read_changed(*steady, ("viscosity = 0.01", "viscosity = 0.5"), stiff)
    series = {"t": np.zeros(1), "u_x": np.ones(1)}
    assert _names(plot_run(*_last(case), series, tmp_path)) == ["mesh.png", "velocity.png", "pressure.png"]


def test_a_solid_alone(read_changed: Read, solid_alone: str, tmp_path: Path) -> None:
    text = re.sub(r"^[ad]\d = .*\n|^[bc]2 = .*\n", "", solid_alone, flags=re.MULTILINE)
    case = read_changed(("poissons_ratio = 0.4", "poissons_ratio = 0.4\ngravity = [5, 0]"), TWO, text=text)
    assert _names(plot_run(*_last(case), {"t": TIMES}, tmp_path)) == ["mesh.png", "displacement.png"]
    assert _colours(tmp_path / "displacement.png") > 100
    height, width, _ = _pixels(tmp_path / "mesh.png").shape
    assert height > width  # the flap is upright


def test_a_field_that_is_zero_can_be_drawn(read_changed: Read, fluid_alone: str, tmp_path: Path) -> None:
    problem, record = _last(read_changed(TWO, ('x = "4*U*y*(H - y)/H**2*sin(t)"', "x = 0"), text=fluid_alone))
    written = plot_run(problem, record, {"t": TIMES}, tmp_path)
    assert _names(written) == ["mesh.png", "velocity.png", "pressure.png"]


def test_the_first_quantity_is_larger(tmp_path: Path) -> None:
    high = plot_series(SERIES, tmp_path, "A title", "lift", alone=None)[0]
    first = _pixels(high).shape[0]
    low = plot_series(SERIES, tmp_path, "A title", None, alone=None)[0]
    assert first > 1.2 * _pixels(low).shape[0]


def test_a_curve_is_where_its_values_are(tmp_path: Path) -> None:
    path = plot_series({"t": TIMES, "rise": TIMES}, tmp_path, "", "rise", alone=None)[0]
    pixels = _pixels(path)
    line = np.abs(pixels - np.array([0x1F, 0x4E, 0x8C]) / 255).max(axis=2) < 0.02
    rows, columns = np.nonzero(line)
    assert np.ptp(columns) > 0.7 * pixels.shape[1]
    slope, _ = np.polyfit(columns, rows, 1)
    assert slope * np.ptp(columns) == pytest.approx(-np.ptp(rows), rel=0.05)


def test_short_peaks_do_not_flatten_the_rest(tmp_path: Path) -> None:
    values = np.sin(4.0 * TIMES)
    values[0] = 1e4
    pixels = _pixels(plot_series({"t": TIMES, "f": values}, tmp_path, "", "f", alone=None)[0])
    line = np.abs(pixels - np.array([0x1F, 0x4E, 0x8C]) / 255).max(axis=2) < 0.02
    later = line[:, int(0.3 * line.shape[1]) :]
    assert np.ptp(np.flatnonzero(later.any(axis=1))) > 0.4 * line.shape[0]


def test_values_that_are_not_finite_are_left_out(tmp_path: Path) -> None:
    values = np.where(TIMES > 3.0, np.nan, TIMES)
    path = plot_series({"t": TIMES, "p": values, "none": np.full(60, np.nan)}, tmp_path, "", "p", alone="p")[1]
    assert _colours(path) > 10


def test_a_quantity_does_not_overwrite_a_field(tmp_path: Path) -> None:
    written = plot_series({"t": TIMES, "velocity": TIMES}, tmp_path, "", "velocity", alone="velocity")
    assert _names(written) == ["quantities.png", "velocity_over_time.png"]


def test_series_of_other_lengths_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"series 'u' has 3 values; expected 60, one for each time"):
        plot_series({"t": TIMES, "u": np.zeros(3)}, tmp_path, "", None, alone=None)


def test_the_error_without_matplotlib_names_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("matplotlib", "matplotlib.figure"):
        monkeypatch.setitem(sys.modules, name, None)  # type: ignore[arg-type]
    with pytest.raises(MissingExtraError, match=r"pip install 'hofsi-coupler\[plot\]'"):
        plot_series(SERIES, tmp_path, "", None, alone=None)


def test_no_window_library_is_loaded() -> None:
    code = (
        "import sys, tempfile, pathlib, numpy\nfrom hofsi.plot.series import plot_series\n"
        "assert 'matplotlib' not in sys.modules\n"
        "t = numpy.arange(4.0)\nwith tempfile.TemporaryDirectory() as folder:\n"
        "    plot_series({'t': t, 'u': t}, pathlib.Path(folder), '', None, alone=None)\n"
        "assert 'matplotlib' in sys.modules\nassert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env={"PYTHONPATH": ":".join(p for p in sys.path if p)})
