"""A structure enlarged by one addition: the races of those that may be right, and what these lead to without others."""

import math
from collections.abc import Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis.fitting.entrants import Entrant, Runner, Start, entered
from hydrolek_drake.diagnosis.fitting.parts import supply_before
from hydrolek_drake.diagnosis.fitting.race import hypotheses_of, race, run
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.lost_commands.search import with_windows
from hydrolek_drake.diagnosis.search.by_continuation import (
    continued,
    continued_to_the_end,
    out_of_local_minima,
    over_noise_of,
    steps_for,
    traced,
)
from hydrolek_drake.diagnosis.search.elimination import without_each
from hydrolek_drake.diagnosis.search.openings import Opening
from hydrolek_drake.diagnosis.search.weighed_anew import weigh_anew
from hydrolek_drake.diagnosis.settings import GAINS, NOISE
from hydrolek_drake.diagnosis.structures.candidates import Candidate, widenings
from hydrolek_drake.diagnosis.structures.cost import gain_needed
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench


def enlarged(bench: Workbench, opening: Opening, candidates: Sequence[Candidate], found: Tried) -> None:
    """Fit a structure with each of the additions that may be right, and what these lead to without others.

    Args:
        bench: data and problems.
        opening: the structure and its additions.
        candidates: all effects.
        found: receives the fits.
    """
    parent = opening.parent
    ended = _raced(bench, opening, candidates, found)
    fits = hypotheses_of(bench, ended, bench.settings.ended[-1])
    for each in fits:
        found.keep(each)
    out_of_local_minima(bench, fits, found)
    reached = found.best.fit.over_noise
    if opening.lost is not None and reached > NOISE.at and opening.lost.share >= bench.settings.lost:
        for each in with_windows(bench, parent, opening.lost, reached):
            found.keep(each)
    _widened(bench, found)
    without_each(bench, found, candidates)


def _raced(bench: Workbench, opening: Opening, candidates: Sequence[Candidate], found: Tried) -> list[Runner]:
    """Fits at the end of the races; the second one is run where the first does not lead to the noise.

    Near the noise promises hold, and free rollouts lead from where the structure was fitted. Far from it its numbers
    are bent, and observers come first. What is much better than all before tells the noise better, and how much the
    integration leaves where a joint chatters: it is fitted again with the data so weighed before anything else is.
    """
    parent, enough = opening.parent, opening.enough
    reached, runners, ended = math.inf, list[Runner](), list[Runner]()
    far = parent.fit.over_noise > opening.far
    for by_observers in (True, False) if far else (False, True):
        if reached <= enough:
            break
        if by_observers:
            ended, rest, followed = _by_observers(bench, opening, min(reached, parent.fit.over_noise))
            for each in continued_to_the_end(bench, followed, parent) if followed else []:
                found.keep(each)
            if followed and found.best.fit.over_noise <= enough:
                return _ended(bench, runners, [], enough)
            first = ended
        else:
            first = rest = _freely(bench, opening, candidates)
        reached = min((over_noise_of(r) for r in first), default=math.inf)
        runners += rest
        if enough < reached < bench.settings.nearer * found.weighed_at:
            for each in hypotheses_of(bench, first, bench.settings.ended[-1]):
                found.keep(each)
            weigh_anew(bench, found)
            reached, ended = found.best.fit.over_noise, []
    return _ended(bench, runners, ended, enough)


def _by_observers(
    bench: Workbench, opening: Opening, left: float
) -> tuple[list[Runner], list[Runner], list[Hypothesis]]:
    """A race by continuation: the best, fitted to its end, the rest, and what `continued` is to be gone on with."""
    if opening.parent.fit.over_noise <= opening.enough:
        return [], [], []
    runners, followed = continued(bench, opening, left)
    return run(bench, runners[:1], bench.settings.ended, traced("first to the end")), runners[1:], followed


def _freely(bench: Workbench, opening: Opening, candidates: Sequence[Candidate]) -> list[Runner]:
    """A race of free rollouts, the best one fitted to its end where it leaves more than noise."""
    enough = opening.enough
    runners = _led_on(bench, opening, candidates)
    if runners and over_noise_of(runners[0]) > enough:
        runners = [*_farther(bench, runners[0]), *runners]
    if runners and bench.cut and bench.follows_supply and opening.parent.fit.over_noise > enough:
        runners = sorted([*_with_supply(bench, runners, NOISE.explained), *runners], key=over_noise_of)
    if runners and over_noise_of(runners[0]) > enough and not runners[0].place.ended:
        runners = [*run(bench, runners[:1], bench.settings.ended, traced("first to the end")), *runners[1:]]
    return runners


