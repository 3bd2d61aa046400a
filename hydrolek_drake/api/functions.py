"""Replay, fit, diagnose and watch with keyword arguments."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from hydrolek_drake.api.progress import telling
from hydrolek_drake.api.recordings import recording_of, recordings_of
from hydrolek_drake.api.results_of_models import DiagnosisResult, FitResult, ReplayResult
from hydrolek_drake.api.watch_result import WatchResult
from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay.comparison import compare
from hydrolek_drake.replay.replay import replay as run_replay
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs import load_rig as load
from hydrolek_drake.watching.settings import FALSE_ALARMS

if TYPE_CHECKING:
    from hydrolek_drake.api.recordings import Given


def load_rig(rig: str | Path | Rig, *, settings: Mapping[str, str | float] | None = None) -> Rig:
    """A rig by its name or file.

    Args:
        rig: name of a built-in rig, or a rig file; one that is loaded is itself.
        settings: path -> value, in SI or as text with a unit, as `--set`: `{"supply.pressure": "12 MPa"}`.

    Raises:
        InputError: no such rig or parameter, a value that is none, or settings for a rig that is loaded already.
    """
    given = {path: str(value) for path, value in (settings or {}).items()}
    if not isinstance(rig, Rig):
        return load(str(rig), given)
    if given:
        raise InputError("settings are for a rig's name or file; one that is loaded has Rig.with_values")
    return rig


def read(recording: Given, *, rig: str | Path | Rig | None = None) -> Recording:
    """A recording from a file or a DataFrame.

    Args:
        recording: path or DataFrame.
        rig: whose column names apply.

    Raises:
        InputError: it cannot be read.
    """
    return recording_of(recording, None if rig is None else load_rig(rig))


def replay(
    rig: str | Path | Rig,
    recording: Given,
    *,
    between: tuple[float, float] | None = None,
    progress: bool = True,
) -> ReplayResult:
    """Drive a rig's model with a recorded command and compare.

    Args:
        rig: name, file or rig.
        recording: path, DataFrame or recording.
        between: only this time of the recording [s].
        progress: whether to show what is done.

    Raises:
        InputError: the recording lacks what the rig needs.
    """
    loaded = load_rig(rig)
    [given] = recordings_of([recording], loaded)
    with telling(progress, "replaying"):
        done = run_replay(loaded, given, between)
        return ReplayResult(done, compare(done))


def fit(
    rig: str | Path | Rig,
    recordings: Given | Sequence[Given],
    *,
    parameters: Sequence[str] | None = None,
    method: str = "least-squares",
    holdout: Given | Sequence[Given] = (),
    budget: int = 8000,
    seed: int = 1,
    workers: int | None = None,
    progress: bool = True,
) -> FitResult:
    """Estimate a rig's free parameters.

    Args:
        rig: name, file or rig.
        recordings: fitted together: one or several paths, DataFrames or recordings.
        parameters: only these; None for all with a range that the recordings can tell.
        method: least-squares, cma, de, ga or nsga2.
        holdout: only compared with.
        budget: simulations that a search may make.
        seed: of everything random.
        workers: threads; as many as there are cores by default.
        progress: whether to show what is done.

    Raises:
        InputError: unknown method, parameter without range, recording without what is needed.
    """
    from hydrolek_drake.identification.fit import fit_rig

    loaded = load_rig(rig)
    train, held = recordings_of(recordings, loaded), recordings_of(holdout, loaded)
    with telling(progress, "fitting") as tell:
        fitted = fit_rig(
            loaded,
            train,
            method,
            paths=parameters,
            holdout=held,
            budget=budget,
            seed=seed,
            workers=workers or os.cpu_count() or 1,
            progress=lambda done, best: tell(f"{method}: {done} evaluations, best {best:.4g}"),
        )
    return FitResult(fitted, tuple(train))


def diagnose(
    rig: str | Path | Rig,
    recordings: Given | Sequence[Given],
    *,
    holdout: Given | Sequence[Given] = (),
    between: tuple[float, float] | None = None,
    at_most_minutes: float | None = None,
    workers: int | None = None,
    progress: bool = True,
) -> DiagnosisResult:
    """Find out what physics a rig's model leaves out; an interrupt ends it with what is known by then.

    Args:
        rig: name, file or rig.
        recordings: to explain: one or several paths, DataFrames or recordings.
        holdout: decide, and are not fitted; blocks of the recordings without.
        between: fit this part of the recordings only [s].
        at_most_minutes: end the search then; in the main thread alone, which receives the clock's signal.
        workers: threads; as many as there are cores by default.
        progress: whether to show what is done.

    Raises:
        InputError: the recordings lack what the rig needs.
    """
    from hydrolek_drake.diagnosis.diagnosis import diagnose as run_diagnosis
    from hydrolek_drake.diagnosis.report.as_json import effects_json
    from hydrolek_drake.runs.time_limit import ended_after

    loaded = load_rig(rig)
    train, held = recordings_of(recordings, loaded), recordings_of(holdout, loaded)
    count = workers or os.cpu_count() or 1
    seconds = None if at_most_minutes is None else 60.0 * at_most_minutes
    with telling(progress, "diagnosing") as tell, ThreadPoolExecutor(count) as pool, ended_after(seconds):
        done = run_diagnosis(loaded, train, held, pool, say=tell, between=between, cores=count)
    return DiagnosisResult(done, [] if done.bench is None else effects_json(done))


def watch(
    rig: str | Path | Rig,
    reference: str | Path | Sequence[str | Path],
    recordings: str | Path | Sequence[str | Path],
    *,
    out: str | Path | None = None,
    drift: float | Mapping[str, float] | None = None,
    changes: Sequence[str] = (),
    limits: Mapping[str, float | str] | None = None,
    false_alarms: float = FALSE_ALARMS,
    workers: int | None = None,
    progress: bool = True,
) -> WatchResult:
    """Ask later recordings what changed since a healthy reference.

    Args:
        rig: name, file or rig.
        reference: files of the healthy machine.
        recordings: later files, or folders of them.
        out: folder in which what was seen is kept, so that it is not asked again; nothing is kept without.
        drift: standard deviation by which the machine's own numbers may drift between recordings, in ranges: one for
            all, or by name with "" for all others.
        changes: effects and own numbers that change between recordings of the healthy machine, such as its load.
        limits: effect -> size that it must not reach, in SI or as text with a unit.
        false_alarms: probability of any false alarm in the whole series.
        workers: threads; as many as there are cores by default.
        progress: whether to show what is done.

    Raises:
        InputError: what is wrong with the arguments or the reference.
    """
    from hydrolek_drake.watching.alarms import AlarmRule
    from hydrolek_drake.watching.limits import limits_of
    from hydrolek_drake.watching.listing import listed
    from hydrolek_drake.watching.watch import watch as run_watch

    loaded = load_rig(rig)
    references, given = _paths(reference), _paths(recordings)
    told = limits_of([f"{name}={size}" for name, size in (limits or {}).items()], loaded)
    drifts = {"": drift} if isinstance(drift, int | float) else dict(drift or {})
    folder = None if out is None else Path(out)
    with telling(progress, "watching") as tell:
        watched = run_watch(
            loaded,
            references,
            listed(given, references),
            folder=folder,
            drift=drifts,
            changes=changes,
            rule=AlarmRule(false_alarms),
            cores=workers,
            say=tell,
        )
    result = WatchResult(watched, told)
    if folder is not None:
        result.write(folder)
    return result


def _paths(given: str | Path | Sequence[str | Path]) -> list[Path]:
    several = [given] if isinstance(given, str | Path) else given
    return [Path(each) for each in several]
