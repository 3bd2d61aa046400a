"""Messages put in the order of their own time: late ones in their place, doubled ones dropped, gaps and jumps told.

A message is expected within `GAP` sample intervals behind the newest one and `REORDERED` before it. What lies elsewhere
is held until `AGREED` messages in a row agree with it: the sender's clock then stands there, after a gap or a jump. One
that stays alone was astray. Memory holds the messages of the window alone.
"""

import heapq
import math
from collections import deque
from dataclasses import dataclass, fields

import numpy as np

from hydrolek_drake.watching.live.settings import AGREED, GAP, REORDERED

_LOST = 1.5
"""An interval of so many usual ones and more has lost something."""


@dataclass(frozen=True)
class Row:
    """One sample in its place.

    Attributes:
        time: [s].
        values: `samples.COLUMNS` of each joint. # (joints, 4)
    """

    time: float
    values: np.ndarray


@dataclass(frozen=True)
class Break:
    """The time does not go on.

    Attributes:
        kind: "gap", "clock back", "clock ahead" or "new recording".
        at: last time before it [s].
        to: first time behind it [s].
    """

    kind: str
    at: float
    to: float

    @property
    def text(self) -> str:
        """In words."""
        by = self.to - self.at
        return {
            "gap": f"gap of {by:.3g} s",
            "clock back": f"clock jumped back by {-by:.3g} s",
            "clock ahead": f"clock jumped ahead by {by:.3g} s",
        }.get(self.kind, self.kind)


@dataclass
class Counts:
    """What became of the messages.

    Attributes:
        taken: put in their place.
        late: of these, behind one with a later time.
        lost: that never came, by the usual interval.
        doubled: dropped, since they had come before.
        too_late: dropped, since the observer had passed their time.
        astray: dropped, since no other message agreed with their time.
        no_time: dropped, since their time is no number.
    """

    taken: int = 0
    late: int = 0
    lost: int = 0
    doubled: int = 0
    too_late: int = 0
    astray: int = 0
    no_time: int = 0

    def as_dict(self) -> dict[str, int]:
        """Name -> count."""
        return {each.name: getattr(self, each.name) for each in fields(self)}


class Merger:
    """Puts messages in order, see the module.

    Attributes:
        counts: what became of the messages.
    """

    def __init__(self, interval: float) -> None:
        """Prepare.

        Args:
            interval: usual one between samples [s].
        """
        self._interval = interval
        self._window, self._gap = REORDERED * interval, GAP * interval
        self.counts = Counts()
        self._pending: list[tuple[float, int]] = []
        self._rows: dict[float, np.ndarray] = {}
        self._recent: deque[float] = deque(maxlen=4 * REORDERED)
        self._newest: float | None = None
        self._last: float | None = None
        self._arrived: float | None = None
        self._held: list[tuple[float, np.ndarray, float | None]] = []
        self._number = 0
        self._began = False

    def push(self, time: float, values: np.ndarray, arrival: float | None = None) -> list[Row | Break]:
        """Take a message; rows that are in their place by now, and breaks before them.

        Args:
            time: by the sender's clock [s].
            values: `samples.COLUMNS`, # (joints, 4)
            arrival: by this machine's clock [s], by which a gap is told from a jump; None where a message does not come
                when it was made, as from a file: every leap ahead is a gap then.
        """
        if not math.isfinite(time):
            self.counts.no_time += 1
            return []
        if self._newest is None:
            return self._take(time, values, arrival)
        if -self._window <= time - self._newest <= self._gap:
            self._counted_astray()
            return self._take(time, values, arrival)
        if time in self._recent:
            self.counts.doubled += 1
            return []
        if self._held and not -self._window <= time - self._held[-1][0] <= self._gap:
            self._counted_astray()
        self._held.append((time, values, arrival))
        return self._moved() if len(self._held) >= AGREED else []

    def begin(self) -> list[Row | Break]:
        """A new recording begins: what comes next need not go on from here."""
        done = self.flush()
        self._counted_astray()
        self._began = self._last is not None
        self._newest, self._arrived = None, None
        self._recent.clear()
        return done

    def flush(self) -> list[Row | Break]:
        """All rows that still wait for late ones before them; for a link that has gone silent."""
        return self._released(math.inf)

    def _take(self, time: float, values: np.ndarray, arrival: float | None) -> list[Row | Break]:
        if time in self._rows:
            self._fill(time, values)
            return []
        if self._began:
            self._began = False
            broken: list[Row | Break] = [Break("new recording", self._last or 0.0, time)]
            self._last = None
        else:
            broken = []
        if self._last is not None and time <= self._last:
            if time in self._recent:
                self.counts.doubled += 1
            else:
                self.counts.too_late += 1
            return broken
        self.counts.taken += 1
        self.counts.late += self._newest is not None and time < self._newest
        if self._newest is None or time > self._newest:
            self._newest, self._arrived = time, arrival
        self._rows[time] = values
        self._number += 1
        heapq.heappush(self._pending, (time, self._number))
        return [*broken, *self._released(self._newest - self._window)]

    def _fill(self, time: float, values: np.ndarray) -> None:
        """A second message of one time: what it has besides is taken, else it is doubled."""
        there = self._rows[time]
        adds = np.isnan(there) & ~np.isnan(values)
        if not adds.any():
            self.counts.doubled += 1
            return
        self._rows[time] = np.where(adds, values, there)

    def _released(self, until: float) -> list[Row | Break]:
        found: list[Row | Break] = []
        while self._pending and self._pending[0][0] <= until:
            time, _ = heapq.heappop(self._pending)
            if self._last is not None:
                step = (time - self._last) / self._interval
                self.counts.lost += round(step) - 1 if step >= _LOST else 0
            self._last = time
            self._recent.append(time)
            found.append(Row(time, self._rows.pop(time)))
        return found

    def _moved(self) -> list[Row | Break]:
        """The messages that are held agree on another time."""
        assert self._newest is not None
        held, self._held = self._held, []
        at, (to, _, arrival) = self._newest, held[0]
        kind = "gap" if to > at else "clock back"
        if to > at and arrival is not None and self._arrived is not None:
            passed = arrival - self._arrived  # half of it is allowed for messages that wait on their way
            kind = "gap" if to - at <= 2.0 * passed + self._window else "clock ahead"
        found = [*self.flush(), Break(kind, at, to)]
        self._newest, self._last, self._arrived = None, None, None
        self._recent.clear()
        for time, values, arrived in sorted(held, key=lambda each: each[0]):
            found += self._take(time, values, arrived)
        return found

    def _counted_astray(self) -> None:
        """What was held agrees with nothing."""
        for time, _, _ in self._held:
            passed = self._newest is not None and time < self._newest
            self.counts.too_late += passed
            self.counts.astray += not passed
        self._held = []
