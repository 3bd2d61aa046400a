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
def ended_after(seconds: float | None) -> Iterator[TimeLimit]:
    """Interrupt the main thread after so many seconds, once; None for never.

    Only in the main thread, which alone receives signals.

    Args:
        seconds: of the wall clock, more than 0.
    """
    limit = TimeLimit()
    if seconds is None:
        yield limit
        return

    def end(number: int, frame: FrameType | None) -> None:
        limit.reached = True
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield limit
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
