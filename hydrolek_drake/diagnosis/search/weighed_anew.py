"""Data that are weighed anew by what they are fitted with: a better structure tells their noise better."""

from collections.abc import Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis import trace
from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.settings import FITS, NOISE
from hydrolek_drake.diagnosis.structures.cost import cost
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.weighing import weighted_by
from hydrolek_drake.diagnosis.structures.workbench import Workbench


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


def told_anew(bench: Workbench, fits: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The same fits, what they leave told with the present weights of the data, the best first."""
    rung = replace(bench.settings.again, rounds=0, keep=len(fits), each=len(fits))
    return race(bench, [Entrant(h.effects, h.values) for h in fits], (rung,)) if fits else []


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
    # a continuation may have weighed the data since some of them were fitted
    ranked = told_anew(bench, list(found.hypotheses.values()))
    within = bench.settings.again_within**2 * ranked[0].fit.objective
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
