"""An end to a long run after so many seconds, as if the user had interrupted it then."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType


@dataclass
class TimeLimit:
    """Whether it was reached."""

    reached: bool = False


@contextmanager
def ended_after(seconds: float | None, *, worked: bool = False) -> Iterator[TimeLimit]:
    """Interrupt the main thread after so many seconds, once; None for never.

    Only in the main thread, which alone receives signals.

    Args:
        seconds: of the wall clock, more than 0.
        worked: seconds of the process's own time instead, of all its threads.
    """
    limit = TimeLimit()
    if seconds is None:
        yield limit
        return

    def end(number: int, frame: FrameType | None) -> None:
        limit.reached = True
        raise KeyboardInterrupt

    which, timer = (signal.SIGPROF, signal.ITIMER_PROF) if worked else (signal.SIGALRM, signal.ITIMER_REAL)
    before = signal.signal(which, end)
    signal.setitimer(timer, seconds)
    try:
        yield limit
    finally:
        signal.setitimer(timer, 0.0)
        signal.signal(which, before)
