"""The nominal model, from which a search begins."""

from dataclasses import replace

from hydrolek_drake.diagnosis import trace
from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.longest_step import no_longer_than_borne
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.search.by_continuation import continued_nominal, out_of_local_minima
from hydrolek_drake.diagnosis.search.weighed_anew import as_weighed, told_anew
from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.diagnosis.structures.cost import gain_needed
from hydrolek_drake.diagnosis.structures.weighing import far_over_noise, weighted_by
from hydrolek_drake.diagnosis.structures.workbench import Workbench


def fit_nominal(bench: Workbench, found: Tried) -> None:
    """The nominal model by free rollouts from the rig's own numbers; or where a search goes on, what that one found.

    Nothing is below the noise, so that a fit that reaches it needs no other starts. Where it does not, the model is
    fitted by continuation too.
    """
    if found.seeds:
        _go_on(bench, found)
        return
    no_longer_than_borne(bench, (), {})
    rungs = (*bench.settings.free, bench.settings.ended[0])
    best = as_weighed(bench, race(bench, [Entrant((), {})], rungs)[0])
    trace(f"nominal {best.fit.over_noise:.4f}")
    if best.fit.over_noise > NOISE.at:
        left = best.fit.over_noise
        # far from it no further than to an observer that surely leaves more than noise: something is missing then
        reach = left if left <= far_over_noise(bench.training) else NOISE.above
        weighed = bench.training
        better = continued_nominal(bench, best, reach)
        if bench.training is not weighed:
            [best] = told_anew(bench, [best])
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
        rung = replace(bench.settings.again, keep=len(without))
        for each in race(bench, without, (rung,), goal=best.fit.objective):
            found.keep(each)
    if found.best.effects:  # where a fit to other data ended is another local minimum of it, so both are told
        out_of_local_minima(bench, [*fits, *found.seeds], found)
