"""Best-first search among structures: the most evident one is enlarged until nothing more is promised."""

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis.candidates import Candidate, redundant, widenings
from hydrolek_drake.diagnosis.effort import ABOVE_NOISE, AT_NOISE, FAR
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.fitting.lockstep import Place, descend
from hydrolek_drake.diagnosis.gains import PROMISING, cost_of, gain_needed
from hydrolek_drake.diagnosis.structures.promise import Promise, promises_at
from hydrolek_drake.diagnosis.structures.race import (
    Entrant,
    Runner,
    hypothesis_of,
    problem_of,
    race,
)
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm
from hydrolek_drake.diagnosis.structures.settings import Rung, Settings
from hydrolek_drake.diagnosis.weighing import weighted_by
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench

def TRACE(text):
    if os.environ.get("HYDROLEK_TRACE"):
        try:
            import count; n=count.C['in tables']; m=count.C['alone']
        except ImportError: n=m=0
        print(f"[{n}+{m}] {text}", flush=True)


def search_structures(
    bench: Workbench,
    candidates: Sequence[Candidate],
    found: Search,
    say: Callable[[str], None],
    settings: Settings,
    cores: int,
    terms: Callable[[Workbench, Hypothesis], Sequence[LawTerm]] | None = None,
) -> None:
    """Fill what is found.

    Args:
        bench: data and problems; its training data are weighed anew by what is found.
        candidates: every effect that may be missing.
        found: receives what was tried.
        say: told what is being done.
        settings: of the search.
        cores: that roll out at the same time.
        terms: of laws that may be beside a structure; None for none.
    """
    say("fitting the nominal model")
    _nominal(bench, found, settings, cores)
    done: set[tuple[frozenset[str], str]] = set()
    for _ in range(settings.most_expansions):
        item = _next(found, done, settings, laws=terms is not None)
        if item is None:
            break
        parent, kind = item
        done.add((parent.ids, kind))
        if kind == "effects":
            _enlarged(bench, parent, candidates, found, say, settings, cores)
        elif terms is not None:
            own = [t for t in terms(bench, parent) if _same_law(parent, t)]
            _enlarged(bench, parent, own, found, say, settings, cores)
        _weigh(bench, found, settings, cores)


def _next(
    found: Search, done: set[tuple[frozenset[str], str]], settings: Settings, *, laws: bool
) -> tuple[Hypothesis, str] | None:
    """The structure that is enlarged next, and by what; None if nothing is open any more."""
    best = found.best
    if best.fit.over_noise <= ABOVE_NOISE:
        kind = "laws" if any(isinstance(c, LawTerm) for c in best.effects) else "effects"
        return None if (best.ids, kind) in done else (best, kind)
    items = []
    sizes: dict[int, int] = {}
    for h in sorted(found.hypotheses.values(), key=cost_of):
        count = len(h.effects)
        sizes[count] = sizes.get(count, 0) + 1
        if count >= settings.most_additions or sizes[count] > settings.beam:
            continue
        lawful = any(isinstance(c, LawTerm) for c in h.effects)
        paying = h is found.baseline or cost_of(h) < cost_of(found.baseline)
        if not paying:
            continue
        if not lawful:
            items.append((cost_of(h), h, "effects"))
        if laws:
            items.append((cost_of(h) + LawTerm.cost * gain_needed(h.fit), h, "laws"))
    items = [item for item in items if (item[1].ids, item[2]) not in done]
    return min(items, key=lambda item: item[0])[1:] if items else None


def _same_law(parent: Hypothesis, term: LawTerm) -> bool:
    """Whether a term may be added: a law of a structure stands at one input."""
    return all(c.input.probe == term.input.probe for c in parent.effects if isinstance(c, LawTerm))


def _place_of(bench: Workbench, hypothesis: Hypothesis, rung: Rung) -> Place:
    problem = problem_of(bench, hypothesis.effects, rung)
    moving = bench.movable(hypothesis.effects, problem.parameters)
    return Place(problem, moving, hypothesis.fit.unit)


def _nominal(bench: Workbench, found: Search, settings: Settings, cores: int) -> None:
    centre = {free.path: free.from_unit(0.5) for free in bench.nominal}
    starts = [Entrant((), {}), Entrant((), centre)]
    led = race(bench, starts, settings.nominal, cores)
    last = settings.nominal[-1]
    entrants = [Entrant((), led[0].values), *starts]
    best = race(bench, entrants, (last,), cores)[0]
    bench.training = tuple(weighted_by(bench, best, bench.training))
    best = race(bench, [Entrant((), best.values)], (replace(last, rounds=12),), cores)[0]
    TRACE(f"nominal {best.fit.over_noise:.4f}")
    found.keep(best)
    found.weighed_at = best.fit.over_noise


def _may_be_added(parent: Hypothesis, candidate: Candidate) -> bool:
    return candidate.size_path not in parent.ids and not redundant(parent.effects, candidate)


