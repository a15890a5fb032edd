"""Runs that are broken off and go on: what they are made with, and how results are compared."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from hofsi.cli import main

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


class Runs:
    """Scenes, runs of them in this and in another process, and their results."""

    tables_only = ("output.fields=false", "output.plots=false")

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def scene(self, text: str) -> str:
        """Write a scene; return its name."""
        path = self.folder / "scene.toml"
        path.write_text(text, encoding="utf-8")
        return str(path)

    @staticmethod
    def changed(text: str, *changes: tuple[str, str]) -> str:
        for old, new in changes:
            assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times"
            text = text.replace(old, new)
        return text

    @staticmethod
    def run(scene: str, folder: Path, changes: list[str], *others: str) -> int:
        return main(["run", scene, "-o", str(folder), "--quiet", "--set", *changes, *others])

    @staticmethod
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

    @staticmethod
    def rows(path: Path) -> list[dict[str, str]]:
        with path.open(encoding="utf-8", newline="") as file:
            return [{key: value for key, value in row.items() if key != "seconds"} for row in csv.DictReader(file)]

    @staticmethod
    def summary(folder: Path) -> dict[str, Any]:
        data: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        return data

    @staticmethod
    def assert_same(one: Path, other: Path) -> None:
        """Two folders hold the same, to the byte, but for seconds and restart files."""
        names = [
            sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
            for folder in (one, other)
        ]
        assert names[0] == names[1]
        for name in names[0]:
            if name == "steps.csv":
                assert Runs.rows(one / name) == Runs.rows(other / name)
            elif name == "summary.json":
                first, second = Runs.summary(one), Runs.summary(other)
                assert first.pop("seconds").keys() == second.pop("seconds").keys()
                assert first == second
            elif name != "restart.npz":
                assert (one / name).read_bytes() == (other / name).read_bytes(), name

    @staticmethod
    def newton(channel: str) -> str:
        """The channel with a flow that grows, solved by Newton's method with factors of earlier steps."""
        text = Runs.changed(channel, ('"4*y*(1 - y)"', '"4*y*(1 - y)*(1 + t)"'), ("steps = 5", "steps = 8"))
        text = Runs.changed(text, ("viscosity = 0.1", 'viscosity = 0.1\nconvection = "newton"'))
        return text + '\n[quantities.energy]\ntype = "kinetic-energy"\n'

    @staticmethod
    def swinging(solid_alone: str, scheme: str) -> str:
        """The flap alone, in motion, advanced by a scheme."""
        alone = re.sub(r"^(a\d|d\d|b2|c2) = .*\n", "", solid_alone, flags=re.MULTILINE)
        moving = 'youngs_modulus = 1e3\ninitial_velocity = ["y", "0"]'
        text = Runs.changed(alone, ("youngs_modulus = 1e3", moving), ("end = 2.0", f'end = 0.8\nsolid = "{scheme}"'))
        return text + '\n[quantities.u_x]\ntype = "probe"\nfield = "displacement"\ncomponent = "x"\nat = "b1"\n'

    def interrupted_and_resumed(self, scene: str, changes: list[str], step: int, name: str) -> None:
        """Run as a whole, and in two parts with a signal in some step: nobody sees a difference."""
        whole, parts = self.folder / "whole", self.folder / "parts"
        assert self.run(scene, whole, changes) == 0
        done = self.killed(step, name, scene, parts, changes)
        assert done.returncode == -getattr(signal, name), done.stderr
        assert len(self.rows(parts / "quantities.csv")) == step - 1
        assert self.summary(parts)["status"] == "running"
        assert self.run(scene, parts, changes, "--resume") == 0
        self.assert_same(whole, parts)


@pytest.fixture
def runs(tmp_path: Path) -> Runs:
    return Runs(tmp_path)
