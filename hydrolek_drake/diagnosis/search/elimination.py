"""The best structure without each of its additions (backward elimination), or with others instead (exchange)."""

from collections.abc import Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis.fitting.entrants import Entrant, entered
from hydrolek_drake.diagnosis.fitting.promise import promises_at
from hydrolek_drake.diagnosis.fitting.race import above_noise, hypotheses_of, race, run
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.search.by_continuation import steps_for, traced
from hydrolek_drake.diagnosis.search.standing_in import standing_in
from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.diagnosis.structures.candidates import Candidate, narrowings, redundant
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm, of_additions
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.least_squares.lockstep import descend


def without_each(bench: Workbench, found: Tried, candidates: Sequence[Candidate]) -> None:
    """Backward elimination: the best structure without each addition, and with what may do as well in its place.

    What may do as well is a number of its stage (`standing_in`); a special case; for the forces of a law the same on
    the other side of the linkage; and for a law the effects that promise most without it, since it may describe one of
    them that was fitted in a wrong local minimum. Each is fitted from where the best structure led, and by
    continuation; where the best one is at the noise, as long as an observer follows them to it, since a free rollout
    leaves no less.

    Args:
        bench: data and problems.
        found: holds the best structure, and receives the fits.
        candidates: all effects.
    """
    best = found.best
    if best is found.lessened or not best.effects:
        return
    found.lessened = best
    entrants = [Entrant(best.without(c), best.values_without(c)) for c in best.effects]
    alone = zip(best.effects, tuple(entrants), strict=True)
    entrants += [each for c, without in alone for each in standing_in(bench, without, c)]
    entrants += [
        Entrant(effects, {**best.values_without(c), **start})
        for c, special, effects in narrowings(best.effects, candidates)
        for start in special.starts[: bench.settings.starts]
    ]
    entrants += _across(best)
    entrants += _named_in_place(bench, best, candidates)
    rung = replace(bench.settings.again, keep=len(entrants))
    fitted = race(bench, entrants, (rung,), goal=best.fit.objective)
    if len(best.effects) > 1:  # the nominal model was fitted so before
        own = [Entrant(each.effects, of_additions(each.values)) for each in entrants]
        rungs = (*steps_for(bench.settings.continued, best.fit.over_noise < NOISE.far), bench.settings.again)
        runners = entered(bench, own, rungs[0])
        for step in rungs:
            runners = run(bench, runners, (step,), traced("without"))
            if best.fit.over_noise <= NOISE.above:
                runners = [r for r in runners if not (r.place.ended and above_noise(r))]
        fitted += hypotheses_of(bench, runners, rungs[-1])
    for each in fitted:
        found.keep(each)


def _named_in_place(
    bench: Workbench, structure: Hypothesis, candidates: Sequence[Candidate]
) -> list[Entrant]:
    """The same structure with an effect in place of its law: those that promise most where it ended, without the law.

    There its own numbers are not bent by what is missing, so that an effect of another stage shows too which does the
    same, as a shifted null does what a further voltage before the amplifier does.
    """
    law = [c for c in structure.effects if isinstance(c, LawTerm)]
    rest = tuple(c for c in structure.effects if c not in law)
    own = [c for c in candidates if c.size_path not in structure.ids and not redundant(rest, c)]
    if not law or not own:
        return []
    values = structure.values_without(*law)
    [without] = entered(bench, [Entrant(rest, values)], bench.settings.again)
    [place] = descend([without.place], 0, bench.pool, bench.cores)
    promises = promises_at(bench, place, rest, own)
    return [
        Entrant((*rest, p.candidate), {**values, **start})
        for p in promises[: bench.settings.in_place]
        for start in p.starts[: bench.settings.starts]
    ]


def _across(structure: Hypothesis) -> list[Entrant]:
    """The same structure with the forces of its law on the other side of the linkage, which may do as well."""
    forces = [c for c in structure.effects if isinstance(c, LawTerm)]
    moved = [found for c in forces if (found := c.moved_across(structure.values)) is not None]
    if not moved or len(moved) < len(forces):
        return []
    rest = tuple(c for c in structure.effects if c not in forces)
    values = structure.values_without(*forces)
    for _, told in moved:
        values |= told
    return [Entrant((*rest, *(term for term, _ in moved)), values)]
