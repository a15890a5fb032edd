"""A line that tells how a run is getting on."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any, TextIO

from hofsi.records import StepRecord

__all__ = ["Progress"]

_SMOOTHING = 0.1  # weight of the newest step in the mean duration of a step
_TTY_INTERVAL = 0.1  # seconds between two states of the line on a terminal


class Progress:
    """Tells step, t, dt, coupling iterations, residual, min det J and the time left.

    On a terminal one line is renewed; elsewhere a line is written every few seconds and for the last step.

    Parameters
    ----------
    stream : text file
        Usually the standard error output.
    steps : int or None
        How many of the scene's ``dt`` there will be; None for a steady problem.
    interval : float
        Seconds between lines where the stream is no terminal.
    clock : callable
        Seconds.
    """

    def __init__(
        self, stream: TextIO, steps: int | None, interval: float = 5.0, clock: Callable[[], float] = perf_counter
    ) -> None:
        self._stream, self._steps, self._clock = stream, steps, clock
        self._terminal = stream.isatty()
        self._interval = _TTY_INTERVAL if self._terminal else interval
        self._last_step = clock()
        self._last_line = -float("inf")
        self._duration: float | None = None  # of a step of the scene's dt
        self._done = 0.0
        self._pending = ""
        self._shown = False

    def observe(self, record: StepRecord) -> None:
        """Note a step, and show it if it is time to."""
        now = self._clock()
        part, self._done = record.done - self._done, record.done
        took, self._last_step = (now - self._last_step) / (part or 1.0), now
        if self._duration is None:
            self._duration = took
        else:  # a plain mean at first, then one that forgets
            weight = min(1.0, part) * max(_SMOOTHING, 1.0 / max(record.done, 1.0))
            self._duration += weight * (took - self._duration)
        self._pending = self._line(record)
        if now - self._last_line >= self._interval:
            self._show(now)

    def say(self, text: str) -> None:
        """Write a line of its own."""
        if self._terminal and self._shown:
            text = "\r" + text.ljust(shutil.get_terminal_size().columns - 1)
        self._stream.write(f"{text}\n")
        self._stream.flush()

    def close(self) -> None:
        """Show the last step and end the line."""
        if self._pending:
            self._show(self._clock())
        if self._terminal and self._shown:
            self._stream.write("\n")
            self._stream.flush()

    def memory(self) -> dict[str, Any]:
        """Nothing: times are taken anew."""
        return {}

    def recall(self, memory: Mapping[str, Any], record: StepRecord) -> None:
        """Count from the steps that are behind."""
        self._done = record.done

    def _show(self, now: float) -> None:
        if self._terminal:
            width = shutil.get_terminal_size().columns - 1
            self._stream.write(f"\r{self._pending[:width].ljust(width)}")
        else:
            self._stream.write(f"{self._pending}\n")
        self._stream.flush()
        self._pending, self._last_line, self._shown = "", now, True

    def _line(self, record: StepRecord) -> str:
        if record.dt > 0.0:
            of = "" if self._steps is None else f"/{self._steps}"
            parts = [f"step {_count(record.done)}{of}", f"t {record.time:.6g}", f"dt {record.dt:.3g}"]
        else:
            parts = ["steady state"]
        if record.coupling is not None:
            residual = max(record.coupling.displacement, record.coupling.force)
            parts += [f"{record.coupling.iterations} iterations", f"residual {residual:.1e}"]
        if record.min_det_J is not None:
            parts.append(f"min det J {record.min_det_J:.2e}")
        if record.state.mesh is not None and record.state.mesh.snapped:
            parts.append(f"mesh jumped? (vertices move {record.state.mesh.amplification:.2g} times as far as the body)")
        if record.dt > 0.0 and self._steps is not None and self._duration is not None:
            parts.append(f"{_span(self._duration * max(self._steps - record.done, 0.0))} left")
        return "  ".join(parts)


def _count(steps: float) -> str:
    """A number of steps: "12", or "12.38" within a divided one."""
    return f"{steps:.0f}" if steps == round(steps) else f"{steps:.2f}"


def _span(seconds: float) -> str:
    """A duration in words: "42 s", "3 min 05 s", "2 h 10 min"."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    if minutes < 60:
        return f"{minutes} min {rest:02d} s"
    return f"{minutes // 60} h {minutes % 60:02d} min"
