"""``hofsi bench`` on the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hofsi.cli import main


def test_names_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "--list", "csm1", "fsi3"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == ["csm1", "fsi3"]


def test_a_case_is_run_and_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "new" / "found.json"
    path.parent.mkdir()
    assert main(["bench", "csm1", "--quick", "--json", str(path)]) == 0
    output = capsys.readouterr()
    assert output.err == ""
    assert "u_y last" in output.out
    assert output.out.endswith("1 of 1 benchmarks passed\n")
    data = json.loads(path.read_text(encoding="utf-8"))
    assert data["quick"] is True
    assert [case["name"] for case in data["cases"]] == ["csm1"]


def test_a_number_that_is_not_near_enough_is_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from dataclasses import replace

    from hofsi.bench import referee

    strict = replace(referee.BENCHMARKS["csm1"], changes=("mesh.order=2",))
    monkeypatch.setattr(referee, "BENCHMARKS", {"csm1": strict})
    monkeypatch.setattr("hofsi.bench.BENCHMARKS", {"csm1": strict})
    assert main(["bench", "csm1"]) == 1
    output = capsys.readouterr()
    assert "FAIL" in output.out
    assert output.err == "hofsi: not near enough, or not to the end: csm1.\n"


def test_an_unknown_name_is_bad_input(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "fsi9"]) == 2
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err.startswith("hofsi: bench: there is no benchmark 'fsi9'; did you mean")


@pytest.mark.parametrize("jobs", ["0", "-1", "two"])
def test_jobs_are_counted(jobs: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["bench", "--jobs", jobs])
    assert stop.value.code == 2
    assert f"got {jobs!r}; must be a positive integer" in capsys.readouterr().err


def test_a_file_that_cannot_be_written_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "csm1", "--quick", "--json", str(tmp_path / "missing" / "found.json")]) == 2
    assert "No such file or directory" in capsys.readouterr().err
