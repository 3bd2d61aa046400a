"""How long what is left of many like jobs may take."""

import time
from collections.abc import Callable

MINUTE_S = 60.0


class Remaining:
    """By the mean of the jobs that have ended.

    Args:
        whole: how many jobs there are.
        clock: seconds that pass.
    """

    def __init__(self, whole: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._left, self._ended, self._clock = whole, 0, clock
        self._begun = clock()

    def one_ended(self, *, at_once: bool = False) -> None:
        """Count a job that has ended.

        Args:
            at_once: it was done before, or could not be begun: it says nothing of the others.
        """
        self._left -= 1
        if not at_once:
            self._ended += 1

    def seconds(self) -> float | None:
        """How long the rest may take [s]; None as long as no job has ended."""
        return (self._clock() - self._begun) / self._ended * self._left if self._ended else None

    def words(self) -> str:
        """The same for a reader, with a comma before it; empty where nothing is known."""
        left = self.seconds()
        if left is None or self._left <= 0:
            return ""
        if left < MINUTE_S:
            return f", about {left:.0f} s left"
        minutes = round(left / MINUTE_S)
        return f", about {minutes} min left" if minutes < 120 else f", about {minutes / 60:.1f} h left"
