"""The command ``hofsi``: simulate, check and benchmark, one file a command."""

from hofsi.cli.main import main

__all__ = ["main"]
