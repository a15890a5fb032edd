"""Signals as exceptions, held back where something must not be broken off."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator

import pytest

from hofsi.interruptions import Interruptions, Terminated

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals to send")


@pytest.fixture(autouse=True)
def _usual_handler() -> Iterator[None]:
    """A shell that runs the tests in the background makes them ignore SIGINT."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def send(number: int) -> None:
    os.kill(os.getpid(), number)


@pytest.mark.parametrize(("number", "kind"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, Terminated)])
def test_a_signal_is_an_exception(number: int, kind: type[BaseException]) -> None:
    handlers = [signal.getsignal(number)]
    with pytest.raises(KeyboardInterrupt) as caught, Interruptions():
        send(number)
    handlers.append(signal.getsignal(number))
    assert type(caught.value) is kind
    assert handlers[0] is handlers[1]


def test_a_signal_waits_for_the_end_of_a_block() -> None:
    done = []

    def work() -> None:
        with Interruptions() as interruptions:
            with interruptions.held():
                send(signal.SIGTERM)
                done.append("inside")
            done.append("after")

    with pytest.raises(Terminated):
        work()
    assert done == ["inside"]


def test_what_follows_an_interruption_is_not_interrupted() -> None:
    done = []
    with Interruptions():
        try:
            send(signal.SIGTERM)
        except Terminated:
            send(signal.SIGINT)
            done.append("written")
    assert done == ["written"]


def test_from_some_point_on_signals_are_held() -> None:
    with Interruptions() as interruptions:
        interruptions.hold()
        send(signal.SIGTERM)


def test_a_signal_that_is_ignored_stays_so() -> None:
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with Interruptions():
            send(signal.SIGTERM)
    finally:
        signal.signal(signal.SIGTERM, before)


def test_in_another_thread_nothing_is_taken_over() -> None:
    found = []

    def look() -> None:
        with Interruptions():
            found.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=look)
    thread.start()
    thread.join()
    assert found == [signal.getsignal(signal.SIGTERM)]