def _ended(
    bench: Workbench, runners: Sequence[Runner], ended: Sequence[Runner], enough: float
) -> list[Runner]:
    """The end of the races; to the last square only what is at the noise, or not clearly behind what is.

    Args:
        bench: data and problems.
        runners: still to be fitted to their end.
        ended: fitted so already.
        enough: times the noise that need not be explained.
    """
    first, last = bench.settings.ended
    goal = min((r.place.objective for r in ended), default=math.inf)
    now = run(bench, runners, (first,), traced("end"), goal) if runners else []
    best = min((over_noise_of(r) for r in (*ended, *now)), default=math.inf)
    if best > enough:
        return [*ended, *now]
    reach = best / bench.settings.nearer
    near = [r for r in now if over_noise_of(r) <= reach]
    behind = [r for r in now if over_noise_of(r) > reach]
    return [*ended, *(run(bench, near, (last,), traced("end"), goal) if near else []), *behind]


def _led_on(bench: Workbench, opening: Opening, candidates: Sequence[Candidate]) -> list[Runner]:
    """A race of free rollouts from where the structure was fitted, the best first."""
    parent = opening.parent
    begun, needed = Start(parent.effects, parent.values), gain_needed(parent.fit)
    near = parent.fit.over_noise <= opening.enough  # promises hold there
    entrants = [
        begun.with_addition(p.candidate, start)
        for number, p in enumerate(opening.free[: bench.settings.entrants])
        if not near or p.gain > GAINS.promising * needed
        for start in p.starts[: None if number < bench.settings.doubled else 1]
    ]
    entrants += [
        Entrant(effects, {**parent.values, **{k: v for k, v in start.items() if k not in parent.values}})
        for _, wider, effects in widenings(parent.effects, candidates)
        for start in wider.starts[: bench.settings.scanned]
    ]
    if not entrants:
        return []
    heats = steps_for(bench.settings.free, parent.fit.over_noise < NOISE.far)
    return run(bench, entered(bench, entrants, heats[0]), heats, traced("free"))


def _farther(bench: Workbench, runner: Runner) -> list[Runner]:
    """The best structure of a race in wider ranges, where a number of what it adds lies at an end of one."""
    values = runner.place.problem.parameters.values(runner.place.unit)
    wide = tuple(c.widened(values) for c in runner.effects)
    if all(a.free == b.free for a, b in zip(wide, runner.effects, strict=True)):
        return []
    rungs = bench.settings.free[-1:]
    return run(bench, entered(bench, [Entrant(wide, values)], rungs[0]), rungs, traced("wider"))


def _with_supply(bench: Workbench, runners: Sequence[Runner], enough: float) -> list[Runner]:
    """Structures whose supply is found anew, one after the other until one leaves no more than is enough."""
    first: dict[frozenset[str], Runner] = {}
    for runner in runners:
        if over_noise_of(runner) <= NOISE.far * over_noise_of(runners[0]):
            first.setdefault(runner.key, runner)
    ended: list[Runner] = []
    for runner in list(first.values())[: bench.settings.supplied]:
        values = runner.place.problem.parameters.values(runner.place.unit)
        places = supply_before(bench, runner.effects, values, [])
        anew = [Entrant(runner.effects, {**values, **supply}) for supply in places]
        rung = replace(bench.settings.again, keep=1)
        ended += run(bench, entered(bench, anew, rung), (rung,), traced("supply"))
        if over_noise_of(ended[-1]) <= enough:
            break
    return ended


def _widened(bench: Workbench, found: Tried) -> None:
    """The best structure with wider ranges, where a number of what it adds lies at an end of one."""
    best = found.best
    wide = tuple(c.widened(best.values) for c in best.effects)
    if any(a.free != b.free for a, b in zip(wide, best.effects, strict=True)):
        for each in race(bench, [Entrant(wide, best.values)], (bench.settings.again,)):
            found.keep(each)
