"""All benchmarks: which there are, how they are run, and what is written down of them."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from hofsi.bench import referee
from hofsi.bench.benchmark import Measured
from hofsi.bench.checks import Limit
from hofsi.bench.referee import BENCHMARKS, chosen, measurements, protocol
from hofsi.bench.text import lines_of
from hofsi.errors import CaseError, NewtonError
from hofsi.io.summary import write_summary


@dataclass
class Fake:
    """A benchmark that finds a number."""

    name: str
    value: float | None = 1.0
    error: Exception | None = None
    title: str = "a number"
    asked: list[bool] = field(default_factory=list)

    def measure(self, folder: Path, *, quick: bool) -> Measured:
        assert folder.is_dir()
        assert not [*folder.iterdir()]
        self.asked.append(quick)
        if self.error is not None:
            raise self.error
        finding = Limit("number", "small", at_most=2.0).judge(self.value)
        return Measured((finding,), "1 number", {}, {"total": 2.0, "solid": 1.5, "other": 0.001})


@pytest.fixture
def fakes(monkeypatch: pytest.MonkeyPatch) -> dict[str, Fake]:
    cases = {
        "good": Fake("good"),
        "bad": Fake("bad", 3.0),
        "failing": Fake("failing", error=NewtonError("no way", "Newton's method", "t = 0")),
    }
    monkeypatch.setattr(referee, "BENCHMARKS", cases)
    return cases


def test_there_is_a_benchmark_for_every_published_case() -> None:
    published = {"dfg-2d-1", "wall-ramm", *(f"{kind}{k}" for kind in ("cfd", "csm", "fsi") for k in (1, 2, 3))}
    assert published | {"mesh-generation", "movers", "coupling"} == set(BENCHMARKS)
    assert all(name == benchmark.name for name, benchmark in BENCHMARKS.items())


def test_names_are_checked_before_anything_runs() -> None:
    assert chosen([]) == tuple(BENCHMARKS)
    assert chosen(["fsi1", "csm1", "fsi1"]) == ("fsi1", "csm1")
    with pytest.raises(CaseError, match=r"there is no benchmark 'fsi4'; did you mean .*'fsi"):
        chosen(["csm1", "fsi4"])


def test_one_that_fails_does_not_stop_the_others(fakes: dict[str, Fake]) -> None:
    found = dict(measurements(["failing", "bad", "good"], quick=True))
    assert [found[name].passed for name in ("failing", "bad", "good")] == [False, False, True]
    assert "no way" in found["failing"].failure
    assert all(fake.asked == [True] for fake in fakes.values())


def test_everything_is_written_down(fakes: dict[str, Fake], tmp_path: Path) -> None:
    found = dict(measurements(["good", "bad"]))
    path = tmp_path / "found.json"
    write_summary(path, protocol(found, quick=False, jobs=1))
    data = json.loads(path.read_text(encoding="utf-8"))
    assert {"benchmark", "date", "machine", "versions", "quick", "jobs", "cases"} == data.keys()
    good, bad = data["cases"]
    assert (good["name"], good["passed"], bad["passed"]) == ("good", True, False)
    (finding,) = bad["findings"]
    assert (finding["quantity"], finding["value"], finding["to"], finding["from"]) == ("number", 3.0, 2.0, None)


def test_what_is_found_is_shown(fakes: dict[str, Fake]) -> None:
    (_, bad), (_, failing) = measurements(["bad", "failing"])
    lines = [*lines_of(fakes["bad"], bad)]
    assert lines[0] == "bad: a number"
    assert lines[-2].split() == ["number", "3", "–", "–", "at", "most", "2", "FAIL"]
    assert lines[-1] == "  seconds: 2.00 (solid 1.50)"
    assert any("did not come to its end: " in line and "no way" in line for line in lines_of(fakes["failing"], failing))


@pytest.mark.parametrize("name", ["mesh-generation", "movers"])
def test_benchmarks_without_a_scene_of_their_own(name: str, tmp_path: Path) -> None:
    measured = BENCHMARKS[name].measure(tmp_path, quick=True)
    assert not measured.failure
    timed = [finding for finding in measured.findings if "copy" in finding.quantity]
    assert all(finding.passed for finding in measured.findings if finding not in timed)
    assert measured.seconds["total"] > 0.0


def test_benchmarks_side_by_side_find_the_same() -> None:
    names = ["csm1", "csm2"]
    alone = dict(measurements(names, quick=True))
    beside = dict(measurements(names, quick=True, jobs=2))
    for name in names:
        assert [finding.value for finding in beside[name].findings] == [f.value for f in alone[name].findings]
        assert beside[name].passed
