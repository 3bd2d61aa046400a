"""The nominal model, from which a search begins, and data that are weighed by what they are fitted with."""

from dataclasses import replace

from hydrolek_drake.diagnosis import trace
from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.search.by_continuation import continued_nominal, out_of_local_minima
from hydrolek_drake.diagnosis.search.by_parts import by_parts, can_be_cut
from hydrolek_drake.diagnosis.search.tried import Tried
from hydrolek_drake.diagnosis.settings import FITS, NOISE, Settings
from hydrolek_drake.diagnosis.structures.weighing import weighted_by
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench


def fit_nominal(bench: Workbench, found: Tried, settings: Settings, cores: int) -> None:
    """The nominal model by free rollouts from the rig's own numbers.

    Nothing is below the noise, so that a fit that reaches it needs no other starts. Where one is near it, so that
    what is missing is small beside what a wrong local minimum leaves, it is fitted by continuation too; where it is
    far, only if no addition to it reaches the noise (`openings`). Where a pump's pressure was recorded it is fitted
    part by part instead: a line that rings has many local minima.
    """
    known = next((h.values for h in found.seeds if not h.effects), {})
    if not known and can_be_cut(bench):
        known = by_parts(bench, (), {}, cores)
    rungs = (settings.led,) if known else (*settings.free, settings.ended[0])
    best = as_weighed(bench, race(bench, [Entrant((), known)], rungs, cores)[0], settings, cores)
    trace(f"nominal {best.fit.over_noise:.4f}")
    if not known and NOISE.at < best.fit.over_noise < NOISE.far:
        better = continued_nominal(bench, best, found, settings, cores)
        best = best if better is None else as_weighed(bench, better, settings, cores)
    found.nominal_continued = found.nominal_continued or bool(known)
    found.keep(best)
    found.weighed_at = best.fit.over_noise
    if found.seeds:
        rung = replace(settings.again, keep=len(found.seeds))
        fits = race(bench, [Entrant(h.effects, h.values) for h in found.seeds], (rung,), cores)
        for each in fits:
            found.keep(each)
        best = found.best  # what it contains may only have been fitted in another local minimum
        without = [Entrant(best.without(c), best.values_without(c)) for c in best.effects]
        if without:
            for each in race(bench, without, (replace(settings.again, keep=len(without)),), cores):
                found.keep(each)
        if (
            found.best.effects
        ):  # where a fit to other data ended is another local minimum of it, so both are told
            out_of_local_minima(bench, [*fits, *found.seeds], found, settings, cores)


def as_weighed(bench: Workbench, structure: Hypothesis, settings: Settings, cores: int) -> Hypothesis:
    """A structure fitted on, the data weighed by it; again where its noise fell, since a worse fit had told it."""
    now = structure
    for _ in range(FITS.anew):
        bench.training = tuple(weighted_by(bench, now, bench.training))
        rung = settings.again if now.fit.over_noise <= NOISE.above else settings.led
        before, now = now, race(bench, [Entrant(now.effects, now.values)], (rung,), cores)[0]
        if now.fit.over_noise > 1.0 / NOISE.at or now.fit.over_noise < NOISE.at * before.fit.over_noise:
            break
    return now
