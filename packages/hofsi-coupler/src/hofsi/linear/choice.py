"""Direct or iterative: a choice by size and memory, with its reason."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Literal

__all__ = ["Choice", "choose_solver", "direct_memory", "machine_memory"]

_OVERTAKEN = 1_500_000
"""Condensed unknowns from which a solution by multigrid takes less time than one by LU, preparation included.

Between 900 000 and 1 500 000 it depends on the order and the problem, see docs/linear_solvers.md.
"""

_ENTRIES = 27.0
"""Entries of the LU factors for each unknown and each doubling of their number, at most as measured."""

_COPIES = 3.0
"""Memory of a direct solution, element matrices and all, in that of its factors."""

_SHARE = 0.5
"""Part of the machine's memory that the direct solution may take."""


@dataclass(frozen=True)
class Choice:
    """A linear solver, and why it is the one.

    Attributes
    ----------
    solver : {"direct", "amg"}
    reason : str
    """

    solver: Literal["direct", "amg"]
    reason: str


def choose_solver(
    asked: Literal["auto", "direct", "amg"],
    unknowns: int,
    *,
    periodic: bool = False,
    memory: int | None = None,
    pyamg: bool | None = None,
) -> Choice:
    """Choose how systems of some size are solved.

    Parameters
    ----------
    asked : {"auto", "direct", "amg"}
    unknowns : int
        After static condensation.
    periodic : bool
        Whether there are periodic sides, for which there is no multigrid.
    memory : int, optional
        Of the machine, in bytes; by default what it says.
    pyamg : bool, optional
        Whether pyamg is there; by default whether it is installed.
    """
    if periodic and asked != "direct":
        return Choice("direct", "there is no multigrid for periodic sides")
    if asked != "auto":
        return Choice(asked, f'linear.solver = "{asked}"')
    needed = direct_memory(unknowns)
    limit = machine_memory() if memory is None else memory
    if limit and needed > _SHARE * limit:
        why = f"LU of {unknowns} condensed unknowns would need about {needed / 2**30:.1f} of {limit / 2**30:.0f} GiB"
    elif unknowns > _OVERTAKEN:
        why = f"with {unknowns} condensed unknowns, more than {_OVERTAKEN}, it is faster than LU"
    else:
        return Choice("direct", f"at this size it is faster than multigrid, and needs about {needed / 2**30:.2g} GiB")
    if not (find_spec("pyamg") is not None if pyamg is None else pyamg):
        return Choice("direct", f"{why}, but multigrid needs pyamg: pip install 'hofsi-coupler[amg]'")
    return Choice("amg", why)


def direct_memory(unknowns: int) -> float:
    """Bytes that a direct solution takes, about."""
    return 8.0 * _COPIES * _ENTRIES * unknowns * math.log2(max(2, unknowns))


def machine_memory() -> int:
    """Bytes of memory of this machine; 0 where the system does not say."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 0
