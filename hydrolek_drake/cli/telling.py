"""What a long command is doing: each step is told at once, how it stands now and then, and no silence is long."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager


class Telling:
    """Tells steps, and how a step stands no more often than a reader wants to know.

    Called with a text it tells a step at once.
    """

    def __init__(
        self,
        write: Callable[[str], None],
        every_s: float,
        clock: Callable[[], float] = time.monotonic,
        first: str = "",
    ) -> None:
        """Nothing is told yet.

        Args:
            write: takes a line.
            every_s: how a step stands is told at most so often, and something at least so often [s].
            clock: [s].
            first: a step that has begun and is told only if it lasts: bad input is refused in one line.
        """
        self._write, self._every, self._clock = write, every_s, clock
        self._step, self._stands = first, ""
        self._begun = self._last = clock()
        self._lock = threading.RLock()  # fits in several threads tell how they stand

    def __call__(self, step: str) -> None:
        """Tell what is done next."""
        with self._lock:
            self._step, self._stands, self._begun = step, "", self._clock()
            self._told(step)

    def more(self, stands: str) -> None:
        """Tell how the step stands, unless something was told just before; then it is remembered."""
        with self._lock:
            self._stands = stands
            if self._clock() - self._last >= self._every:
                self._told(self._line())

    def still(self) -> None:
        """Tell how the step stands if nothing was told for long."""
        with self._lock:
            if self._step and self._clock() - self._last >= self._every:
                self._told(self._line())

    def _line(self) -> str:
        since = f"for {self._clock() - self._begun:.0f} s"
        return f"{self._step} {since}{': ' if self._stands else ''}{self._stands}"

    def _told(self, line: str) -> None:
        self._last = self._clock()
        self._write(line)


@contextmanager
def kept_alive(telling: Telling, every_s: float) -> Iterator[Telling]:
    """Let it say now and then that the step goes on, from a thread of its own.

    Args:
        telling: what is told.
        every_s: how often it is asked [s].
    """
    ended = threading.Event()

    def asked() -> None:
        while not ended.wait(every_s):
            telling.still()

    thread = threading.Thread(target=asked, daemon=True)
    thread.start()
    try:
        yield telling
    finally:
        ended.set()
        thread.join()
