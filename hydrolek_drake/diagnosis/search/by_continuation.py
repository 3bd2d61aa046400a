"""Structures by continuation: from observers that forget within a tenth of a second to free rollouts."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis import trace
from hydrolek_drake.diagnosis.fitting.entrants import Entrant, Runner, Start, entered
from hydrolek_drake.diagnosis.fitting.line_search import Along, searched_along
from hydrolek_drake.diagnosis.fitting.local_search import has_other_minima, searched_near
from hydrolek_drake.diagnosis.fitting.race import above_noise, hypotheses_of, run
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.search.openings import Opening, observed, surely_above
from hydrolek_drake.diagnosis.settings import FITS, NOISE, Rung
from hydrolek_drake.diagnosis.structures.addition import names_of
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.diagnosis.structures.cost import cost
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.law_terms import of_additions
from hydrolek_drake.diagnosis.structures.weighing import far_over_noise, weighted_by
from hydrolek_drake.diagnosis.structures.workbench import SPREAD, Workbench
from hydrolek_drake.identification.least_squares.lockstep import descend


def continued(bench: Workbench, opening: Opening, left: float) -> tuple[list[Runner], list[Hypothesis]]:
    """A race by continuation, from the rig's own numbers; near the noise from where the structure was fitted too.

    Slower observers are asked only for what a faster one leaves clearly less of than free rollouts do, since these
    leave no less; where they explain the data but for a little, for all.

    Args:
        bench: data and problems.
        opening: the structure and its additions.
        left: by the best free rollout, over the noise.

    Returns:
        What goes on, the best first. Where an observer followed some additions to the noise and others not, and a
        slower one none, nothing but those: one of them is right, and its fit has ended in a local minimum.
    """
    parent = opening.parent
    limit = far_over_noise(bench.training)
    far = parent.fit.over_noise > limit
    own, fitted = Start(parent.effects, opening.sizes), Start(parent.effects, parent.values)
    pulled = opening.pulled or observed(bench, parent, opening.own)[0]
    entrants = [
        begun.with_addition(p.candidate, start)
        for p in pulled[: bench.settings.entrants]
        for start in p.starts[: None if p.candidate.sudden else bench.settings.starts if far else 1]
        for begun in ((own,) if far else (own, fitted))
    ]
    heats = steps_for(bench.settings.continued, parent.fit.over_noise <= NOISE.far)
    runners = _in_time(bench, entered(bench, entrants, heats[0]))
    followed: list[Hypothesis] = []
    told_apart, weighed = False, bench.training
    for heat, taken in zip(heats, bench.settings.long, strict=False):
        begun = {r.key for r in runners}
        runners = run(bench, runners, (heat,), traced("observed")) if runners else []
        if runners and above_noise(runners[0]):  # the best one as long as it takes
            on = replace(heat, rounds=taken.rounds, share=taken.share, behind=0.0)
            runners = [*run(bench, runners[:1], (on,), traced("best")), *runners[1:]]
        # what an observer with the rig's own step leaves far from the noise is led nowhere by slower ones
        most = min(bench.settings.nearer * left, limit if heat.coarse == 1.0 else math.inf)
        if bench.settings.nearer * left > NOISE.explained:
            runners = [r for r in runners if over_noise_of(r) < most]
        runners = _decided(runners, heat)
        at_noise = [r for r in runners if not above_noise(r)]
        told_apart = told_apart or (bool(at_noise) and {r.key for r in at_noise} < begun)
        if at_noise:
            followed = hypotheses_of(bench, at_noise, heat)
        elif followed and told_apart:
            bench.training = weighed
            return [], followed
        _weigh_for_next(bench, runners, heat, heats)
    if not runners or above_noise(runners[0]):
        bench.training = weighed  # by what free rollouts led to; the weights for an observer are not theirs
    return runners, []


def _decided(runners: Sequence[Runner], rung: Rung) -> list[Runner]:
    """Those at the noise alone, once free rollouts are fitted, or a slow observer that leaves as much over all data."""
    told = math.isinf(rung.observer_s) or math.isinf(rung.seconds)
    return ([r for r in runners if not above_noise(r)] if told else []) or list(runners)


def _weigh_for_next(bench: Workbench, runners: Sequence[Runner], rung: Rung, rungs: Sequence[Rung]) -> None:
    """Weigh the data by the best structure of a rung, if it is at the noise there, as the next observer sees it.

    What the integration leaves where a joint chatters, and what a recorded pressure does between its samples, shows
    beside a structure that is nearly right, and the more the longer an observer remembers. With the data weighed as the
    nominal model far from the noise told, a right structure would leave more than noise from here on.
    """
    number = rungs.index(rung) + 1
    last = number == len(rungs)
    if not runners or above_noise(runners[0]) or (last and math.isinf(rung.observer_s)):
        return
    following = math.inf if last else rungs[number].observer_s
    [leader] = hypotheses_of(bench, runners[:1], rung)
    bench.training = tuple(weighted_by(bench, leader, bench.training, following))
    trace(f"    weighed by {names_of(leader.effects)}, observer {following} s")


def continued_nominal(bench: Workbench, direct: Hypothesis, reach: float) -> Hypothesis | None:
    """The nominal model by continuation, from the rig's own numbers, the middle of their ranges and drawn ones.

    Args:
        bench: data and problems.
        direct: as free rollouts led it.
        reach: times the noise; what an observer does not follow to it, nor to the noise, goes no further.

    Returns:
        The fit; None where no observer followed it so far.
    """
    parameters, rng = bench.parameters(()), np.random.default_rng(bench.settings.seed)
    own = parameters.unit({})
    places = [own, np.full_like(own, 0.5)]
    places += [
        np.clip(own + SPREAD * rng.standard_normal(own.size), 0.0, 1.0) for _ in range(bench.settings.drawn)
    ]
    moving = bench.movable((), parameters)
    begun = [Entrant((), parameters.values(np.where(moving, place, own))) for place in places]
    left = direct.fit.over_noise
    fits = _long_race(bench, begun, left, reach)
    if fits:
        trace(f"    nominal {left:.4f}, continued {fits[0].fit.over_noise:.4f}")
    return fits[0] if fits else None


def out_of_local_minima(bench: Workbench, fits: Sequence[Hypothesis], found: Tried) -> None:
    """Where the best structure leaves more than noise, it and the next best one are led out of a local minimum.

    By continuation; and where what has no slope, such as a play, has other minima, by fits from places near the best.

    Args:
        bench: data and problems.
        fits: where fits of several structures ended, those in different minima of one apart.
        found: receives what is better.
    """
    for each in continued_to_the_end(bench, fits, found.best):
        found.keep(each)
    best = found.best
    sudden = any(c.sudden for c in best.effects)
    if best.fit.over_noise > NOISE.at and sudden and has_other_minima(best, fits):
        found.keep(searched_near(bench, best))


def continued_to_the_end(bench: Workbench, fits: Sequence[Hypothesis], best: Hypothesis) -> list[Hypothesis]:
    """The best structures of a race, each observer's fit gone on with until no step promises anything.

    A race lets its fits take some steps of an observer only, since there are many of them. Where a joint sticks and
    slips, that is too few: the fit leaves the flat part of the valley too soon and ends in a local minimum of the next
    observer. A free rollout leaves no less than an observer, which is led by what was measured: a structure whose
    observer leaves nearly as much as the best fit so far goes no further. The slowest observer leaves nearly what a
    free rollout does: after it all go on that leave less than the best fit so far; and where a free rollout of the
    first part is at the noise, those are out that are not.

    Args:
        bench: data and problems.
        fits: where the race ended.
        best: the best structure so far.

    Returns:
        Fits that are nearer to the noise than the best one; none where this is at it.
    """
    left = best.fit.over_noise
    if left <= surely_above(bench, best):
        return []
    ranked = sorted(fits, key=cost)
    chosen = list(dict.fromkeys(each.ids for each in ranked))[: bench.settings.to_the_end]
    entrants = [
        entrant for ids in chosen for entrant in _starts(bench, [h for h in ranked if h.ids == ids], left)
    ]
    return _long_race(bench, entrants, left, left)


def _long_race(bench: Workbench, entrants: Sequence[Entrant], left: float, reach: float) -> list[Hypothesis]:
    """Fits that are continued as long as they take, but for those by which an observer shows that they lead nowhere.

    Args:
        bench: data and problems.
        entrants: where they begin.
        left: over the noise, by the best structure so far.
        reach: what leaves less over the noise goes on, and what is at the noise.
    """
    rungs, weighed = steps_for(bench.settings.long, left < NOISE.far), bench.training
    runners = _in_time(bench, entered(bench, entrants, rungs[0])) if entrants else []
    for rung in rungs:
        if runners:
            ended = run(bench, runners, (rung,), traced("to the end"))
            long = rung.coarse > 1.0  # what a long step leaves of its own tells nothing
            runners = [r for r in ended if long or over_noise_of(r) < reach or not above_noise(r)]
            runners = _decided(runners, rung)
            _weigh_for_next(bench, runners, rung, rungs)
    if bench.training is not weighed and (not runners or above_noise(runners[0])):
        bench.training = weighed
        runners = run(bench, runners, (replace(rungs[-1], rounds=0, elsewhere=False),)) if runners else []
    return hypotheses_of(bench, runners, rungs[-1])


def _starts(bench: Workbench, fits: Sequence[Hypothesis], left: float) -> list[Entrant]:
    """Where a structure is continued from: the minima in which it ended, and the rig's own numbers.

    Far from the noise also both with what was added last at each place where its search begins: a soft base rings, and
    its fit has a local minimum for every swing that its frequency is off.

    Args:
        bench: data and problems.
        fits: of the structure, the best first.
        left: over the noise, by the best structure.
    """
    best = fits[0]
    own = of_additions(best.values)
    begun = [own, *(each.values for each in fits[: bench.settings.starts])]
    last = best.effects[-1] if best.effects else None
    if isinstance(last, Candidate) and left > far_over_noise(bench.training):
        begun += [{**values, **start} for start in last.starts for values in (own, best.values)]
    return [Entrant(best.effects, values) for values in begun]


def _in_time(bench: Workbench, runners: Sequence[Runner]) -> list[Runner]:
    """The same from the dead times at which each leaves least, of some over their ranges: the rig's and an effect's.

    Where a dead time is off by more than an observer remembers, every move of the machine has passed before the model
    makes it, and no slope leads there: its fit has a local minimum for each (cycle skipping, as in waveform inversion;
    Virieux, Operto, Geophysics 74 (2009) WCC1).

    Args:
        bench: threads.
        runners: at their starts, on the rung of the fastest observer.
    """
    places = descend([r.place for r in runners], 0, bench.pool, bench.cores)
    units = (np.arange(FITS.places) + 0.5) / FITS.places
    dead_times = [
        [i for i in np.flatnonzero(p.problem.parameters.arrivals).tolist() if p.moving[i]] for p in places
    ]
    for number in range(max((len(each) for each in dead_times), default=0)):
        ways = [Along(each[number], units) if number < len(each) else None for each in dead_times]
        places = searched_along(places, ways, bench.pool, bench.cores)
    return [replace(r, place=place) for r, place in zip(runners, places, strict=True)]


def over_noise_of(runner: Runner) -> float:
    """Root mean square of what a fit leaves, over the noise."""
    return math.sqrt(runner.place.objective / max(runner.place.problem.counted, 1))


def steps_for(rungs: Sequence[Rung], fine: bool) -> tuple[Rung, ...]:
    """Rungs with the rig's own step where the error of a longer one would be more than what is to be explained."""
    return tuple(replace(rung, coarse=1.0) for rung in rungs) if fine else tuple(rungs)


def traced(name: str) -> Callable[[Sequence[Runner], Rung], None]:
    """Tells those who watch a search how the fits of a rung ended."""

    def seen(runners: Sequence[Runner], rung: Rung) -> None:
        trace(
            f"    {name} T={rung.observer_s} x{rung.coarse} {len(runners)}: "
            + ", ".join(f"{names_of(r.effects)} {over_noise_of(r):.4f}" for r in runners[:5])
        )

    return seen
