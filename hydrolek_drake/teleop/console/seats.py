"""Who is in control of the console: rules without a web server."""

import time
from collections.abc import Callable
from typing import Generic, Protocol, TypeVar


class Seated(Protocol):
    """A browser, as the rules see it.

    Attributes:
        trusted: Whether it has shown the token.
    """

    trusted: bool


B = TypeVar("B", bound=Seated)


class Seats(Generic[B]):
    """The first browser with the token is in control; the others watch. Not for several threads.

    A page answers the states that it is sent. One that is in control and answers none for `mute` seconds has lost
    control, and the next one with the token has it; the mute one is back in the line once it answers again.

    Args:
        mute: Seconds.
        on_loss: Called when control is lost, however that comes.
        clock: Seconds that never run backwards.
    """

    def __init__(
        self, mute: float, on_loss: Callable[[], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._mute, self._on_loss, self._clock = mute, on_loss, clock
        self.browsers: list[B] = []
        self._asked: dict[B, float] = {}  # since when an answer is waited for
        self._silent: set[B] = set()
        self._holder: B | None = None

    def enter(self, browser: B) -> None:
        """A browser has connected."""
        self.browsers.append(browser)

    def leave(self, browser: B) -> None:
        """A browser has gone."""
        if browser not in self.browsers:
            return
        self.browsers.remove(browser)
        self._asked.pop(browser, None)
        self._silent.discard(browser)
        if self._holder is browser:
            self._lose()

    def asked(self, browser: B) -> None:
        """A state is sent to it, which a living page answers."""
        self._asked.setdefault(browser, self._clock())

    def heard(self, browser: B) -> None:
        """It has said something."""
        self._asked.pop(browser, None)
        self._silent.discard(browser)

    def holder(self) -> B | None:
        """Who is in control now."""
        holder = self._holder
        if holder is not None and self._clock() - self._asked.get(holder, self._clock()) > self._mute:
            self._silent.add(holder)
            self._lose()
        if self._holder is None:
            waiting = (each for each in self.browsers if each.trusted and each not in self._silent)
            self._holder = next(waiting, None)
        return self._holder

    def _lose(self) -> None:
        self._holder = None
        self._on_loss()
