"""Messages on standard error."""

from __future__ import annotations

import sys

__all__ = ["complain"]


def complain(message: str) -> None:
    """Tell the user what went wrong."""
    print(f"hofsi: {message}", file=sys.stderr)
