"""``summary.json``: what a run was, how it went and what came out."""

from __future__ import annotations

import json
import math
import os
import platform
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

import hoblock
from hofsi.version import __version__

__all__ = ["machine", "read_summary", "versions", "write_summary"]


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
