"""What windows have said so far, judged by the rule of `hydrolek watch`; of a stated length, and the alarm for good."""

from collections import deque
from collections.abc import Sequence
from pathlib import Path

from hydrolek_drake.watching.alarms import Alarm, AlarmRule, Healthy, Judgement, alarm_of, judged
from hydrolek_drake.watching.live.settings import KEPT
from hydrolek_drake.watching.live.windows import FOLDER
from hydrolek_drake.watching.store import SEEN, Seen
from hydrolek_drake.watching.watch import Watched
from hydrolek_drake.watching.words import headline

_BEFORE = 10
"""Windows that are kept from before an alarm, to be seen beside it."""


class WindowSeries:
    """The windows of a live watch.

    Attributes:
        count: windows that were asked, those that are no longer kept among them.
        alarmed: the sentence of the first alarm; empty for none.
    """

    def __init__(self, healthy: Watched, rule: AlarmRule, earlier: Sequence[Seen], folder: Path) -> None:
        """Go on from what an earlier run left.

        Args:
            healthy: the watch of the reference alone.
            rule: of the alarm.
            earlier: recordings that were asked before, in the order of time.
            folder: of the watch.
        """
        self._watched, self._rule, self._folder = healthy, rule, folder
        self._kept: deque[tuple[Seen, Judgement | None]] = deque()
        self.count, self.alarmed = 0, ""
        self._alarm: Alarm | None = None
        for seen in earlier:
            self.add(seen)

    def add(self, seen: Seen) -> None:
        """Take what a window says."""
        judgement = None
        if seen.answer is not None:
            self.count += 1
            judgement = judged(seen.answer, self.count, self._rule, self._healthy)
        self._kept.append((seen, judgement))
        if len(self._kept) > KEPT:
            self._forget()
        if self._alarm is None:
            self._alarm = self._found()
        if self._alarm is not None:
            self.alarmed = headline(self.watched())

    @property
    def latest(self) -> tuple[Seen, Judgement] | None:
        """The last window that could be asked, and how it is judged."""
        return next(((s, j) for s, j in reversed(self._kept) if j is not None), None)

    def watched(self) -> Watched:
        """All that is kept, as `hydrolek watch` tells it."""
        seen = tuple(seen for seen, _ in self._kept)
        judgements = tuple(j for _, j in self._kept if j is not None)
        return Watched(
            self._watched.rig,
            self._watched.reference,
            seen,
            self._rule,
            self._watched.told,
            self._healthy,
            judgements,
            self._found() or self._alarm,
            self.count,
        )

    @property
    def _healthy(self) -> Healthy:
        return self._watched.healthy

    def _found(self) -> Alarm | None:
        answers = [seen.answer for seen, _ in self._kept if seen.answer is not None]
        return alarm_of(answers, [j for _, j in self._kept if j is not None], self._rule)

    def _forget(self) -> None:
        """Drop the oldest window; after an alarm those before it, and then one behind its beginning."""
        if self._alarm is not None and self._alarm.since <= _BEFORE:
            place = KEPT // 2
        else:
            place = 0
        seen, _ = self._kept[place]
        del self._kept[place]
        if self._alarm is not None:
            self._alarm = self._found() or self._alarm
        for path in (Path(seen.recording), self._folder / SEEN / f"{seen.digest[:32]}.json"):
            if path.parent.name in (FOLDER, SEEN):
                path.unlink(missing_ok=True)
