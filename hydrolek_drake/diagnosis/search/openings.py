"""One structure enlarged by one addition: what each promises, and the races of those that may be right."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.evidence.noise import AT_NOISE, FAR, MORE_AHEAD
from hydrolek_drake.diagnosis.fitting.local_search import has_other_minima, searched_near
from hydrolek_drake.diagnosis.fitting.race import (
    Entrant,
    Runner,
    Start,
    entered,
    hypotheses_of,
    problem_of,
    race,
    run,
)
from hydrolek_drake.diagnosis.laws.additions import of_additions
from hydrolek_drake.diagnosis.lost_commands.search import with_windows
from hydrolek_drake.diagnosis.lost_commands.windows import LostWindows
from hydrolek_drake.diagnosis.search.by_parts import by_parts, can_be_cut
from hydrolek_drake.diagnosis.search.gains import PROMISING, gain_needed
from hydrolek_drake.diagnosis.search.promise import Promise, promises_at
from hydrolek_drake.diagnosis.search.settings import TELLING, Rung, Settings
from hydrolek_drake.diagnosis.search.tracing import trace
from hydrolek_drake.diagnosis.search.tried import Tried
from hydrolek_drake.diagnosis.structures.addition import Addition, Sized
from hydrolek_drake.diagnosis.structures.candidates import Candidate, narrowings, redundant, widenings
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.lockstep import Place, descend


@dataclass(frozen=True)
class Opening:
    """A structure and what additions of one kind promise beside it.

    Attributes:
        parent: the structure.
        kind: "effects" or "laws".
        own: the additions.
        free: what they promise in free rollouts where the structure was fitted.
        pulled: what they promise to an observer around the rig's own numbers; empty where nobody has asked.
        sizes: full path -> value of what the structure adds to the nominal model.
        expected: cost of the structure that they promise.
        at_noise: whether that one is promised to leave no more than noise.
        lost: windows of lost commands that may be added too.
    """

    parent: Hypothesis
    kind: str
    own: tuple[Sized, ...]
    free: tuple[Promise, ...]
    pulled: tuple[Promise, ...]
    sizes: dict[str, float]
    expected: float
    at_noise: bool = False
    lost: LostWindows | None = None

    @property
    def key(self) -> tuple[frozenset[str], str]:
        """What tells it from others."""
        return self.parent.ids, self.kind

    @property
    def promising(self) -> float:
        """Largest fall of the squares that is promised, in free rollouts."""
        return self.free[0].gain if self.free else 0.0


def opened(
    bench: Workbench,
    parent: Hypothesis,
    kind: str,
    additions: Sequence[Sized | LostWindows],
    found: Tried,
    settings: Settings,
    cores: int,
    *,
    alone: bool = False,
) -> Opening:
    """See what additions promise beside a structure.

    Args:
        bench: data and problems.
        parent: the structure, fitted.
        kind: "effects" or "laws".
        additions: effects, or terms of laws.
        found: receives what effects promise.
        settings: of the search.
        cores: that roll out at the same time.
        alone: whether it is enlarged whatever others promise.
    """
    lost = next((c for c in additions if isinstance(c, LostWindows)), None)
    sized = [c for c in additions if not isinstance(c, LostWindows)]
    own = tuple(c for c in sized if c.size_path not in parent.ids and not redundant(parent.effects, c))
    sizes = of_additions(parent.values)
    if not own:
        return Opening(parent, kind, (), (), (), sizes, math.inf)
    exact = Rung(math.inf, 1.0, math.inf, 0, 1)
    place = descend([_place(bench, parent, exact, parent.fit.unit)], 0, bench.pool, cores)[0]
    free = promises_at(bench, place, parent.effects, own, TELLING * bench.fine, settings, cores)
    if kind == "effects":
        found.left = free
    pulled: list[Promise] = []
    shares = [_share(free[0].gain, parent.fit.objective, parent.fit.counted)]
    if parent.fit.over_noise > AT_NOISE and not alone:
        pulled, share = _observed(bench, parent, own, settings, cores)
        shares.append(share)
        if lost is not None:
            shares.append(lost.share)
    excess = max(parent.fit.objective - parent.fit.counted, 0.0)
    count = max(parent.fit.counted, 1)
    left = max(parent.fit.objective - max(shares) * excess, count)
    needed = gain_needed(parent.fit)
    costs = sum(c.cost for c in parent.effects) + own[0].cost
    expected = count * (1.0 + math.log(left / count)) + needed * costs
    trace(
        f"  open {kind} beside {_names(parent.effects)} {parent.fit.over_noise:.4f}, expected "
        f"{math.sqrt(left / count):.3f}: needed {needed:.0f}; free "
        + ", ".join(f"{p.candidate.id} {p.gain:.0f}" for p in free[:4])
        + "; pulled "
        + ", ".join(f"{p.candidate.id} {p.gain:.0f}" for p in pulled[:4])
    )
    at_noise = left <= AT_NOISE**2 * count
    return Opening(parent, kind, own, tuple(free), tuple(pulled), sizes, expected, at_noise, lost)


def _share(gain: float, objective: float, counted: int) -> float:
    """Which share of what is left above the noise a gain takes."""
    excess = objective - counted
    return min(gain / excess, 1.0) if excess > 0.02 * counted else 0.0


def enlarged(
    bench: Workbench,
    opening: Opening,
    candidates: Sequence[Candidate],
    found: Tried,
    settings: Settings,
    cores: int,
) -> bool:
    """Fit a structure with each of the additions that may be right, and what these lead to without others.

    Args:
        bench: data and problems.
        opening: the structure and its additions.
        candidates: all effects.
        found: receives the fits.
        settings: of the search.
        cores: that roll out at the same time.

    Returns:
        Whether the structure itself was fitted better meanwhile, and should be enlarged again.
    """
    parent = opening.parent
    needed = gain_needed(parent.fit)
    near = parent.fit.over_noise <= AT_NOISE
    enough = MORE_AHEAD if can_be_cut(bench) else AT_NOISE
    fitted, own = Start(parent.effects, parent.values), Start(parent.effects, opening.sizes)
    free = [
        fitted.with_addition(p.candidate, start)
        for number, p in enumerate(opening.free[: settings.entrants])
        if not near or p.gain > PROMISING * needed
        for start in p.starts[: None if number < settings.doubled else 1]
    ]
    free += [
        Entrant(effects, {**parent.values, **{k: v for k, v in start.items() if k not in parent.values}})
        for _, wider, effects in widenings(parent.effects, candidates)
        for start in wider.starts[:4]
    ]
    fine = parent.fit.over_noise < FAR
    heats = _steps(settings.free, fine)
    runners = run(bench, entered(bench, free, heats[0], cores), heats, cores, _traced("free")) if free else []
    better = None
    if runners and _over_noise(runners[0]) > enough:
        runners = [*_farther(bench, runners[0], settings, cores), *runners]
        if enough > AT_NOISE:
            runners = [*_by_parts(bench, runners, enough, settings, cores), *runners]
    if not near and min((_over_noise(r) for r in runners), default=math.inf) > enough:
        if not parent.effects and not found.nominal_continued:
            better = continued_nominal(bench, parent, found, settings, cores)
            if better is not None:
                found.keep(better)
        pulled = opening.pulled or _observed(bench, parent, opening.own, settings, cores)[0]
        entrants = [
            begun.with_addition(p.candidate, start)
            for p in pulled[: settings.entrants]
            for start in p.starts[: None if p.candidate.sudden else 1]
            for begun in (own, fitted)
        ]
        heats = _steps(settings.continued, fine)
        runners += run(bench, entered(bench, entrants, heats[0], cores), heats, cores, _traced("observed"))
    ended = run(bench, runners, settings.ended, cores, _traced("end")) if runners else []
    fits = hypotheses_of(bench, ended, settings.ended[-1])
    for each in fits:
        found.keep(each)
    sudden = any(c.sudden for c in found.best.effects)
    if found.best.fit.over_noise > AT_NOISE and sudden and has_other_minima(found.best, fits):
        found.keep(searched_near(bench, found.best, settings, cores))
    reached = found.best.fit.over_noise
    if opening.lost is not None and reached > AT_NOISE and opening.lost.share >= settings.lost:
        for each in with_windows(bench, parent, opening.lost, settings, cores, reached):
            found.keep(each)
    _widened(bench, found, settings, cores)
    _lessened(bench, found, candidates, settings, cores)
    return better is not None


def _farther(bench: Workbench, runner: Runner, settings: Settings, cores: int) -> list[Runner]:
    """The best structure of a race in wider ranges, where a number of what it adds lies at an end of one."""
    values = runner.place.problem.parameters.values(runner.place.unit)
    wide = tuple(c.widened(values) for c in runner.effects)
    if all(a.free == b.free for a, b in zip(wide, runner.effects, strict=True)):
        return []
    rungs = settings.free[-1:]
    return run(
        bench, entered(bench, [Entrant(wide, values)], rungs[0], cores), rungs, cores, _traced("wider")
    )


def _by_parts(
    bench: Workbench, runners: Sequence[Runner], enough: float, settings: Settings, cores: int
) -> list[Runner]:
    """Structures fitted part by part, one after the other until one leaves no more than is enough; the best first."""
    first: dict[frozenset[str], Runner] = {}
    for runner in runners:
        first.setdefault(runner.key, runner)
    ended: list[Runner] = []
    for runner in list(first.values())[: settings.parted]:
        values = runner.place.problem.parameters.values(runner.place.unit)
        parted = Entrant(runner.effects, by_parts(bench, runner.effects, values, cores))
        begun = entered(bench, [parted], settings.again, cores)
        ended += run(bench, begun, (settings.again,), cores, _traced("by parts"))
        if _over_noise(ended[-1]) <= enough:
            break
    return sorted(ended, key=_over_noise)


def _over_noise(runner: Runner) -> float:
    return math.sqrt(runner.place.objective / max(runner.place.problem.counted, 1))


def continued_nominal(
    bench: Workbench, direct: Hypothesis, found: Tried, settings: Settings, cores: int
) -> Hypothesis | None:
    """The nominal model by continuation, from the rig's own numbers and from the middle of their ranges.

    Args:
        bench: data and problems.
        direct: as free rollouts led it.
        found: remembers that it was done.
        settings: of the search.
        cores: that roll out at the same time.

    Returns:
        The fit if it is better by more than one addition must bring; else None.
    """
    found.nominal_continued = True
    centre = Entrant((), {free.path: free.from_unit(0.5) for free in bench.nominal})
    heats = settings.nominal
    led = run(bench, entered(bench, [Entrant((), {}), centre], heats[0], cores), heats, cores)
    ended = run(bench, [*led, *entered(bench, [centre], settings.again, cores)], (settings.again,), cores)
    [fitted] = hypotheses_of(bench, ended, settings.again)
    trace(f"    nominal {direct.fit.over_noise:.4f}, continued {fitted.fit.over_noise:.4f}")
    return fitted if direct.fit.objective - fitted.fit.objective > gain_needed(direct.fit) else None


def _observed(
    bench: Workbench, parent: Hypothesis, own: Sequence[Sized], settings: Settings, cores: int
) -> tuple[list[Promise], float]:
    """What additions promise to an observer around the rig's own numbers, and the share that the best one takes."""
    first = settings.continued[0]
    parameters = bench.parameters(parent.effects)
    unit = np.clip(parameters.unit(of_additions(parent.values)), 1e-6, 1.0 - 1e-6)
    near = descend([_place(bench, parent, first, unit)], 2, bench.pool, cores)[0]
    pulled = promises_at(bench, near, parent.effects, own, first.coarse * bench.fine, settings, cores)
    return pulled, _share(pulled[0].gain, near.objective, near.problem.counted)


