"""``python -m hofsi``."""

import sys

from hofsi.cli import main

__all__: list[str] = []

if __name__ == "__main__":
    sys.exit(main())
