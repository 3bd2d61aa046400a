"""Where samples come from: what all sources have in common."""

from dataclasses import dataclass
from typing import Protocol

from hydrolek_drake.watching.live.samples import Samples


@dataclass(frozen=True)
class Link:
    """How a source does.

    Attributes:
        name: of the source.
        state: "waiting" (nothing has come yet), "open" or "lost".
        text: more about it.
        bad: lines or files that could not be read.
        dropped: samples that were dropped since the observer is too slow.
        timely: whether samples come when they are made, so that the time of their arrival tells gaps from jumps.
    """

    name: str
    state: str
    text: str = ""
    bad: int = 0
    dropped: int = 0
    timely: bool = False


class Source(Protocol):
    """Something that brings samples."""

    def read(self) -> list[tuple[Samples, float | None]]:
        """What is new since the last call, each with when it came [s]; None where it came when nobody knows.

        Raises:
            InputError: what comes is no stream of samples, and will not become one.
        """

    def link(self) -> Link:
        """How it does."""

    def close(self) -> None:
        """End it."""
