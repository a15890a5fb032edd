"""How many threads the dense linear algebra uses."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import TypeAlias

__all__ = ["one_thread"]

_ASKED = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_Limit: TypeAlias = Callable[[], AbstractContextManager[object]]


def one_thread() -> _Limit:
    """Find the BLAS libraries that are loaded, and return what holds them to one thread for a ``with`` block.

    The dense blocks of this package are small: threads that share one wait for each other longer than they work, four
    times as long on two idle cores and more on busy ones. Who sets one of the environment variables that say how many
    threads to use (``OMP_NUM_THREADS``, ``OPENBLAS_NUM_THREADS``, ...) is obeyed.

    Returns
    -------
    callable
        Called without arguments, as often as needed, it returns a context manager; that takes microseconds.
    """
    if any(os.environ.get(name) for name in _ASKED):
        return nullcontext
    from threadpoolctl import ThreadpoolController

    blas = ThreadpoolController().select(user_api="blas")
    return lambda: blas.limit(limits=1)
