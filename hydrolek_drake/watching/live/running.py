"""The whole live watch: reference, source, observer, questions beside, page; until Ctrl-C."""

import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hydrolek_drake.identification.parameter_set import ParameterSet, free_of_joints
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.alarms import AlarmRule
from hydrolek_drake.watching.live.blocks import healthy_of
from hydrolek_drake.watching.live.choosing import source_of
from hydrolek_drake.watching.live.following import Follower
from hydrolek_drake.watching.live.page_state import description, samples_of, status
from hydrolek_drake.watching.live.publishing import FoxgloveServer
from hydrolek_drake.watching.live.questions import Questions
from hydrolek_drake.watching.live.samples import Samples, by_joint, refuse_driven
from hydrolek_drake.watching.live.series import WindowSeries
from hydrolek_drake.watching.live.server import LivePage
from hydrolek_drake.watching.live.settings import AT_A_TIME, POLL_S, SILENT_S, STATE_S
from hydrolek_drake.watching.live.sources import Link, Source
from hydrolek_drake.watching.live.windows import Window
from hydrolek_drake.watching.store import Store
from hydrolek_drake.watching.watch import Watched, drifts_of, key_of_all, training_of, watch


@dataclass(frozen=True)
class Options:
    """How a live watch is run.

    Attributes:
        source: `tcp://HOST:PORT`, a file or a folder.
        folder: where results are kept; None to keep none.
        drift: as of `watch`.
        rule: of the alarm; half of the false alarms are the windows', half the innovations'.
        port: of the page.
        foxglove: port of the Foxglove server; None for none.
        token: that a sender over a network must show.
        idle: seconds without anything new after which it ends; None to wait for ever.
    """

    source: str
    folder: Path | None
    drift: Mapping[str, float]
    rule: AlarmRule
    port: int
    foxglove: int | None = None
    token: str | None = None
    idle: float | None = None


@dataclass(frozen=True)
class LiveOutcome:
    """How it ended.

    Attributes:
        watched: what the windows say.
        innovations: the alarm by innovations in a sentence; empty for none.
        follower: of the stream, with its counts and events.
    """

    watched: Watched
    innovations: str
    follower: Follower

    @property
    def alarmed(self) -> bool:
        """Whether there is an alarm of either kind."""
        return bool(self.innovations) or self.watched.alarm is not None


def run_live(
    rig: Rig,
    reference: Sequence[Path],
    options: Options,
    say: Callable[[str], None],
    tell: Callable[[str], None],
) -> LiveOutcome:
    """Follow a stream until Ctrl-C.

    Args:
        rig: the machine's nominal model.
        reference: recordings of the healthy machine.
        options: how.
        say: told what is being done before it listens.
        tell: told where the page is, and every event.

    Raises:
        InputError: the reference cannot be used, there is nothing to follow, or a port is taken.
    """
    refuse_driven(rig)
    with ExitStack() as stack:
        folder = options.folder
        if folder is None:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="hydrolek_watch_")))
        half = replace(options.rule, false_alarms=0.5 * options.rule.false_alarms)
        drifts = drifts_of(options.drift)
        source = _source(rig, reference, options)
        stack.callback(source.close)
        healthy_watch = watch(rig, reference, [], folder=folder, drift=options.drift, rule=half, say=say)
        say("innovations of the reference")
        fitted, joints = fitted_rig(rig, reference, folder, drifts)
        recordings = [read_recording(path, rig.columns, dead_time=rig.dead_time) for path in reference]
        healthy = healthy_of(fitted, joints, recordings)
        questions = Questions(rig, reference, folder, drifts, joints)
        stack.callback(questions.close)
        series = WindowSeries(
            replace(healthy_watch, seen=(), judgements=()), half, healthy_watch.seen, folder
        )
        server = None
        if options.foxglove is not None:
            server = FoxgloveServer(joints, options.foxglove)
            stack.callback(server.close)
        follower = Follower(
            fitted,
            healthy,
            half.false_alarms,
            on_window=lambda window: _ask(questions, window),
            on_sample=(lambda sample: None) if server is None else server.publish,
        )
        loop = _Loop(fitted, source, follower, questions, series, server, options, tell)
        page = LivePage(options.port, loop.first)
        stack.callback(page.close)
        tell(f"page: {page.address}")
        if server is not None:
            tell(f"Foxglove: ws://127.0.0.1:{server.port}")
        tell(f"following {source.link().name}; Ctrl-C ends it")
        say("following")
        try:
            loop.run(page)
        except KeyboardInterrupt:
            pass  # the way to end it
        follower.flush(time.time())
        for seen in questions.close():
            series.add(seen)
        return LiveOutcome(series.watched(), follower.alarm_text, follower)


