"""The command ``hoblock``: check, mesh, convert and draw, one file a command."""

from hoblock.cli.main import main

__all__ = ["main"]
