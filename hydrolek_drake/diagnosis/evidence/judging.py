"""The evidence for structures: the density of held-out data given the training data, parameters integrated out.

The training data leave a structure's parameters uncertain by a covariance S. To first order the held-out residuals r of
a structure that is right then have the covariance I + J S J', J their Jacobian, and their log-density is

    -1/2 r' (I + J S J')^-1 r - 1/2 log det (I + J S J')

(MacKay, Bayesian interpolation, Neural Computation 4, 1992). Where the parameters would have to move so far that the
first order may not hold, the structure is fitted to both data, and what both leave beyond what the training data leave
alone stands for the first term.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from hydrolek_drake.diagnosis.evidence.compared import with_differences
from hydrolek_drake.diagnosis.evidence.judged import SMALL, Judged, with_probabilities
from hydrolek_drake.diagnosis.evidence.predictive import NEARBY, OUT_OF_REACH, pays, predictive, predicts
from hydrolek_drake.diagnosis.fitting.lockstep import Place, descend, with_slopes
from hydrolek_drake.diagnosis.fitting.race import Entrant, problem_with, race
from hydrolek_drake.diagnosis.fitting.rolling import Request, residuals_at
from hydrolek_drake.diagnosis.laws.additions import LawTerm
from hydrolek_drake.diagnosis.lost_commands.search import windows_ahead
from hydrolek_drake.diagnosis.lost_commands.windows import LostWindows
from hydrolek_drake.diagnosis.search.cost import cost
from hydrolek_drake.diagnosis.search.settings import Settings
from hydrolek_drake.diagnosis.search.tried import Tried
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

MOST = 8
"""At most so many structures are judged."""


def judge_structures(
    bench: Workbench, found: Tried, held_out: Sequence[Experiment], settings: Settings, cores: int
) -> list[Judged]:
    """Structures that may be right, the most probable first.

    Args:
        bench: data and problems.
        found: structures, fitted to the training data.
        held_out: data that nothing was fitted to.
        settings: of the search.
        cores: that roll out at the same time.
    """
    contenders = _contenders(found)
    entrants = [Entrant(h.effects, h.values) for h in contenders]
    last = replace(settings.last, keep=len(contenders))
    refined = race(bench, entrants, (last,), cores)
    refined = [h for h in refined if pays(h, refined) and all(c.says_something(h.values) for c in h.effects)]
    judged = _predicted(bench, refined, held_out, last.coarse * bench.fine, settings, cores)
    return with_probabilities([j for j in judged if predicts(j, judged)])


def _contenders(found: Tried) -> list[Hypothesis]:
    """Those that may still be right, always with the nominal model and the best one less one addition."""
    best = found.best
    ranked = sorted(found.hypotheses.values(), key=cost)
    near = [h for h in ranked if 0.5 * (cost(h) - cost(best)) < max(OUT_OF_REACH, 0.05 * best.fit.objective)]
    lesser = [h for h in ranked if h.ids < best.ids and len(h.ids) == len(best.ids) - 1]
    unique = {h.ids: h for h in (best, found.baseline, *lesser, *near)}
    return list(unique.values())[:MOST]


def _predicted(
    bench: Workbench,
    hypotheses: Sequence[Hypothesis],
    held_out: Sequence[Experiment],
    step: float,
    settings: Settings,
    cores: int,
) -> list[Judged]:
    """Structures with the density of the held-out data."""
    counted = sum(experiment.counted for experiment in held_out)
    stands = stands_ahead(bench, hypotheses, held_out, step, settings, cores)
    places = []
    for own in stands:
        for experiment, (effects, unit) in zip(held_out, own, strict=True):
            problem = problem_with(bench, effects, step, [experiment])
            places.append(Place(problem, bench.movable(effects, problem.parameters), unit, exact=True))
    told = iter(with_slopes(places, bench.pool, cores))
    judged, far = [], []
    for h in hypotheses:
        some = [next(told) for _ in held_out]
        residuals = np.concatenate([place.residuals for place in some])
        slopes = np.concatenate([_of_the_machine(place, h) for place in some])
        chi_squared, spread = predictive(residuals, slopes, h.fit)
        one = Judged(h, residuals, counted, chi_squared=chi_squared, spread=spread)
        is_far = one.over_noise > SMALL or float(residuals @ residuals) - chi_squared > NEARBY
        far.append(is_far and not _own_of_recordings(h).any())
        judged.append(one)
    chosen = [i for i, is_far in enumerate(far) if is_far]
    both = [*bench.training, *held_out]
    begun = []
    for i in chosen:
        h = judged[i].hypothesis
        problem = problem_with(bench, h.effects, step, both)
        begun.append(Place(problem, bench.movable(h.effects, problem.parameters), h.fit.unit))
    for i, place in zip(chosen, descend(begun, 6, bench.pool, cores, stop=bench.alive), strict=True):
        beyond = max(place.objective - judged[i].hypothesis.fit.objective, 0.0)
        judged[i] = replace(judged[i], chi_squared=beyond)
    return judged


def left_of(
    bench: Workbench,
    judged: Sequence[Judged],
    held_out: Sequence[Experiment],
    settings: Settings,
    cores: int,
) -> tuple[Judged, ...]:
    """The same structures with what they leave of other data than those by which they were judged.

    Args:
        bench: data and problems.
        judged: structures, the most probable first.
        held_out: data that nothing was fitted to, and by which nothing was chosen.
        settings: of the search.
        cores: that roll out at the same time.
    """
    hypotheses = [j.hypothesis for j in judged]
    step = settings.last.coarse * bench.fine
    stands = stands_ahead(bench, hypotheses, held_out, step, settings, cores)
    requests = [
        Request(problem_with(bench, effects, step, [experiment]), (unit,))
        for own in stands
        for experiment, (effects, unit) in zip(held_out, own, strict=True)
    ]
    answers = iter(residuals_at(requests, bench.pool, cores))
    counted = sum(experiment.counted for experiment in held_out)
    told = tuple(
        replace(j, held_out=np.concatenate([next(answers)[0] for _ in held_out]), held_out_counted=counted)
        for j in judged
    )
    return with_differences(told, held_out)


PHASES = 12
"""Where a periodic law may stand when a recording begins is first tried at so many places."""


def _phases(hypothesis: Hypothesis) -> np.ndarray:
    """Which parameters say where a periodic law stands when a recording begins. # (n,) truth values."""
    periodic = [c for c in hypothesis.effects if isinstance(c, LawTerm) and c.term is None]
    paths = {path for c in periodic for path in (c.size_path, f"{c.path}.cosine")}
    return np.array([path in paths for path in hypothesis.values])


