"""Windows in which commands got lost, completed: more beside those that were fitted, and none without need."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis import trace
from hydrolek_drake.diagnosis.fitting.elsewhere import tried_elsewhere
from hydrolek_drake.diagnosis.fitting.entrants import Entrant, Runner
from hydrolek_drake.diagnosis.fitting.problems import hypothesis_of, problem_with
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.locating.lost_windows_seen import lost_seen
from hydrolek_drake.diagnosis.settings import DROPOUTS, GAINS, NOISE
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.law_terms import of_additions
from hydrolek_drake.diagnosis.structures.lost_windows import (
    NONE,
    LostWindows,
    joined,
    lost_in,
    recording_of,
)
from hydrolek_drake.diagnosis.structures.weighing import least_over_noise
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.rolling import Request, residuals_at


def with_windows(
    bench: Workbench, parent: Hypothesis, lost: LostWindows, reached: float = math.inf
) -> list[Hypothesis]:
    """A structure with lost commands, more of them beside those that were fitted as long as some are seen.

    The structure has bent its numbers to make up for them, so that each fit also begins at the rig's own, with an
    observer that remembers a lost command. Windows fit anything a little, so that only what they explain to the noise
    counts, and none are looked for beside those that explain less than other structures do.

    Args:
        bench: data and problems.
        parent: the structure without them.
        lost: windows that were seen beside it.
        reached: what other structures leave, over the noise.
    """
    remembering = replace(bench.settings.free[-1], observer_s=DROPOUTS.remembers_s)
    rungs = (remembering, bench.settings.again)
    own, now, fits = of_additions(parent.values), lost, []
    values = parent.values
    for _ in range(bench.settings.lost_rounds):
        effects: tuple[Addition, ...] = (*parent.effects, now)
        begun = [Entrant(effects, own), Entrant(effects, values)]
        fitted = race(bench, begun, rungs)[0]
        if fitted.fit.over_noise > reached:
            break
        fitted, needed = _needed(bench, fitted, now, bench.training)
        fits.append(fitted)
        trace(f"    windows {list(map(len, needed.seen.values()))}: {fitted.fit.over_noise:.4f}")
        more = None
        if fitted.fit.over_noise > NOISE.at:
            known = needed.windows(needed.begun())
            more = _seen_beside(bench, fitted, needed, known, bench.training)
        now, values = more or needed, _without_windows(fitted)
        if more is None:
            break
    most = NOISE.explained * least_over_noise(bench.training)
    return [fit for fit in fits if fit.fit.over_noise <= most]


def _without_windows(structure: Hypothesis) -> dict[str, float]:
    """Values of a structure but for those of windows, which then begin where they are said to be."""
    return {path: value for path, value in structure.values.items() if ".lost." not in path}


def _needed(
    bench: Workbench,
    best: Hypothesis,
    lost: LostWindows,
    experiments: Sequence[Experiment],
    *,
    windows_alone: bool = False,
) -> tuple[Hypothesis, LostWindows]:
    """A structure without windows that explain no more than chance does, and its windows as fitted.

    First those go that the rest as it stands can do without, if it can do without all of them, then, the least needed
    first, those that it can do without once it is fitted again (backward elimination). Each must explain more than
    chance does.

    Args:
        bench: data and problems.
        best: the structure as fitted.
        lost: its windows, as they were before the fit.
        experiments: that it was fitted to.
        windows_alone: whether nothing else may be fitted to these.
    """
    fitted = replace(lost, seen=lost.windows(best.values))
    needed, at, kept = _rises(bench, best, fitted, experiments) > _by_chance(best), 0, {}
    for recording, windows in fitted.seen.items():
        kept[recording] = joined(windows[needed[at : at + len(windows)]])
        at += len(windows)
    fewer = sum(map(len, kept.values())) < len(needed)
    offered = [replace(fitted, seen=kept)] if fewer else _without_one(fitted)
    if windows_alone and not any(map(len, kept.values())):
        return best, replace(fitted, seen=kept)
    while offered := [each for each in offered if not windows_alone or _each(each)]:
        trials = [_exchanged(best, windows) for windows in offered]
        values = _without_windows(best)
        begun = []
        for additions in trials:
            problem = problem_with(bench, additions, best.step, experiments)
            moving = bench.movable(additions, problem.parameters)
            moving = _of_windows(problem.parameters) if windows_alone else moving
            begun.append(Place(problem, moving, problem.parameters.unit(values)))
        ended = descend(begun, bench.settings.again.rounds, bench.pool, bench.cores, stop=bench.alive)
        place, effects = min(zip(ended, trials, strict=True), key=lambda each: each[0].objective)
        less = _counted(fitted) - _counted(next(c for c in effects if isinstance(c, LostWindows)))
        if place.objective > best.fit.objective + less * _by_chance(best):
            if not fewer:
                break
            fewer, offered = False, _without_one(fitted)  # not all of them at once
            continue
        best = hypothesis_of(effects, place, best.step)
        fitted = next(c for c in effects if isinstance(c, LostWindows))
        fitted = replace(fitted, seen={r: joined(w) for r, w in fitted.windows(best.values).items()})
        fewer, offered = False, _without_one(fitted)
    return best, fitted


def _counted(lost: LostWindows) -> int:
    """How many windows there are."""
    return len(_each(lost))


def _of_windows(parameters: ParameterSet) -> np.ndarray:
    """Which parameters say when a command was lost. # (n,)."""
    return np.array([".lost." in path for path in parameters.paths])


