"""Suggestions for misspelt names, as sentences to put at the end of an error message."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

__all__ = ["did_you_mean", "listing", "suggestion"]


def listing(names: Iterable[str]) -> str:
    """Names in quotes, separated by commas, or ``"none"``."""
    return ", ".join(repr(name) for name in names) or "none"


def suggestion(name: str, known: Iterable[str]) -> str:
    """Return ``"Did you mean 'velocity'? "`` if a known name is close to ``name``, else an empty string.

    Upper and lower case, hyphens and underscores count as equal.
    """
    folded: dict[str, str] = {}
    for candidate in known:
        folded.setdefault(_fold(candidate), candidate)
    matches = difflib.get_close_matches(_fold(name), folded, n=1)
    return f"Did you mean {folded[matches[0]]!r}? " if matches else ""


def _fold(name: str) -> str:
    return name.lower().replace("-", "_")


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return '; did you mean …?' with close matches, or the known names if there are few."""
    names = [str(k) for k in known]
    close = difflib.get_close_matches(name, names, n=3)
    if close:
        return f"; did you mean {' or '.join(repr(c) for c in close)}?"
    listed = ", ".join(names[:12]) + (", …" if len(names) > 12 else "")
    return f"; known names: {listed}."