def _place(bench: Workbench, structure: Hypothesis, rung: Rung, unit: np.ndarray) -> Place:
    problem = problem_of(bench, structure.effects, rung)
    return Place(problem, bench.movable(structure.effects, problem.parameters), unit)


def _steps(rungs: Sequence[Rung], fine: bool) -> tuple[Rung, ...]:
    """Rungs with the rig's own step where the error of a longer one would be more than what is to be explained."""
    return tuple(replace(rung, coarse=1.0) for rung in rungs) if fine else tuple(rungs)


def _lessened(
    bench: Workbench, found: Tried, candidates: Sequence[Candidate], settings: Settings, cores: int
) -> None:
    """Backward elimination: the best structure without each addition, and with a special case in its place.

    Each is fitted from where the best structure led, and by continuation.
    """
    best = found.best
    if best is found.lessened or not best.effects:
        return
    found.lessened = best
    entrants = [
        Entrant(best.without(c), {k: v for k, v in best.values.items() if not k.startswith(c.path + ".")})
        for c in best.effects
    ]
    entrants += [
        Entrant(
            effects, {**{k: v for k, v in best.values.items() if not k.startswith(c.path + ".")}, **start}
        )
        for c, special, effects in narrowings(best.effects, candidates)
        for start in special.starts[:2]
    ]
    rung = replace(settings.again, keep=len(entrants))
    fitted = race(bench, entrants, (rung,), cores)
    near = not found.nominal_continued and found.baseline.fit.over_noise < FAR
    if len(best.effects) > 1 or near:  # others were fitted so before, or are beyond doubt
        own = [Entrant(each.effects, of_additions(each.values)) for each in entrants]
        fitted += race(
            bench, own, (*_steps(settings.continued, best.fit.over_noise < FAR), settings.again), cores
        )
    for each in fitted:
        found.keep(each)


def _widened(bench: Workbench, found: Tried, settings: Settings, cores: int) -> None:
    """The best structure with wider ranges, where a number of what it adds lies at an end of one."""
    best = found.best
    wide = tuple(c.widened(best.values) for c in best.effects)
    if any(a.free != b.free for a, b in zip(wide, best.effects, strict=True)):
        for each in race(bench, [Entrant(wide, best.values)], (settings.again,), cores):
            found.keep(each)


def _names(effects: Sequence[Addition]) -> str:
    return "+".join(c.id for c in effects) or "nominal"


def _traced(name: str) -> Callable[[Sequence[Runner], Rung], None]:
    def seen(runners: Sequence[Runner], rung: Rung) -> None:
        trace(
            f"    {name} T={rung.observer_s} x{rung.coarse} {len(runners)}: "
            + ", ".join(
                f"{_names(r.effects)} {math.sqrt(r.place.objective / r.place.problem.counted):.4f}"
                for r in runners[:5]
            )
        )

    return seen
