"""The nominal model, from which a search begins, and data that are weighed by what they are fitted with."""

from dataclasses import replace

from hydrolek_drake.diagnosis import trace
from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.search.by_continuation import continued_nominal, out_of_local_minima
from hydrolek_drake.diagnosis.search.cost import cost, gain_needed
from hydrolek_drake.diagnosis.search.tried import Tried
from hydrolek_drake.diagnosis.settings import FITS, NOISE
from hydrolek_drake.diagnosis.structures.weighing import weighted_by
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench


def fit_nominal(bench: Workbench, found: Tried) -> None:
    """The nominal model by free rollouts from the rig's own numbers; or where a search goes on, what that one found.

    Nothing is below the noise, so that a fit that reaches it needs no other starts. Where it does not, the model is
    fitted by continuation too.
    """
    if found.seeds:
        _go_on(bench, found)
        return
    rungs = (*bench.settings.free, bench.settings.ended[0])
    best = as_weighed(bench, race(bench, [Entrant((), {})], rungs)[0])
    trace(f"nominal {best.fit.over_noise:.4f}")
    if best.fit.over_noise > NOISE.at:
        left = best.fit.over_noise
        # far from it no further than to an observer that surely leaves more than noise: something is missing then
        reach = left if left <= NOISE.far else NOISE.above
        better = continued_nominal(bench, best, reach)
        if better is not None and best.fit.objective - better.fit.objective > gain_needed(best.fit):
            best = as_weighed(bench, better)
    found.keep(best)
    found.weighed_at = best.fit.over_noise


def _go_on(bench: Workbench, found: Tried) -> None:
    """Structures that were fitted to other data, the nominal model among them, the data weighed by the best one."""
    first = min(found.seeds, key=lambda h: h.fit.over_noise)
    bench.training = tuple(weighted_by(bench, first, bench.training))
    rung = replace(bench.settings.again, keep=len(found.seeds))
    fits = race(bench, [Entrant(h.effects, h.values) for h in found.seeds], (rung,))
    for each in fits:
        found.keep(each)
    best = found.best  # what it contains may only have been fitted in another local minimum
    trace(f"nominal {found.baseline.fit.over_noise:.4f}, best {best.fit.over_noise:.4f}")
    found.weighed_at = best.fit.over_noise
    without = [Entrant(best.without(c), best.values_without(c)) for c in best.effects]
    if without:
        for each in race(bench, without, (replace(bench.settings.again, keep=len(without)),)):
            found.keep(each)
    if found.best.effects:  # where a fit to other data ended is another local minimum of it, so both are told
        out_of_local_minima(bench, [*fits, *found.seeds], found)


def as_weighed(bench: Workbench, structure: Hypothesis) -> Hypothesis:
    """A structure fitted on, the data weighed by it; again where its noise fell, since a worse fit had told it."""
    now = structure
    for _ in range(FITS.anew):
        bench.training = tuple(weighted_by(bench, now, bench.training))
        rung = bench.settings.again if now.fit.over_noise <= NOISE.above else bench.settings.led
        before, now = now, race(bench, [Entrant(now.effects, now.values)], (rung,))[0]
        if now.fit.over_noise > 1.0 / NOISE.at or now.fit.over_noise < NOISE.at * before.fit.over_noise:
            break
    return now


def weigh_anew(bench: Workbench, found: Tried) -> None:
    """Weigh the data by the best structure where it tells their noise better, and fit what is near it again.

    Args:
        bench: data and problems.
        found: receives the fits; those that are not near it are given up.
    """
    best = found.best
    if best.fit.over_noise > bench.settings.nearer * found.weighed_at:
        return
    bench.training = tuple(weighted_by(bench, best, bench.training))
    bench.progress.anew()
    ranked = sorted(found.hypotheses.values(), key=lambda h: h.fit.objective)
    within = bench.settings.again_within**2 * best.fit.objective
    near = [h for h in ranked if h.fit.objective < within][: bench.settings.most_again]
    again = race(
        bench,
        [Entrant(h.effects, h.values) for h in near],
        (replace(bench.settings.again, keep=len(near)),),
    )
    if all(h.effects for h in near):  # the nominal model lies far behind, and is told beside the others only
        again += race(bench, [Entrant((), found.baseline.values)], (bench.settings.led,))
    found.given_up.update(found.hypotheses)
    found.hypotheses.clear()
    for each in again:
        found.keep(each)
    found.weighed_at = found.best.fit.over_noise
    trace(
        "  weighed: "
        + ", ".join(
            f"{[c.id for c in h.effects]} {h.fit.over_noise:.4f}" for h in sorted(again, key=cost)[:4]
        )
    )
