"""Benchmarks by name, run one after the other or side by side, and what they found as data."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from datetime import UTC, datetime
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from hoblock.errors import HoblockError
from hoblock.spelling import did_you_mean
from hofsi.bench.benchmark import Benchmark, Measured
from hofsi.bench.coupling import Coupling
from hofsi.bench.flags import FLAGS
from hofsi.bench.flows import FLOWS
from hofsi.bench.meshes import MeshGeneration
from hofsi.bench.movers import Movers
from hofsi.bench.solids import SOLIDS
from hofsi.errors import CaseError, HofsiError
from hofsi.io.summary import machine, versions

__all__ = ["BENCHMARKS", "chosen", "measurements", "protocol"]

BENCHMARKS: Mapping[str, Benchmark] = {
    benchmark.name: benchmark for benchmark in (MeshGeneration(), Movers(), *FLOWS, *SOLIDS, *FLAGS, Coupling())
}


def chosen(names: Sequence[str]) -> tuple[str, ...]:
    """Return names of benchmarks, each once, all of them if none is given.

    Raises
    ------
    CaseError
        If there is no such benchmark.
    """
    for name in names:
        if name not in BENCHMARKS:
            raise CaseError(f"there is no benchmark {name!r}{did_you_mean(name, BENCHMARKS)}", "bench")
    return tuple(dict.fromkeys(names)) or tuple(BENCHMARKS)


def measurements(names: Sequence[str], *, quick: bool = False, jobs: int = 1) -> Iterator[tuple[str, Measured]]:
    """Run benchmarks and yield each when it is done.

    Parameters
    ----------
    names : sequence of str
        Of `BENCHMARKS`.
    quick : bool, optional
        Whether smaller problems, held to wider limits, will do.
    jobs : int, optional
        How many to run side by side, each in a process of its own.
    """
    if jobs == 1 or len(names) == 1:
        for name in names:
            yield name, _measured(name, quick)
        return
    # A new interpreter for each, as on the command line: nothing that one has imported or kept serves another.
    with ProcessPoolExecutor(jobs, get_context("spawn"), max_tasks_per_child=1) as pool:
        running = {pool.submit(_measured, name, quick): name for name in names}
        for done in as_completed(running):
            yield running[done], done.result()


def _measured(name: str, quick: bool) -> Measured:
    with tempfile.TemporaryDirectory(prefix="hofsi-bench-") as folder:
        try:
            return BENCHMARKS[name].measure(Path(folder), quick=quick)
        except (HoblockError, HofsiError) as error:
            return Measured((), "nothing was computed", {}, {"total": 0.0}, failure=str(error))


def protocol(found: Mapping[str, Measured], *, quick: bool, jobs: int) -> dict[str, Any]:
    """What was measured, with when and on what, as `hofsi.io.summary.write_summary` writes it."""
    return {
        "benchmark": "hofsi bench",
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": machine(),
        "versions": versions(),
        "quick": quick,
        "jobs": jobs,
        "cases": [_case(name, measured) for name, measured in found.items()],
    }


def _case(name: str, measured: Measured) -> dict[str, Any]:
    findings = [
        {
            "quantity": finding.quantity,
            "value": finding.value,
            "reference": finding.reference,
            "uncertainty": finding.uncertainty,
            "error": finding.error,
            "from": finding.low,
            "to": finding.high,
            "passed": finding.passed,
            "source": finding.source,
        }
        for finding in measured.findings
    ]
    return {
        "name": name,
        "title": BENCHMARKS[name].title,
        "passed": measured.passed,
        "failure": measured.failure,
        "size": measured.size,
        "settings": measured.settings,
        "findings": findings,
        "seconds": measured.seconds,
        "counts": measured.counts,
    }
