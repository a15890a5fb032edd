"""summary.json."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path

import numpy as np
import pytest

from hofsi.io.summary import machine, read_summary, versions, write_summary


def test_numbers_that_are_not_finite_become_null(tmp_path: Path) -> None:
    path = tmp_path / "summary.json"
    values = {"a": math.nan, "b": [1, math.inf, np.float64(-np.inf)], "c": {"d": np.float64(2.5), "e": np.int64(3)}}
    write_summary(path, {**values, "f": None, "g": "ü", "h": np.bool_(True)})

    def refuse(name: str) -> float:
        raise AssertionError(f"{name} is not JSON")

    data = json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)
    assert data == {"a": None, "b": [1, None, None], "c": {"d": 2.5, "e": 3}, "f": None, "g": "ü", "h": True}
    assert read_summary(path) == data


def test_the_old_summary_stays_until_the_new_one_is_complete(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "summary.json"
    write_summary(path, {"status": "running"})
    seen: list[str] = []
    replace = os.replace

    def watched(source: Path, target: Path) -> None:
        seen.append(read_summary(target)["status"])
        seen.append(read_summary(source)["status"])
        replace(source, target)

    monkeypatch.setattr(os, "replace", watched)
    write_summary(path, {"status": "completed"})
    assert seen == ["running", "completed"]
    assert read_summary(path) == {"status": "completed"}
    assert [file.name for file in tmp_path.iterdir()] == ["summary.json"]


def test_what_json_does_not_know_is_refused_and_the_old_file_kept(tmp_path: Path) -> None:
    path = tmp_path / "summary.json"
    write_summary(path, {"status": "running"})
    with pytest.raises(TypeError, match="not JSON serializable"):
        write_summary(path, {"status": object()})
    assert read_summary(path) == {"status": "running"}


def test_versions_and_machine_are_named() -> None:
    named = versions()
    assert sorted(named) == ["hoblock", "hofsi", "numpy", "python", "scipy"]
    assert named["numpy"] == np.__version__
    described = machine()
    assert described["processors"] == os.cpu_count()
    assert described["platform"]
    assert described["processor"]
