"""``summary.json``: what a run was, how it went and what came out."""

from __future__ import annotations

import json
import math
import os
import platform
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import hoblock
from hofsi.version import __version__

if TYPE_CHECKING:
    from hofsi.build import Problem
    from hofsi.clock import Clock

__all__ = ["count_summary", "machine", "phase_seconds", "read_summary", "versions", "write_summary"]


def write_summary(path: str | os.PathLike[str], summary: Mapping[str, Any]) -> None:
    """Write a summary in one go: a reader sees the old file or the new one, never a part.

    Parameters
    ----------
    path : path-like
    summary : mapping
        Of texts, numbers, NumPy scalars, None, lists and mappings; numbers that are not finite become null.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    target = Path(path)
    text = json.dumps(_plain(summary), indent=2, allow_nan=False, ensure_ascii=False)
    part = target.with_name(f".{target.name}.part")
    part.write_text(f"{text}\n", encoding="utf-8")
    os.replace(part, target)


def read_summary(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Read a summary.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    data: dict[str, Any] = json.loads(Path(path).read_text(encoding="utf-8"))
    return data


def versions() -> dict[str, str]:
    """Versions of Python, NumPy, SciPy and the two packages."""
    from importlib import metadata  # slow to import

    return {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": metadata.version("scipy"),
        "hoblock": hoblock.__version__,
        "hofsi": __version__,
    }


def phase_seconds(clock: Clock, total: float) -> dict[str, float]:
    """Seconds in all, by phase, and what is left."""
    phases = dict(clock.seconds)
    phases["other"] = max(0.0, total - sum(phases.values()))
    return {name: round(seconds, 4) for name, seconds in {"total": total, **phases}.items()}


def count_summary(problem: Problem, sums: Mapping[str, int]) -> dict[str, Any]:
    """What the solvers of a problem did, in all and by field, and how large the fields are.

    Parameters
    ----------
    problem : Problem
    sums : mapping of str to int
        What was summed over the steps.
    """
    counts: dict[str, Any] = {
        "steps": sums["steps"],
        "coupling_iterations": sums["coupling_iterations"],
        "assemblies": sum(count.assemblies for count in problem.counts.values()),
        "factorisations": sum(count.factorisations for count in problem.counts.values()),
        "blocks_regenerated": sums["blocks_regenerated"],
        "mesh_jumps": sums["mesh_jumps"],
    }
    if problem.fluid is not None:
        fluid = problem.fluid
        size = {"elements": len(fluid.mesh.cells), "unknowns": fluid.solver.space.size}
        moving = {} if fluid.motion is None else {f"moving_{name}": n for name, n in fluid.motion.moving.items()}
        counts["fluid"] = {**size, **moving, **asdict(fluid.solver.counts)}
    if problem.solid is not None:
        solid = problem.solid
        size = {"elements": len(solid.mesh.cells), "unknowns": 2 * len(solid.mesh.points)}
        counts["solid"] = {**size, **asdict(solid.solver.counts)}
    return counts


def machine() -> dict[str, str | int | None]:
    """The computer: platform, number of processors, name of the processor."""
    return {"platform": platform.platform(), "processors": os.cpu_count(), "processor": _processor()}


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(member) for key, member in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(member) for member in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