def _enlarged(
    bench: Workbench,
    parent: Hypothesis,
    candidates: Sequence[Candidate],
    found: Search,
    say: Callable[[str], None],
    settings: Settings,
    cores: int,
) -> bool:
    """Fit a structure with one addition more; whether anything was promised."""
    exact = Rung(math.inf, 1.0, math.inf, 0, 1)
    place = descend([_place_of(bench, parent, exact)], 0, bench.pool, cores)[0]
    own = [c for c in candidates if _may_be_added(parent, c)]
    coarse = 1.0 if parent.fit.over_noise < FAR else 2.0
    promised = promises_at(bench, place, parent.effects, own, coarse * bench.fine, settings, cores)
    if not own:
        return False
    if not parent.effects and isinstance(own[0], Candidate):
        found.scores = [p.score for p in promised]
    found.left = [p.score for p in promised]
    needed = gain_needed(parent.fit)
    promising = promised[0].gain if promised else 0.0
    TRACE(
        f"  beside {sorted(parent.ids)} {parent.fit.over_noise:.4f}: needed {needed:.0f} "
        + ", ".join(f"{p.candidate.id} {p.gain:.0f}" for p in promised[:5])
    )
    if promising < PROMISING * needed and parent.fit.over_noise <= ABOVE_NOISE:
        return False
    say(f"adding to {' + '.join(c.id for c in parent.effects) or 'the nominal model'}")
    # those for which nothing speaks from where the parent led may be seen from the rig's own numbers
    near = parent.fit.over_noise <= ABOVE_NOISE
    free = [
        Entrant((*parent.effects, p.candidate), {**parent.values, **start}, parent)
        for number, p in enumerate(promised[: settings.entrants])
        if not near or p.gain > PROMISING * needed
        for start in p.starts[: settings.starts if number < settings.doubled else 1]
    ]
    free += [
        Entrant(effects, {**parent.values, **{k: v for k, v in start.items() if k not in parent.values}})
        for _, wider, effects in widenings(parent.effects, candidates)
        for start in wider.starts[:4]
    ]
    fine = parent.fit.over_noise < FAR
    ended = race(bench, free, _steps(settings.free, fine), cores, _traced("free"))
    reached = min([parent, *ended], key=lambda h: h.fit.objective).fit.over_noise
    if reached > AT_NOISE:
        entrants = _continued(bench, parent, own, settings, cores)
        ended += race(bench, entrants, _steps(settings.continued, fine), cores, _traced("cont"))
    for each in ended:
        found.keep(each)
    _lessened(bench, found, settings, cores)
    return True


def _steps(rungs: Sequence[Rung], fine: bool) -> tuple[Rung, ...]:
    """Rungs with the rig's own step where the error of a longer one would be more than what is to be explained."""
    return tuple(replace(rung, coarse=1.0) for rung in rungs) if fine else tuple(rungs)


def _continued(
    bench: Workbench, parent: Hypothesis, own: Sequence[Candidate], settings: Settings, cores: int
) -> list[Entrant]:
    """Starts from the rig's own numbers, with additions as an observer's prediction errors ask for them."""
    first = settings.continued[0]
    effects = parent.effects
    sizes = {p: v for p, v in parent.values.items() if ".effects." in p}
    problem = problem_of(bench, effects, first)
    moving = bench.movable(effects, problem.parameters)
    begun = Place(problem, moving, problem.parameters.unit(sizes))
    place = descend([begun], 2, bench.pool, cores)[0]
    promised = promises_at(bench, place, effects, own, first.coarse * bench.fine, settings, cores)
    TRACE("  pulled: " + ", ".join(f"{p.candidate.id} {p.gain:.0f}" for p in promised[:5]))
    return [Entrant((*effects, p.candidate), {**sizes, **start}) for p in promised[: settings.entrants] for start in p.starts[:1]]


def _lessened(bench: Workbench, found: Search, settings: Settings, cores: int) -> None:
    """Backward elimination: the best structure without each of its additions, from where it led."""
    best = found.best
    entrants = [
        Entrant(best.without(c), {k: v for k, v in best.values.items() if not k.startswith(c.path + ".")})
        for c in best.effects
    ]
    for each in race(bench, entrants, settings.free[-1:], cores) if entrants else ():
        found.keep(each)


def _weigh(bench: Workbench, found: Search, settings: Settings, cores: int) -> None:
    """Weigh the data by the best structure, and fit what is near it again."""
    best = found.best
    if best.fit.over_noise > settings.nearer * found.weighed_at:
        return
    bench.training = tuple(weighted_by(bench, best, bench.training))
    ranked = sorted(found.hypotheses.values(), key=lambda h: h.fit.objective)
    near = [h for h in ranked if h.fit.objective < 4.0 * best.fit.objective][:6]
    chosen = {h.ids: h for h in (found.baseline, *near)}
    again = race(
        bench,
        [Entrant(h.effects, h.values) for h in chosen.values()],
        (replace(settings.free[-1], keep=len(chosen)),),
        cores,
    )
    found.given_up.update(found.hypotheses)
    found.hypotheses.clear()
    for each in again:
        found.keep(each)
    found.weighed_at = found.best.fit.over_noise
    TRACE("  weighed: " + ", ".join(f"{sorted(i.split('.')[-2] for i in h.ids)} {h.fit.over_noise:.4f}" for h in sorted(again, key=cost_of)[:5]))


def _traced(name: str) -> Callable[[Sequence[Runner], Rung], None]:
    def seen(runners: Sequence[Runner], rung: Rung) -> None:
        ranked = sorted(runners, key=lambda r: r.place.objective)[:5]
        TRACE(
            f"    {name} T={rung.observer_s} x{rung.coarse} {len(runners)}: "
            + ", ".join(
                f"{'+'.join(c.id for c in r.effects)} {math.sqrt(r.place.objective / r.place.problem.counted):.4f}"
                for r in ranked
            )
        )

    return seen
