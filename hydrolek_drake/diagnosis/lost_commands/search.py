"""Windows in which commands got lost, completed: more beside those that were fitted, and none without need."""

from dataclasses import replace
from typing import Any

import numpy as np

from hydrolek_drake.diagnosis.evidence.conclusion import EXPLAINED
from hydrolek_drake.diagnosis.evidence.noise import AT_NOISE
from hydrolek_drake.diagnosis.fitting.lockstep import Place, descend
from hydrolek_drake.diagnosis.fitting.race import Entrant, Runner, problem_with, race, tried_elsewhere
from hydrolek_drake.diagnosis.fitting.rolling import Request, residuals_at
from hydrolek_drake.diagnosis.laws.additions import of_additions
from hydrolek_drake.diagnosis.lost_commands.seen import GAIN, REMEMBERS_S, lost_seen
from hydrolek_drake.diagnosis.lost_commands.windows import (
    NONE,
    LostWindows,
    joined,
    recording_of,
)
from hydrolek_drake.diagnosis.search.settings import Settings
from hydrolek_drake.diagnosis.search.tracing import trace
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment


def lost_in(hypothesis: Hypothesis) -> LostWindows | None:
    """Lost commands of a structure, if it has any."""
    return next((c for c in hypothesis.effects if isinstance(c, LostWindows)), None)


def with_windows(
    bench: Workbench, parent: Hypothesis, lost: LostWindows, settings: Settings, cores: int
) -> list[Hypothesis]:
    """A structure with lost commands, more of them beside those that were fitted as long as some are seen.

    The structure has bent its numbers to make up for them, so that each fit also begins at the rig's own, with an
    observer that remembers a lost command. Windows fit anything a little, so that only what they explain to the noise
    counts.

    Args:
        bench: data and problems.
        parent: the structure without them.
        lost: windows that were seen beside it.
        settings: of the search.
        cores: that roll out at the same time.
    """
    rungs = tuple(rung for rung in settings.continued if rung.observer_s >= REMEMBERS_S)
    own, now, fits = of_additions(parent.values), lost, []
    values = parent.values
    for _ in range(settings.lost_rounds):
        effects: tuple[Any, ...] = (*parent.effects, now)
        begun = [Entrant(effects, own), Entrant(effects, values)]
        fitted = race(bench, begun, rungs, cores)[0]
        needed = _needed(bench, fitted, now, cores)
        fits.append(fitted)
        trace(f"    windows {list(map(len, needed.seen.values()))}: {fitted.fit.over_noise:.4f}")
        known = needed.begun()
        more = _seen_beside(bench, fitted, needed, needed.windows(known), bench.training, cores)
        now, values = more or needed, _without_windows(fitted)
        if more is None or fitted.fit.over_noise <= AT_NOISE:
            effects = (*parent.effects, needed)
            fits += race(bench, [Entrant(effects, values)], settings.free[-1:], cores)
            break
    return [fit for fit in fits if fit.fit.over_noise <= EXPLAINED]


def _without_windows(structure: Hypothesis) -> dict[str, float]:
    """Values of a structure but for those of windows, which then begin where they are said to be."""
    return {path: value for path, value in structure.values.items() if ".lost." not in path}


def _needed(bench: Workbench, best: Hypothesis, lost: LostWindows, cores: int) -> LostWindows:
    """Windows as fitted, without those that explain no more than chance does."""
    now = replace(lost, seen=lost.windows(best.values))
    rest = _without_windows(best)
    trials = [(recording, number) for recording, w in now.seen.items() for number in range(len(w))]
    requests = []
    for recording, number in trials:
        effects: tuple[Any, ...] = tuple(
            now.without(recording, number) if c is lost else c for c in best.effects
        )
        problem = problem_with(bench, effects, best.step, bench.training)
        requests.append(Request(problem, (problem.parameters.unit(rest),)))
    answers = residuals_at(requests, bench.pool, cores)
    most = best.fit.chi_squared + GAIN * max(best.fit.chi_squared / max(best.fit.counted, 1), 1.0)
    kept = {recording: np.ones(len(w), dtype=bool) for recording, w in now.seen.items()}
    for (recording, number), (residuals,) in zip(trials, answers, strict=True):
        kept[recording][number] = float(residuals @ residuals) > most
    return replace(now, seen={recording: joined(w[kept[recording]]) for recording, w in now.seen.items()})


def _seen_beside(
    bench: Workbench,
    structure: Hypothesis,
    lost: LostWindows,
    known: dict[str, np.ndarray],
    experiments: tuple[Experiment, ...],
    cores: int,
    *,
    as_fitted: bool = False,
) -> LostWindows | None:
    """Windows that free rollouts ask for beside those of a structure; None for none."""
    now = replace(lost, seen=known)
    effects: tuple[Any, ...] = tuple(now if isinstance(c, LostWindows) else c for c in structure.effects)
    there = replace(structure, effects=effects, values={**structure.values, **now.begun()})
    own = bench.with_training(experiments)
    values = there.values if as_fitted else None
    return lost_seen(own, there, lost.input, lost.neutral, known, lost.span, cores, values)


def windows_ahead(
    bench: Workbench,
    structure: Hypothesis,
    experiment: Experiment,
    step: float,
    settings: Settings,
    cores: int,
) -> LostWindows | None:
    """Windows in a recording to which nothing else of a structure is fitted; None where it has no lost commands.

    When commands got lost is no property of the machine, so each recording has its own.

    Args:
        bench: data and problems.
        structure: fitted to other recordings, or other blocks of this one, which then tell its windows.
        experiment: the recording.
        step: of the integration [s].
        settings: of the search.
        cores: that roll out at the same time.
    """
    lost = lost_in(structure)
    if lost is None:
        return None
    which = recording_of(experiment)
    if which in lost.seen:
        return replace(lost, seen={which: lost.windows(structure.values)[which]})
    rest = _without_windows(structure)
    now = replace(lost, seen={which: NONE})
    for _ in range(settings.lost_rounds):
        more = _seen_beside(bench, structure, now, dict(now.seen), (experiment,), cores, as_fitted=True)
        if more is None:
            break
        effects: tuple[Any, ...] = tuple(more if c is lost else c for c in structure.effects)
        problem = problem_with(bench, effects, step, [experiment])
        moving = np.array([".lost." in path for path in problem.parameters.paths])
        begun = Place(problem, moving, problem.parameters.unit(rest))
        [led] = descend([begun], 12, bench.pool, cores)
        [runner] = tried_elsewhere(bench, [Runner(effects, led)], cores)
        place = runner.place
        windows = more.windows(problem.parameters.values(place.unit))
        now = replace(more, seen={which: joined(windows[which])})
    return now