def fitted_rig(
    rig: Rig, reference: Sequence[Path], folder: Path, drifts: Mapping[str, float]
) -> tuple[Rig, tuple[str, ...]]:
    """The rig with the numbers of the kept reference, and the joints that it shows.

    Args:
        rig: the machine's nominal model.
        reference: recordings that were fitted.
        folder: where the fit is kept.
        drifts: as of `watching.watch.drifts_of`.
    """
    training = training_of(rig, reference)
    kept = Store(folder, key_of_all(rig, training, drifts)).reference()
    assert kept is not None, "the reference was fitted before"
    joints = dict.fromkeys(e.joint for each in training for e in each.experiments)
    parameters = ParameterSet(rig, free_of_joints(rig, set(joints)), {})
    return rig.with_values(parameters.values(np.asarray(kept[0].mean))), tuple(joints)


def _source(rig: Rig, reference: Sequence[Path], options: Options) -> Source:
    """The source, which is opened before anything is fitted, so that a wrong one is told at once."""
    recording = read_recording(reference[0], rig.columns, dead_time=rig.dead_time)
    joints = [joint for joint in rig.joints if f"{joint}.command" in recording.signals]

    def accepts(samples: Samples) -> None:
        by_joint(rig, joints, samples)

    return source_of(options.source, rig, options.token, accepts)


def _ask(questions: Questions, window: Window) -> None:
    questions.ask(window)


class _Loop:
    """Carries samples from the source to all that want them."""

    def __init__(
        self,
        rig: Rig,
        source: Source,
        follower: Follower,
        questions: Questions,
        series: WindowSeries,
        server: FoxgloveServer | None,
        options: Options,
        tell: Callable[[str], None],
    ) -> None:
        self._rig, self._source, self._follower = rig, source, follower
        self._questions, self._series, self._server = questions, series, server
        self._told_failed = False
        self._options, self._tell = options, tell
        self._told_events = 0
        self._link_state = "waiting"
        self._last = self._told = time.monotonic()
        self._alarmed = ""
        self._shown = 0
        self._status = self._state()

    def first(self) -> dict[str, object]:
        """What a browser is told when it comes."""
        joints = self._follower.joints
        rows = samples_of(self._rig, joints, list(self._follower.history))
        return {**description(self._rig, joints), "rows": rows, "status": self._status}

    def run(self, page: LivePage) -> None:
        """Until it is interrupted, or idle for as long as was said."""
        self._last = time.monotonic()
        flushed = False
        while True:
            begun = time.monotonic()
            found = self._source.read()
            for samples, arrival in found:
                for part in samples.parts(AT_A_TIME):
                    self._follower.take(part, arrival, time.time())
                    self._serve(page)
            if found:
                self._last, flushed = time.monotonic(), False
            elif not flushed and begun - self._last >= SILENT_S:
                self._follower.flush(time.time())
                flushed = True
            self._serve(page)
            idle = self._options.idle
            if idle is not None and begun - self._last >= idle and not self._questions.busy:
                return
            if not found:
                time.sleep(POLL_S)

    def _serve(self, page: LivePage) -> None:
        """Take what was answered, and tell the page where it is time."""
        for seen in self._questions.answers():
            self._series.add(seen)
        if self._questions.failed and not self._told_failed:
            self._told_failed = True
            self._follower.note("refused", f"windows: {self._questions.failed}", time.time())
        if time.monotonic() - self._told >= STATE_S:
            self._told = time.monotonic()
            self._show(page)

    def _show(self, page: LivePage) -> None:
        link = self._link()
        if link.state != self._link_state and {link.state, self._link_state} & {"lost", "silent"}:
            self._follower.note("link", f"link {link.state}: {link.text}".removesuffix(": "), time.time())
        self._link_state = link.state
        self._status = self._state()
        if page.browsers:
            fresh = [each for each in self._follower.history if each.number > self._shown]
            rows = samples_of(self._rig, self._follower.joints, fresh)
            page.tell({"rows": rows, "status": self._status})
        if self._follower.history:
            self._shown = self._follower.history[-1].number
        alarms = [text for text in (self._series.alarmed, self._follower.alarm_text) if text]
        if self._server is not None:
            self._server.tell(self._follower, alarms)
        happened = self._follower.happened
        fresh_events = min(happened - self._told_events, len(self._follower.events))
        for event in list(self._follower.events)[len(self._follower.events) - fresh_events :]:
            self._tell(event.text)
        self._told_events = happened
        if self._series.alarmed and not self._alarmed:
            self._tell(self._series.alarmed)
        self._alarmed = self._series.alarmed

    def _link(self) -> Link:
        """How the source does; one that is open and brings nothing is silent."""
        link, quiet = self._source.link(), time.monotonic() - self._last
        if link.state == "open" and self._follower.merger.counts.taken and quiet >= SILENT_S:
            return replace(
                link, state="silent", text=f"nothing has come for a while; {link.text}".rstrip("; ")
            )
        return link

    def _state(self) -> dict[str, object]:
        return status(
            self._follower,
            self._series,
            self._link(),
            self._questions.busy,
            self._questions.passed_over,
        )
