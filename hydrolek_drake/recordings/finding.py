"""What is noteworthy about a recording without being a reason to refuse it."""

from dataclasses import dataclass
from typing import Literal

FindingKind = Literal["gap", "nan", "clock", "saturated", "constant", "duplicate", "offset", "resampled"]


@dataclass(frozen=True)
class Finding:
    """One observation about a recording, in words and in time.

    Attributes:
        kind: What was found.
        signal: Key of the signal it concerns, or None if it concerns the clock.
        message: One plain sentence.
        spans: Start and end of each stretch it concerns [s]; start equals end for a single sample.
    """

    kind: FindingKind
    signal: str | None
    message: str
    spans: tuple[tuple[float, float], ...]

    def within(self, start: float, end: float) -> "Finding | None":
        """The finding cut to a time window [s], or None if it lies outside."""
        spans = tuple((max(a, start), min(b, end)) for a, b in self.spans if a <= end and b >= start)
        return Finding(self.kind, self.signal, self.message, spans) if spans else None
