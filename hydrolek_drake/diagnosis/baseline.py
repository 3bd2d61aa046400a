"""The nominal model, fitted: what every improvement is counted over.

A healthy machine must reach the noise here, or an effect would be called missing that only leads the fit out of a
hollow.
"""

from collections.abc import Sequence

from hydrolek_drake.diagnosis.effort import AT_NOISE, COARSE, FALLING, FAR, LOOK, POLISH
from hydrolek_drake.diagnosis.pulled_fits import fit_pulled
from hydrolek_drake.diagnosis.weighing import settled
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench

MOST_ROUNDS = 8
"""Of a fit, as long as each takes `FALLING` of what is left."""

AWAY = 0.1
"""The middle of the ranges is a start of its own if a parameter's own value is so far from it, in ranges."""


def fit_baseline(bench: Workbench) -> Hypothesis:
    """The nominal model, fitted to the training data, which are weighted by what it leaves.

    Args:
        bench: its training data are replaced, see `weighing.settled`.
    """
    starts = _starts(bench)
    free = _lowest(bench, settled(bench, _fitted_freely(bench, starts)))
    if free.fit.over_noise <= AT_NOISE:
        return free
    # from the rig's own values again: where the free fit got stuck, pulled rollouts mostly get stuck too; which of
    # their fits leads out of the hollow shows only without the pull
    pulled = bench.side_by_side(
        lambda start: fit_pulled(bench, (), [start], bench.fine, bench.training), starts
    )
    led = bench.side_by_side(lambda near: bench.refit(near, bench.fine, LOOK), pulled)
    best = min(led, key=lambda h: h.fit.objective)
    return min((free, _lowest(bench, best)), key=lambda h: h.fit.objective)


def _lowest(bench: Workbench, fitted: Hypothesis) -> Hypothesis:
    """The fit, from lower places in its valleys if there are any and nothing large is missing."""
    return bench.along_valleys(fitted) if fitted.fit.over_noise < FAR else fitted


def _starts(bench: Workbench) -> list[dict[str, float]]:
    """The rig's own values, and the middle of the ranges if that is another place."""
    centre = {free.path: free.from_unit(0.5) for free in bench.nominal}
    if any(abs(p.to_unit(bench.rig.value(p.path)) - 0.5) > AWAY for p in bench.nominal):
        return [{}, centre]
    return [{}]


def _fitted_freely(bench: Workbench, starts: Sequence[dict[str, float]]) -> Hypothesis:
    """The best fit with the coarse step, gone on from with the rig's own."""
    coarse = COARSE * bench.fine
    fits = bench.side_by_side(lambda start: bench.fit((), start, coarse, LOOK), starts)
    best = bench.refit(min(fits, key=lambda h: h.fit.objective), bench.fine, POLISH // 2)
    for _ in range(MOST_ROUNDS):
        again = bench.refit(best, bench.fine, POLISH // 2)
        falling = again.fit.objective < (1.0 - FALLING) * best.fit.objective
        best = min((again, best), key=lambda h: h.fit.objective)
        if not falling:  # where the coarse step was too coarse for the oil, most of the way is left
            break
    return best
