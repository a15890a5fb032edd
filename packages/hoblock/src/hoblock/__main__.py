"""``python -m hoblock`` is the command ``hoblock``."""

from __future__ import annotations

from hoblock.cli import main

if __name__ == "__main__":
    raise SystemExit(main())
