"""How a fit stands while it goes on."""

import math
import time
from collections.abc import Callable


class Standing:
    """Tells how many simulations were made, what is best so far, and how long the rest may take."""

    def __init__(
        self,
        budget: int | None,
        more: Callable[[str], None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Nothing is simulated yet.

        Args:
            budget: simulations that it may make; None if it ends by itself.
            more: told how it stands.
            clock: [s].
        """
        self._budget, self._more, self._clock = budget, more, clock
        self._first: tuple[float, int] | None = None

    def told(self, done: int, best: float) -> None:
        """So many simulations are done.

        Args:
            done: of simulations; what an earlier run kept is among the first ones that are told.
            best: least so far, over the noise for least squares, else of what the search makes small.
        """
        now = self._clock()
        if self._first is None:
            self._first = (now, done)
        begun, kept = self._first
        least = f"{best:.4g} times the noise" if self._budget is None else f"{best:.4g}"
        if self._budget is None:
            of, left = "", "; it ends where two starts agree or the noise is reached"
        else:
            of, left = f" of at most {self._budget}", ""
            if done > kept:
                seconds = (now - begun) / (done - kept) * max(self._budget - done, 0)
                left = f"; at most about {math.ceil(seconds)} s more"
        self._more(f"{done} simulations{of}, best so far {least}{left}")
