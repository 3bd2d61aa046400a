"""Later recordings as questions to a fitted reference, asked here or on a cluster, each as soon as it is read."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from hydrolek_drake.checking.clock import refuse_other_clock
from hydrolek_drake.diagnosis.structures.splitting import reasons_against
from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.search.cluster_jobs import ClusterJobs
from hydrolek_drake.recordings import Recording, read_recording
from hydrolek_drake.rigs import Rig
from hydrolek_drake.runs.remaining import Remaining
from hydrolek_drake.watching.asking import Answer, asked
from hydrolek_drake.watching.reference import Reference, Session
from hydrolek_drake.watching.stamps import Stamp, stamp_of
from hydrolek_drake.watching.store import Seen, digest_of


@dataclass(frozen=True)
class Question:
    """A recording that can be asked; without experiments one that cannot, and why."""

    seen: Seen
    experiments: list[Experiment]


def questions_of(
    session: Session, recordings: Sequence[Path], known: Mapping[str, Seen], say: Callable[[str], None]
) -> Iterator[Question]:
    """Recordings whose content was not seen before, each read when it is its turn."""
    given, remaining = set(known), Remaining(len(recordings))
    for number, path in enumerate(recordings, start=1):
        try:
            digest = digest_of(path)
        except InputError as error:
            digest = f"unreadable {path}"
            if digest not in given:
                yield Question(Seen(str(path), digest, _no_stamp(path), None, str(error)), [])
            remaining.one_ended(at_once=True)
            continue
        if digest in given:
            remaining.one_ended(at_once=True)
            continue
        given.add(digest)
        say(f"recording {number} of {len(recordings)}, {path}{remaining.words()}")
        recording = None
        try:
            recording = read_one(session.rig, path)
            experiments = usable(session.rig, recording)
            missing = sorted({e.joint for e in experiments} - set(session.joints))
            if missing:
                raise InputError(f"{path} drives {', '.join(missing)}, of which the reference shows nothing")
        except (InputError, ValueError, ArithmeticError) as error:
            problem = told_of(path, error)
            yield Question(Seen(str(path), digest, stamp_of(path, recording), None, problem), [])
            remaining.one_ended(at_once=True)
        else:
            yield Question(Seen(str(path), digest, stamp_of(path, recording), None), experiments)
            remaining.one_ended()


def answered(session: Session, questions: Iterable[Question], cluster: ClusterJobs | None) -> Iterator[Seen]:
    """What recordings say, here or over a cluster, each as soon as it is known."""
    if cluster is None:
        for question in questions:
            yield _with_answer(question.seen, _asked(session, question.experiments))
        return
    reference, broken = cluster.shared(session.reference), []

    def jobs() -> Iterator[tuple[Seen, tuple[Any, ...]]]:
        for question in questions:
            if question.experiments:
                yield question.seen, (reference, question.experiments)
            else:
                broken.append(question.seen)

    for seen, answer in cluster.done(_asked_there, jobs()):
        yield _with_answer(seen, answer)
    yield from broken


def _asked_there(reference: Reference, experiments: list[Experiment]) -> Answer | Exception | None:
    """The same on a worker of a cluster, which has one thread for it."""
    with threadpool_limits(limits=1, user_api="blas"), ThreadPoolExecutor(1) as pool:
        return _asked(reference.session(pool, 1), experiments)


def _asked(session: Session, experiments: list[Experiment]) -> Answer | Exception | None:
    """The answer, or why there is none; None for a recording that cannot be asked."""
    if not experiments:
        return None
    try:
        return asked(session, experiments)
    except (InputError, ValueError, ArithmeticError) as error:
        return error


def _with_answer(seen: Seen, answer: Answer | Exception | None) -> Seen:
    if answer is None:
        return seen
    if isinstance(answer, Answer):
        return replace(seen, answer=answer)
    return replace(seen, problem=told_of(seen.recording, answer))


def told_of(path: Path | str, error: Exception) -> str:
    """Why a recording could not be asked; numbers that nobody foresaw stop no watch."""
    return str(error) if isinstance(error, InputError) else f"{path} could not be asked: {error}"


def _no_stamp(path: Path) -> Stamp:
    try:
        return stamp_of(path)
    except OSError:
        return Stamp(0.0, "none")


def read_one(rig: Rig, path: Path) -> Recording:
    """A recording of the rig.

    Raises:
        InputError: it cannot be read, or its clock is not in seconds.
    """
    recording = read_recording(path, rig.columns, dead_time=rig.dead_time)
    refuse_other_clock(rig, recording)
    return recording


def usable(rig: Rig, recording: Recording) -> list[Experiment]:
    """Experiments of a recording that can carry a diagnosis.

    Raises:
        InputError: it cannot, and why.
    """
    experiments = experiments_of(rig, recording)
    reasons = reasons_against(recording, experiments)
    if reasons:
        raise InputError(f"{recording.source}: {reasons[0]}")
    return experiments
