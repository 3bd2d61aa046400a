"""The whole watch: reference, later recordings one by one, alarms and trends."""

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

from threadpoolctl import threadpool_limits

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.search.cluster_jobs import ClusterJobs
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.alarms import (
    Alarm,
    AlarmRule,
    Healthy,
    Judgement,
    alarm_of,
    evidence_after,
    healthy_by,
    judged,
)
from hydrolek_drake.watching.asking import Answer, asked
from hydrolek_drake.watching.excitation import ReferenceTold
from hydrolek_drake.watching.questions import answered, questions_of, read_one, usable
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.settings import DRIFT, LEFT_OUT
from hydrolek_drake.watching.stamps import Stamp, stamp_of
from hydrolek_drake.watching.store import Seen, Store, digest_of, key_of
from hydrolek_drake.watching.trends import Trend, trend_of


@dataclass(frozen=True)
class Watched:
    """The outcome.

    Attributes:
        rig: the machine.
        reference: the reference recordings, each asked by what the others tell.
        seen: later recordings in the order of time, with those that could not be asked.
        rule: of the alarm.
        told: how surely the reference tells the machine's own numbers.
        healthy: what a healthy machine shows.
        judgements: of the recordings that could be asked.
        alarm: what is wrong; None for nothing.
        anew: how many recordings were asked by this run, not by an earlier one.
    """

    rig: Rig
    reference: tuple[Seen, ...]
    seen: tuple[Seen, ...]
    rule: AlarmRule
    told: ReferenceTold
    healthy: Healthy
    judgements: tuple[Judgement, ...]
    alarm: Alarm | None
    anew: int

    @property
    def asked(self) -> tuple[Seen, ...]:
        """Recordings that could be asked, in the order of time."""
        return tuple(each for each in self.seen if each.answer is not None)

    @property
    def answers(self) -> tuple[Answer, ...]:
        """What these say."""
        return tuple(each.answer for each in self.seen if each.answer is not None)

    @property
    def broken(self) -> tuple[Seen, ...]:
        """Recordings that could not be asked."""
        return tuple(each for each in self.seen if each.answer is None)

    @property
    def evidence(self) -> dict[str, dict[str, float]]:
        """Content hash of each that could be asked -> effect (`alarms.key_of`) -> evidence over what an alarm asks."""
        after = evidence_after(self.judgements, self.rule)
        return {
            each.digest: {key: share.share for key, share in shares.items()}
            for each, shares in zip(self.asked, after, strict=True)
        }

    def trend(self, effect: str, joint: str) -> Trend:
        """The course of an effect's size."""
        told = [
            (each.stamp.seconds, e.size, e.low, e.high)
            for each in self.asked
            if each.answer is not None
            for e in each.answer.effects
            if (e.effect, e.joint) == (effect, joint)
        ]
        times, sizes, lows, highs = ([row[i] for row in told] for i in range(4))
        return trend_of(times, sizes, lows, highs, self.rule.false_alarms)


def watch(
    rig: Rig,
    reference: Sequence[Path],
    recordings: Sequence[Path],
    *,
    folder: Path | None = None,
    drift: Mapping[str, float] | None = None,
    changes: Sequence[str] = (),
    rule: AlarmRule | None = None,
    cores: int | None = None,
    pool: Executor | None = None,
    cluster: ClusterJobs | None = None,
    say: Callable[[str], None] = lambda text: None,
) -> Watched:
    """Ask every later recording what differs from the reference; what was asked before is not asked again.

    Args:
        rig: the machine's nominal model.
        reference: recordings of the healthy machine.
        recordings: later ones; one that cannot be read is listed and stops nothing.
        folder: where results are kept; None to keep none.
        drift: path, section or part of one -> standard deviation by which these own numbers may differ from one
            recording to another, in ranges; "" for all others, `settings.DRIFT` without.
        changes: effects and own numbers that change between recordings of a healthy machine, such as its load: each
            recording is fitted with its own (`changing`).
        rule: of the alarm.
        cores: that roll out at the same time; all by default.
        pool: threads, or a cluster's; threads of its own by default.
        cluster: whose workers ask the later recordings, one each at a time; None to ask them here.
        say: told what is being done.

    Raises:
        InputError: a reference recording that cannot be used, or a folder of another watch.
    """
    drifts = drifts_of(drift)
    count = cores or os.cpu_count() or 1
    if not reference:
        raise InputError("a watch needs one reference recording of the healthy machine at least")
    training = training_of(rig, reference)
    store = Store(folder, key_of_all(rig, training, drifts, changes))
    own = None if pool is not None else ThreadPoolExecutor(count)
    try:
        with threadpool_limits(limits=1, user_api="blas"):
            return _watched(
                rig,
                training,
                recordings,
                store,
                drifts,
                tuple(changes),
                rule or AlarmRule(),
                count,
                pool or own,
                cluster,
                say,
            )
    finally:
        if own is not None:
            own.shutdown()


