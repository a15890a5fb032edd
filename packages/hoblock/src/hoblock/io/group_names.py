"""Names of groups and data as files can hold them."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable

from hoblock.errors import MeshFileError

__all__ = ["check_names"]

_CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff\ufffe\uffff]")


def check_names(
    path: str | os.PathLike[str], names: Iterable[str], *, quotes: bool = True, most_bytes: int = 1000
) -> None:
    """Refuse names that a file would mangle.

    Parameters
    ----------
    path : path-like
        For messages.
    names : iterable of str
    quotes : bool, optional
        Whether double quotes may occur.
    most_bytes : int, optional
        In UTF-8.

    Raises
    ------
    MeshFileError
        If a name is empty or too long, or has line breaks or other control characters.
    """
    for name in names:
        bad = not name or _CONTROL.search(name) or ('"' in name and not quotes)
        if bad or len(name.encode()) > most_bytes:
            without = "control characters" if quotes else "control characters and double quotes"
            raise MeshFileError(
                f"{path}: the name {name[:200]!r} cannot be written; expected 1 to {most_bytes} bytes without "
                f"{without}. Rename the group."
            )