def _own_of_recordings(hypothesis: Hypothesis) -> np.ndarray:
    """Which parameters are no property of the machine: phases, and when commands got lost. # (n,) truth values."""
    lost = np.array([".lost." in path for path in hypothesis.values])
    return _phases(hypothesis) | lost


def _of_the_machine(place: Place, hypothesis: Hypothesis) -> np.ndarray:
    """Slopes of held-out residuals; zero for parameters that were fitted to each recording. # (values, n)."""
    assert place.slopes is not None
    columns = {path: i for i, path in enumerate(place.problem.parameters.paths)}
    own = _own_of_recordings(hypothesis)
    slopes = np.zeros((len(place.slopes), own.size))
    for i, path in enumerate(hypothesis.values):
        if not own[i]:
            slopes[:, i] = place.slopes[:, columns[path]]
    return slopes


def stands_ahead(
    bench: Workbench,
    hypotheses: Sequence[Hypothesis],
    held_out: Sequence[Experiment],
    step: float,
    settings: Settings,
    cores: int,
) -> list[list[tuple[tuple[Any, ...], np.ndarray]]]:
    """Where each structure stands in each held-out recording: as fitted, but for what is no property of the machine.

    Such are where a disturbance stands in its cycle when a recording begins, and when commands got lost.

    Returns:
        Additions and places in the unit cube of each structure, one for each recording.
    """
    stands: list[list[tuple[tuple[Any, ...], np.ndarray]]] = []
    for h in hypotheses:
        own = []
        for part in held_out:
            experiment = part.split(np.ones_like(part.used))  # a lost command moves all that comes after it
            lost = windows_ahead(bench, h, experiment, step, settings, cores)
            effects: tuple[Any, ...] = tuple(
                lost if lost is not None and isinstance(c, LostWindows) else c for c in h.effects
            )
            parameters = bench.parameters(effects)
            rest = {path: value for path, value in h.values.items() if ".lost." not in path}
            unit = parameters.unit(rest)
            phases = _phases(h)
            if phases.any():
                unit = _in_phase(bench, effects, unit, experiment, step, cores)
            own.append((effects, unit))
        stands.append(own)
    return stands


def _in_phase(
    bench: Workbench,
    effects: tuple[Any, ...],
    unit: np.ndarray,
    experiment: Experiment,
    step: float,
    cores: int,
) -> np.ndarray:
    """Where a structure with a periodic law stands in a recording, its phase fitted to it. # (n,)."""
    problem = problem_with(bench, effects, step, [experiment])
    paths = list(problem.parameters.paths)
    term = next(c for c in effects if isinstance(c, LawTerm) and c.term is None)
    sine, cosine = paths.index(term.size_path), paths.index(f"{term.path}.cosine")
    moving = np.isin(np.arange(len(paths)), (sine, cosine))
    amplitude = np.hypot(unit[sine] - 0.5, unit[cosine] - 0.5)
    begun = []
    for angle in 2.0 * np.pi * np.arange(PHASES) / PHASES:
        turned = unit.copy()
        turned[sine], turned[cosine] = 0.5 + amplitude * np.cos(angle), 0.5 + amplitude * np.sin(angle)
        begun.append(Place(problem, moving, turned))
    first = sorted(descend(begun, 0, bench.pool, cores), key=lambda place: place.objective)[:2]
    ended = descend(first, 6, bench.pool, cores, stop=bench.alive)
    return min(ended, key=lambda place: place.objective).unit
