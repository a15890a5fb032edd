"""The Python of README.md and docs/tutorial.md runs as it stands there.

A fence that begins with ```` ```python ```` is a script of its own; ```` ```python no-run ```` is left out. All scripts
of a page run in one folder, which holds the files that the page gives under ```` ```toml NAME.toml ````.
"""

from __future__ import annotations

import json
import re
import runpy
from pathlib import Path

import pytest

from hofsi.cli import main

ROOT = Path(__file__).parent.parent
README, TUTORIAL = ROOT / "README.md", ROOT / "docs" / "tutorial.md"
FENCE = re.compile(r"^```(?P<language>\w+)(?P<words>[^\n]*)\n(?P<code>.*?)^```", re.MULTILINE | re.DOTALL)
SHORT = ["mesh.order=2", "time.end=0.2", "output.fields=false", "output.plots=false"]


def fences(page: Path, language: str) -> list[tuple[list[str], str]]:
    """The words behind the language, and the code, of each fence of a page."""
    if not page.exists():
        return []
    found = FENCE.finditer(page.read_text(encoding="utf-8"))
    return [(fence["words"].split(), fence["code"]) for fence in found if fence["language"] == language]


def scripts(page: Path) -> list[str]:
    return [code for words, code in fences(page, "python") if "no-run" not in words]


def write_files(page: Path, folder: Path) -> list[str]:
    files = [(words[0], code) for words, code in fences(page, "toml") if words]
    for name, code in files:
        (folder / name).write_text(code, encoding="utf-8")
    return [name for name, _ in files]


def run_scripts(page: Path, folder: Path) -> None:
    for number, code in enumerate(scripts(page)):
        script = folder / f"{page.stem.lower()}_{number}.py"
        script.write_text(code, encoding="utf-8")
        runpy.run_path(str(script))


def test_readme(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if not scripts(README):
        pytest.skip("README.md has no Python to run")
    monkeypatch.chdir(tmp_path)
    write_files(README, tmp_path)
    run_scripts(README, tmp_path)


def test_tutorial(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    assert write_files(TUTORIAL, tmp_path) == ["beam.toml"]
    changes = [word for change in SHORT for word in ("--set", change)]
    assert main(["run", "beam.toml", "-o", "results/beam", "--quiet", *changes]) == 0
    run_scripts(TUTORIAL, tmp_path)
    printed = capsys.readouterr().out
    assert len(scripts(TUTORIAL)) == 3
    assert "completed 10 steps" in printed
    assert "t = 0.10" in printed
    assert "[ True False False  True]" in printed


@pytest.mark.slow
def test_the_tutorial_s_scene_does_what_the_tutorial_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_files(TUTORIAL, tmp_path)
    assert main(["run", "beam.toml", "-o", "results", "--quiet", "--set", "output.plots=false"]) == 0
    tip = json.loads(Path("results/summary.json").read_text(encoding="utf-8"))["quantities"]["tip"]
    assert tip["mean"] == pytest.approx(0.030, abs=0.001)
    assert tip["amplitude"] == pytest.approx(0.103, abs=0.001)
    assert tip["frequency"] == pytest.approx(1.10, abs=0.01)
