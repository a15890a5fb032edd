"""What becomes of memory that is freed."""

from __future__ import annotations

import ctypes
import platform

__all__ = ["keep_freed_memory"]

_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # of mallopt, malloc.h
_KEPT = 1 << 30  # bytes free at the top of the heap that are kept
_LARGE = 1 << 28  # bytes of an array that gets pages of its own


def keep_freed_memory() -> bool:
    """Let the C library keep what is freed for the next array instead of giving it back to the system.

    Element matrices of high order are made anew in every iteration. Arrays above 32 MiB otherwise get fresh pages each
    time, which the system clears first: a quarter of the time of a steady flow of order 10 on 192 elements. At most
    1 GiB is kept; arrays above 256 MiB are given back all the same.

    The setting is one of the whole process; `hofsi.run`, and with it the command line, makes it.

    Returns
    -------
    bool
        Whether it was made; only glibc has it.
    """
    if platform.libc_ver()[0] != "glibc":
        return False
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    return mallopt is not None and all([mallopt(_MMAP_THRESHOLD, _LARGE) == 1, mallopt(_TRIM_THRESHOLD, _KEPT) == 1])
