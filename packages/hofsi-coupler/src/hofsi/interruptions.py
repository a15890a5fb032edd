"""Ctrl-C and SIGTERM, as exceptions that do not come where something must not be broken off."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

__all__ = ["Interruptions", "Terminated"]


class Terminated(KeyboardInterrupt):
    """The process was asked to end by SIGTERM, as batch systems do when the time is up."""


class Interruptions:
    """Raises KeyboardInterrupt for Ctrl-C and `Terminated` for SIGTERM, within a ``with`` block.

    In other threads than the main one, which alone receives signals, it does nothing; a signal that is ignored stays
    so.
    """

    def __init__(self) -> None:
        self._held = False
        self._waiting: KeyboardInterrupt | None = None
        self._before: dict[signal.Signals, Any] = {}

    def __enter__(self) -> Interruptions:
        """Take over the signals."""
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                if signal.getsignal(number) is not signal.SIG_IGN:
                    self._before[number] = signal.signal(number, self._received)
        return self

    def __exit__(self, *_: object) -> None:
        """Give them back; one that was held is forgotten."""
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before = {}

    def _received(self, number: int, frame: FrameType | None) -> None:
        interruption = Terminated() if number == signal.SIGTERM else KeyboardInterrupt()
        if self._held:
            self._waiting = self._waiting or interruption
        else:
            self._held = True  # what follows, writing what there is, is not broken off
            raise interruption

    @contextmanager
    def held(self) -> Iterator[None]:
        """Let signals wait until the block has ended."""
        self._held = True
        yield
        self._held = False
        if self._waiting is not None:
            self._held = True
            raise self._waiting

    def hold(self) -> None:
        """Let signals wait from now on."""
        self._held = True
