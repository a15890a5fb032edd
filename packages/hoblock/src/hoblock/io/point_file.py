"""Points in text files: two columns, as spreadsheets and airfoil tables have them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from hoblock.errors import SceneError

__all__ = ["read_points"]

_LARGEST = 10_000_000


def read_points(path: Path, place: str) -> tuple[tuple[float, float], ...]:
    """Read the points of a curve from a text file.

    Parameters
    ----------
    path : Path
        Two numbers a line, separated by commas, semicolons or blanks; empty lines, ``#`` comments and lines of
        headings are skipped.
    place : str
        Where the scene names the file, for messages.

    Raises
    ------
    SceneError
        If the file cannot be read, a line does not hold two finite numbers, or there is none that does.
    """
    try:
        if path.stat().st_size > _LARGEST:
            raise SceneError(f"the file {path} has more than {_LARGEST // 10**6} MB; expected a list of points", place)
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise SceneError(f"the file {path} cannot be read: {error.strerror or error}", place) from error
    except UnicodeDecodeError as error:
        raise SceneError(f"the file {path} is not a text file; expected two numbers a line", place) from error
    points: list[tuple[float, float]] = []
    for number, line in enumerate(lines, start=1):
        text = line.split("#", 1)[0].strip()
        if not text:
            continue
        words = re.split(r"\s*[,;]\s*|\s+", text)
        try:
            x, y = (float(word) for word in words)
        except ValueError:
            if not points and not re.match(r"[-+.0-9]", text):
                continue  # headings
            raise SceneError(f"{path}, line {number}: got {line.strip()!r}; expected two numbers", place) from None
        if not np.isfinite([x, y]).all():
            raise SceneError(f"{path}, line {number}: got {line.strip()!r}; expected finite numbers", place)
        points.append((x, y))
    if not points:
        raise SceneError(f"the file {path} holds no points; expected two numbers a line", place)
    return tuple(points)
