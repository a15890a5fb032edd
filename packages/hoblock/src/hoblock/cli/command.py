"""What a subcommand of the command line is."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["Command", "UsageError"]


@dataclass(frozen=True)
class Command:
    """A subcommand.

    Attributes
    ----------
    name : str
    summary : str
        One line for the list of commands.
    add_arguments : function
        Given the subcommand's parser.
    run : function
        Given the parsed arguments; prints to standard output and raises a `HoblockError` for a user's mistake.
    """

    name: str
    summary: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], None]


class UsageError(Exception):
    """Options that do not go together, or a value that none allows."""
