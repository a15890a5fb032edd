"""What is not resumed, or not without a word, and why."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest


def rewritten(path: Path, **changes: object) -> None:
    """Change what a restart file says of itself."""
    with np.load(path) as archive:
        arrays = dict(archive)
    head = {**json.loads(arrays["head"].tobytes()), **changes}
    arrays["head"] = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
    with path.open("wb") as file:
        np.savez(file, **arrays)


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
    flap: str, runs: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str], change: str, message: str
) -> None:
    text, folder = runs.scene(flap), tmp_path / "out"
    changes = [*runs.tables_only, "output.checkpoint_every=1", "time.end=0.2"]
    assert runs.run(text, folder, changes) == 0
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert runs.run(text, folder, [*changes, change], "--resume") == 2
    assert message in refusal(capsys)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


@pytest.mark.parametrize("content", [b"", b"not a restart file", b"PK\x03\x04 but no more"])
def test_a_file_that_is_damaged_is_refused(
    flap: str, runs: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str], content: bytes
) -> None:
    path = tmp_path / "restart.npz"
    path.write_bytes(content)
    assert runs.run(runs.scene(flap), tmp_path / "out", [*runs.tables_only], "--resume", str(path)) == 2
    assert f"{path}: is not a restart file of hofsi, or is damaged" in refusal(capsys)
    assert not (tmp_path / "out").exists()


def test_nodes_that_are_others_are_refused(
    flap: str, runs: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As those of a mesh file that has changed, although its name has not."""
    text, folder, changes = (
        runs.scene(flap),
        tmp_path / "out",
        [*runs.tables_only, "output.checkpoint_every=1", "time.end=0.2"],
    )
    assert runs.run(text, folder, changes) == 0
    rewritten(folder / "restart.npz", mesh="0123")
    assert runs.run(text, folder, changes, "--resume") == 2
    assert f"mesh: its nodes are not those of the run that wrote {folder / 'restart.npz'}" in refusal(capsys)


def test_without_a_restart_file_nothing_can_be_resumed(
    flap: str, runs: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert runs.run(runs.scene(flap), tmp_path / "out", [*runs.tables_only], "--resume") == 2
    assert f"{tmp_path / 'out' / 'restart.npz'}: there is no restart file" in refusal(capsys)
    assert not (tmp_path / "out").exists()


def test_a_table_that_lost_rows_is_not_continued(
    flap: str, runs: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, folder = runs.scene(flap), tmp_path / "out"
    changes = [*runs.tables_only, "output.checkpoint_every=1", "time.end=0.2"]
    assert runs.run(text, folder, changes) == 0
    table = folder / "steps.csv"
    table.write_bytes(table.read_bytes()[:-20])
    assert runs.run(text, folder, [*changes, "time.end=0.3"], "--resume") == 2
    assert f"{table}: has {table.stat().st_size} bytes; expected at least" in refusal(capsys)


def test_a_steady_state_is_not_resumed(
    solid_alone: str, runs: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = runs.scene(runs.swinging(solid_alone, "bdf2"))
    changes = [*runs.tables_only, "output.checkpoint_every=1", "time.end=0.2"]
    assert runs.run(text, tmp_path / "out", changes) == 0
    others = [*changes[:-1], "time.steady=true"]
    assert runs.run(text, tmp_path / "out", others, "--resume") == 2
    assert "time.steady: got true; a steady state has no steps to go on after" in refusal(capsys)


def test_other_versions_of_libraries_are_told(flap: str, runs: Any, tmp_path: Path) -> None:
    text, folder, changes = (
        runs.scene(flap),
        tmp_path / "out",
        [*runs.tables_only, "output.checkpoint_every=1", "time.end=0.2"],
    )
    assert runs.run(text, folder, changes) == 0
    rewritten(folder / "restart.npz", versions={**runs.summary(folder)["versions"], "numpy": "0.9"})
    assert runs.run(text, folder, changes, "--resume") == 0
    (note,) = (note for note in runs.summary(folder)["notes"] if "resumed" in note)
    assert note.startswith(f"resumed after step 2, t = 0.2, with numpy {np.__version__} instead of 0.9: rounding may")