def _without_one(lost: LostWindows) -> list[LostWindows]:
    """The same without each of its windows."""
    return [lost.without(*which) for which in _each(lost)]


def _each(lost: LostWindows) -> list[tuple[str, int]]:
    """Recording and number of each window."""
    return [(recording, number) for recording, w in lost.seen.items() for number in range(len(w))]


def _exchanged(structure: Hypothesis, other: LostWindows) -> tuple[Addition, ...]:
    """Additions of a structure with other windows."""
    return tuple(other if isinstance(c, LostWindows) else c for c in structure.effects)


def _by_chance(structure: Hypothesis) -> float:
    """Fall of the squares that a window may promise by chance."""
    return GAINS.certain**2 * max(structure.fit.chi_squared / max(structure.fit.counted, 1), 1.0)


def _rises(
    bench: Workbench, best: Hypothesis, now: LostWindows, experiments: Sequence[Experiment]
) -> np.ndarray:
    """By how much the squares rise without each window, with all else as it stands. # (k,)."""
    requests = []
    for which in _each(now):
        problem = problem_with(bench, _exchanged(best, now.without(*which)), best.step, experiments)
        requests.append(Request(problem, (problem.parameters.unit(_without_windows(best)),)))
    answers = residuals_at(requests, bench.pool, bench.cores)
    return np.array([float(r @ r) for (r,) in answers]) - best.fit.chi_squared


def _seen_beside(
    bench: Workbench,
    structure: Hypothesis,
    lost: LostWindows,
    known: dict[str, np.ndarray],
    experiments: tuple[Experiment, ...],
    *,
    as_fitted: bool = False,
) -> LostWindows | None:
    """Windows that free rollouts ask for beside those of a structure; None for none."""
    now = replace(lost, seen=known)
    effects = _exchanged(structure, now)
    there = replace(structure, effects=effects, values={**structure.values, **now.begun()})
    own = bench.with_training(experiments)
    values = there.values if as_fitted else None
    return lost_seen(own, there, lost.input, lost.neutral, known, lost.span, values)


def windows_held_out(
    bench: Workbench, structure: Hypothesis, experiment: Experiment, step: float
) -> LostWindows | None:
    """Windows in a recording to which nothing else of a structure is fitted; None where it has no lost commands.

    When commands got lost is no property of the machine, so each recording has its own.

    Args:
        bench: data and problems.
        structure: fitted to other recordings, or other blocks of this one, which then tell its windows.
        experiment: the recording.
        step: of the integration [s].
    """
    lost = lost_in(structure.effects)
    if lost is None:
        return None
    which = recording_of(experiment)
    if which in lost.seen:
        return replace(lost, seen={which: lost.windows(structure.values)[which]})
    rest = _without_windows(structure)
    now = replace(lost, seen={which: NONE})
    for _ in range(bench.settings.lost_rounds):
        more = _seen_beside(bench, structure, now, dict(now.seen), (experiment,), as_fitted=True)
        if more is None:
            break
        effects: tuple[Addition, ...] = tuple(more if c is lost else c for c in structure.effects)
        problem = problem_with(bench, effects, step, [experiment])
        begun = Place(problem, _of_windows(problem.parameters), problem.parameters.unit(rest))
        [led] = descend([begun], 12, bench.pool, bench.cores)
        [runner] = tried_elsewhere(bench, [Runner(effects, led)])
        fitted = hypothesis_of(effects, runner.place, step)
        fitted, now = _needed(bench, fitted, more, (experiment,), windows_alone=True)
        trace(f"    windows held out {now.seen[which].round(3).tolist()}: {fitted.fit.over_noise:.4f}")
        if fitted.fit.over_noise <= NOISE.at:
            break
    return now
