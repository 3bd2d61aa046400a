"""The stream followed: put in order, observed, judged block by block, gathered in windows; of constant memory."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.kernel import PULLED
from hydrolek_drake.watching.live.blocks import Block, Blocks, Healthy
from hydrolek_drake.watching.live.detecting import STATISTICS, ChangeDetector
from hydrolek_drake.watching.live.merging import Break, Merger, Row
from hydrolek_drake.watching.live.observing import Observer
from hydrolek_drake.watching.live.samples import Samples, by_joint
from hydrolek_drake.watching.live.settings import EVENTS, HISTORY_S, PULL_S, SETTLED, SHOWN_HZ
from hydrolek_drake.watching.live.windows import Begin, Window, Windows

_ON = 12
"""Place of the time since switching on in a state, see `kernel.integrate`."""


_CALENDAR_S = 6e8
"""Clocks that show more than that count from 1970: before, a machine would have been on for twenty years."""


def told_time(seconds: float) -> str:
    """A time of the stream in words: of a calendar (UTC), or since its clock began."""
    if seconds < _CALENDAR_S:
        return f"{seconds:.1f} s of the stream"
    return datetime.fromtimestamp(seconds, timezone.utc).strftime("%Y-%m-%d %H:%M:%S")


@dataclass(frozen=True)
class Event:
    """Something that happened to the stream.

    Attributes:
        time: of the stream [s].
        kind: as of `merging.Break`, "unstable", "refused", "link" or "alarm".
        text: in words.
        now: when it was noticed [s since 1970].
    """

    time: float
    kind: str
    text: str
    now: float


@dataclass(frozen=True)
class Observed:
    """A sample as it was observed.

    Attributes:
        number: counted from the beginning.
        time: [s].
        volts: commands [V]. # (joints,)
        measured: `kernel.PULLED`. # (joints, 3)
        modelled: what the observer expected; NaN where it has only begun. # (joints, 3)
        innovations: over what the reference gives, root mean square. # (joints, 3)
        settled: whether they are judged.
    """

    number: int
    time: float
    volts: np.ndarray
    measured: np.ndarray
    modelled: np.ndarray
    innovations: np.ndarray
    settled: bool


class Follower:
    """Follows a stream.

    Attributes:
        joints: that are observed, in the order of the rows.
        healthy: what innovations of the healthy machine are like.
        detector: the test of the innovations.
        merger: what puts messages in order, with their counts.
        history: the last minute, as the page shows it.
        events: gaps, jumps, restarts and alarms, the last ones.
        happened: how many there were.
        blocks: that were judged.
        last_block: the last one.
    """

    def __init__(
        self,
        rig: Rig,
        healthy: Healthy,
        false_alarms: float,
        on_window: Callable[[Window], None] = lambda window: None,
        on_sample: Callable[[Observed], None] = lambda sample: None,
    ) -> None:
        """Prepare.

        Args:
            rig: with the values of the fitted model.
            healthy: what the reference's innovations are like.
            false_alarms: probability of any alarm by innovations of a healthy machine.
            on_window: given every clean window.
            on_sample: given every sample that is observed.
        """
        self._rig, self.healthy, self.joints = rig, healthy, healthy.joints
        self._on_window, self._on_sample = on_window, on_sample
        self.merger = Merger(healthy.interval)
        self.observer = Observer(rig, self.joints, healthy.response)
        self.detector = ChangeDetector(healthy, false_alarms)
        self._gathered = Blocks(healthy.scale, healthy.interval)
        self.windows = Windows(len(self.joints))
        self.history: deque[Observed] = deque(maxlen=round(HISTORY_S * SHOWN_HZ))
        self.events: deque[Event] = deque(maxlen=EVENTS)
        self.happened = 0
        self.blocks = 0
        self.last_block: Block | None = None
        self._settled = np.inf
        self._shown = -np.inf
        self._number = 0

    def take(self, samples: Samples, arrival: float | None, now: float) -> None:
        """Take samples.

        Args:
            samples: in any order.
            arrival: when they came, by a clock of this machine [s]; None where that says nothing.
            now: [s since 1970].
        """
        try:
            values = by_joint(self._rig, self.joints, samples)
        except InputError as error:
            self._event(np.nan, "refused", str(error), now)
            return
        if samples.begins:
            self._pass_on(self.merger.begin(), now)
        for time, row in zip(samples.time.tolist(), values, strict=True):
            self._pass_on(self.merger.push(time, row, arrival), now)

    def note(self, kind: str, text: str, now: float) -> None:
        """Something happened to the link.

        Args:
            kind: for the list of events.
            text: in words.
            now: [s since 1970].
        """
        self._event(np.nan if self.observer.time is None else self.observer.time, kind, text, now)

    def flush(self, now: float) -> None:
        """The link is silent: what still waits for late messages is observed."""
        self._pass_on(self.merger.flush(), now)

    @property
    def asks(self) -> bool:
        """Whether there are joints of which windows can be asked: those that move alone."""
        return self.observer.time is None or bool(self.observer.states())

    @property
    def settled(self) -> bool:
        """Whether innovations are judged."""
        return self.observer.time is not None and self.observer.time >= self._settled

    def _pass_on(self, items: Sequence[Row | Break], now: float) -> None:
        for item in items:
            if isinstance(item, Break):
                self._event(item.to, item.kind, item.text, now)
                self._restart()
            else:
                self._observe(item, now)

    def _restart(self) -> None:
        self.observer.restart()
        self._gathered.restart()
        self.windows.restart()
        self._settled = np.inf

    def _observe(self, row: Row, now: float) -> None:
        try:
            told = self.observer.step(row.time, row.values)
        except InputError as error:
            self._event(row.time, "unstable", f"the observer begins anew: {error}", now)
            self._restart()
            return
        measured = row.values[:, 1:]
        if told is None:
            told = np.full(measured.shape, np.nan)
            if self.observer.time is not None:
                self._settled = row.time + SETTLED * PULL_S
        settled = self.settled
        if settled:
            sure = self.observer.sure
            self._judge(row.time, np.where(sure[:, None], told, np.nan), now)
            if not sure.all():  # it is not known when a command changed
                self.windows.restart()
            elif not self.windows.begun and row.time >= self.observer.unsure_until.max() + PULL_S:
                self._begin_window()
        window = self.windows.add(row.time, row.values, self.observer.volts, now)
        if window is not None and window.moved(self.joints):
            self._on_window(window)
        self._number += 1
        sample = Observed(
            self._number,
            row.time,
            self.observer.volts,
            measured,
            self.observer.modelled.copy(),
            told / self.healthy.scale,
            settled,
        )
        self._on_sample(sample)
        if not 0.0 <= row.time - self._shown < (1.0 - 1e-6) / SHOWN_HZ:
            self._shown = row.time
            self.history.append(sample)

    def _judge(self, time: float, told: np.ndarray, now: float) -> None:
        block = self._gathered.add(time, told)
        if block is None:
            return
        self.blocks, self.last_block = self.blocks + 1, block
        if self.detector.add(block):
            self._event(time, "alarm", self.alarm_text, now)

    @property
    def alarm_text(self) -> str:
        """The alarm by innovations in a sentence; empty for none."""
        first = self.detector.first
        if first is None or self.detector.alarmed is None:
            return ""
        which, joint, quantity = first
        return (
            f"Innovations of {self.joints[joint]} ({PULLED[quantity]}, {STATISTICS[which]}) are no longer those of the "
            f"healthy machine, alarmed at {told_time(self.detector.alarmed)}."
        )

    def _begin_window(self) -> None:
        """A window begins with this row, if every joint's state is known."""
        states = self.observer.states()
        begins = {}
        for place, joint in enumerate(self.joints):
            if joint in states:
                state = states[joint]
                state[_ON] = 0.0  # each window is a recording by itself
                reading = float(self.observer.modelled[place, 0])
                begins[joint] = Begin(state, reading, float(self.healthy.scale[place, 0]))
        if begins:
            self.windows.begin(begins)

    def _event(self, time: float, kind: str, text: str, now: float) -> None:
        if self.events and kind == "refused" and self.events[-1].text == text:
            return  # said already
        self.events.append(Event(time, kind, text, now))
        self.happened += 1