def drifts_of(drift: Mapping[str, float] | None) -> dict[str, float]:
    """Drift by name, that of all others by "", see `watch`."""
    return {"": DRIFT, **(drift or {})}


@dataclass(frozen=True)
class Trained:
    """A reference recording that can be used.

    Attributes:
        path: its file.
        digest: hash of its content.
        experiments: its joints.
        stamp: when it was made.
    """

    path: Path
    digest: str
    experiments: list[Experiment]
    stamp: Stamp


def training_of(rig: Rig, reference: Sequence[Path]) -> list[Trained]:
    """The reference recordings of a watch.

    Raises:
        InputError: one cannot be used, or is there twice.
    """
    training: list[Trained] = []
    for path in reference:
        recording = read_one(rig, path)
        experiments = usable(rig, recording)
        digest = digest_of(path)
        if any(digest == known.digest for known in training):
            raise InputError(f"reference {path} has the content of another one; a recording counts once")
        if any(
            experiments[0].name == known.experiments[0].name for known in training
        ):  # files of two folders
            experiments = [replace(e, name=f"{e.name} {len(training) + 1}") for e in experiments]
        training.append(Trained(path, digest, experiments, stamp_of(path, recording)))
    return training


def key_of_all(
    rig: Rig, training: Sequence[Trained], drifts: Mapping[str, float], changes: Sequence[str] = ()
) -> str:
    """What a watch's results belong to."""
    return key_of(rig, [each.digest for each in training], dict(drifts), changes)


def _watched(
    rig: Rig,
    training: list[Trained],
    recordings: Sequence[Path],
    store: Store,
    drifts: Mapping[str, float],
    changes: Sequence[str],
    rule: AlarmRule,
    cores: int,
    pool: Executor | None,
    cluster: ClusterJobs | None,
    say: Callable[[str], None],
) -> Watched:
    """See `watch`."""
    assert pool is not None
    kept = store.reference()
    experiments = [e for each in training for e in each.experiments]
    session = Session(rig, experiments, pool, cores, drifts, None if kept is None else kept[0], say, changes)
    if kept is None:
        told = []
        for each in training[:LEFT_OUT]:
            say(f"reference {each.path}")
            own = each.experiments
            known = session.knowledge_without(own[0].name) if len(training) > 1 else None
            answer = asked(session, own, known)
            told.append(Seen(str(each.path), each.digest, each.stamp, answer, reference=True))
        store.keep_reference(session.posterior, told)
    else:
        told = kept[1]
    seen = store.seen()
    anew = 0
    for new in answered(session, questions_of(session, recordings, seen, say), cluster):
        anew += 1
        seen[new.digest] = new
        store.keep(new)
    healthy = healthy_by([each.answer for each in told if each.answer is not None])
    ordered = tuple(sorted(seen.values(), key=lambda each: (each.stamp.seconds, each.recording)))
    answers = [each.answer for each in ordered if each.answer is not None]
    judgements = tuple(judged(answer, n, rule, healthy) for n, answer in enumerate(answers, start=1))
    return Watched(
        rig,
        tuple(told),
        ordered,
        rule,
        session.told,
        healthy,
        judgements,
        alarm_of(answers, judgements, rule),
        anew,
    )
