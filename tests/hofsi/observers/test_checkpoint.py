"""Restart files that are written while a run goes on."""

from __future__ import annotations

import itertools
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from hofsi.build import Problem, build
from hofsi.io.restart_file import read_restart
from hofsi.io.scene import read_case
from hofsi.observers.checkpoint import CheckpointWriter
from hofsi.records import State, StepRecord
from hofsi.simulate import simulate


@pytest.fixture
def problem(channel: str) -> Problem:
    return build(read_case(tomllib.loads(channel), "channel.toml"))


def written(path: Path, problem: Problem) -> int | None:
    """The step whose file there is."""
    return read_restart(path).content(problem)[0].step if path.exists() else None


@pytest.mark.parametrize(("every", "steps"), [(None, [None] * 5), (1, [1, 2, 3, 4, 5]), (2, [None, 2, 2, 4, 4])])
def test_a_file_is_written_every_so_many_steps(
    problem: Problem, tmp_path: Path, every: int | None, steps: list[int | None]
) -> None:
    writer = CheckpointWriter(problem, tmp_path, every, dict)
    found = []
    for record in simulate(problem):
        writer.observe(record)
        found.append(written(writer.path, problem))
    assert found == steps
    assert writer.write()
    assert written(writer.path, problem) == 5


def test_parts_of_steps_do_not_count(channel: str, tmp_path: Path) -> None:
    text = channel.replace("steps = 5", "steps = 5\nfirst = 0.025")
    problem = build(read_case(tomllib.loads(text), "channel.toml"))
    writer = CheckpointWriter(problem, tmp_path, 1, dict)
    found = []
    for record in itertools.islice(simulate(problem), 4):
        writer.observe(record)
        found.append((record.done, written(writer.path, problem)))
    assert found == [(0.25, None), (0.5, None), (1.0, 3), (2.0, 4)]


def test_a_file_is_written_once_a_step(problem: Problem, tmp_path: Path) -> None:
    asked = []

    def gather() -> dict[str, object]:
        asked.append(1)
        return {}

    writer = CheckpointWriter(problem, tmp_path, None, gather)
    steps: Iterator[StepRecord] = simulate(problem)
    writer.observe(next(steps))
    assert [writer.write(), writer.write(), len(asked)] == [True, True, 1]
    writer.observe(next(steps))
    assert [writer.write(), len(asked)] == [True, 2]


def test_without_a_step_to_go_on_after_there_is_no_file(problem: Problem, tmp_path: Path) -> None:
    writer = CheckpointWriter(problem, tmp_path, 1, dict)
    assert not writer.write()
    writer.observe(StepRecord(1, 0.0, 0.0, State()))  # a steady state
    assert not writer.write()
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_run_left_of_a_file_is_removed(problem: Problem, tmp_path: Path) -> None:
    (tmp_path / "restart.npz.part").write_bytes(b"half")
    CheckpointWriter(problem, tmp_path, None, dict)
    assert list(tmp_path.iterdir()) == []
