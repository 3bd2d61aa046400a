"""Fits that got stuck, led on.

Where a joint sticks and slips, the squared residuals have many hollows, and least squares ends in the next one. Three
ways lead out: rollouts that are pulled to the measurements; other starts; and a Jacobian of wide differences that
become narrower, which sees the slope of the land and not that of the hollow (Kelley, Implicit Filtering, SIAM, 2011,
chapter 3).
"""

import itertools
import math
from collections.abc import Sequence

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.effort import AT_NOISE, BEAM, LOOK, POLISH
from hydrolek_drake.diagnosis.gains import gain_needed
from hydrolek_drake.diagnosis.pulled_fits import fit_pulled, let_go, with_sizes_walked
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench, moments_of
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.problem import PULL_S

TRIED_PULLED = 30
"""So many of the first fits are tried with pulled rollouts too: every effect of one joint. The one that is missing may
have got stuck farthest off of all."""

WIDTHS = (0.3, 0.1, 0.03, 0.01)
"""Differences, as fractions of the ranges, from the widest that is not the whole range to what residuals of a
sticking joint still bend over."""

LED_STEP = 2.0
"""Integration step over the rig's own while differences are wide."""

MOST_LED = 5
"""So many fits are led on, from different places; the better half goes on to the next width."""

SIZED = (0.1, 0.03)
"""Sizes up to so far from the best one are tried, the narrow ones where the wide ones do not help. A hollow of the size
is a hundredth or two wide where contacts open and close many times."""

MOST_SIZED = 4
"""So often at most."""

LED_TO_THE_END = 2
"""At least so many of them."""


def unstuck(bench: Workbench, glances: Sequence[Hypothesis], looks: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Fits that got stuck, begun again where rollouts that are pulled to the measurements fit best.

    The residuals of a free rollout pile up what went wrong before: a joint that sticks at the wrong moment is
    wrong from then on, and least squares ends in the next hollow. Pulled rollouts forget within `PULL_S`, as the
    prediction errors of an observer do (Ljung, System Identification, 1999, chapter 7), so that the same fit goes
    its way from far off; what drifts slowly they do not see, and so the free fits stand beside them.
    """
    part = bench.beginning()

    def pulled(glance: Hypothesis) -> Hypothesis:
        joints = bench.joints_of(glance.effects)
        others = {k: v for k, v in glance.values.items() if of_another_joint(k, joints)}
        starts = [{**others, **start, **_timing(glance)} for start in ({}, *starts_of(glance.effects))]
        return with_sizes_walked(bench, glance.effects, different(starts), glance.step, part)

    ahead = sorted(bench.side_by_side(pulled, glances[:TRIED_PULLED]), key=lambda h: h.fit.objective)

    def followed(glance: Hypothesis) -> Hypothesis:
        near = bench.fit(
            glance.effects, glance.values, glance.step, LOOK, tolerance=1e-4, pull_time=PULL_S, alone=True
        )
        return bench.refit(let_go(bench, near), near.step, LOOK, tolerance=1e-4, alone=True)

    again = bench.side_by_side(followed, ahead[:BEAM])
    best = {h.ids: h for h in sorted([*looks, *again], key=lambda h: -h.fit.objective)}
    return sorted(best.values(), key=lambda h: h.fit.objective)


def pulled_from_own(
    bench: Workbench, hypothesis: Hypothesis, step: float, experiments: Sequence[Experiment]
) -> Hypothesis:
    """A model fitted with pulled rollouts from the rig's own numbers, with its effects where they are.

    Args:
        bench: data and fits.
        hypothesis: the model.
        step: of the integration [s].
        experiments: to be fitted.
    """
    own = own_values(bench, hypothesis.effects, hypothesis.values)
    return with_sizes_walked(bench, hypothesis.effects, [own], step, experiments)


def from_other_sizes(bench: Workbench, hypothesis: Hypothesis, up_to: float) -> list[Hypothesis]:
    """A model with something sudden that is near the noise and not at it, fitted again from sizes near by.

    Under a controller every contact shifts the next one, so that a gap a tenth off is a hollow of its own, from which
    neither the size nor the joint's own parameters lead out alone. These start as the rig has them, and pulled rollouts
    bring them to where they belong to that size. The best size is what the next ones lie around (pattern search: Hooke
    and Jeeves, Journal of the ACM 8, 1961).

    Args:
        bench: data and fits.
        hypothesis: the model.
        up_to: where it leaves more times the noise than this, more is missing.

    Returns:
        all fits; none where nothing sudden is in the model.
    """
    sizes = [candidate.size_path for candidate in hypothesis.effects if candidate.effect.sudden]
    best, fits, widths = hypothesis, [], list(SIZED)
    for _ in range(MOST_SIZED):
        if not (sizes and widths and AT_NOISE < best.fit.over_noise < up_to):
            break
        own = own_values(bench, best.effects, best.values)
        shares = [1.0 + side * widths[0] for side in (-1.0, -0.5, 0.5, 1.0)]
        starts = [{**own, size: share * own[size]} for size in sizes for share in shares]
        around = bench.side_by_side(lambda start: _fitted_near(bench, hypothesis.effects, start), starts)
        fits += around
        least = min([best, *around], key=lambda h: h.fit.objective)
        if best.fit.objective - least.fit.objective < gain_needed(best.fit):
            widths.pop(0)
        best = least
    return fits


def _fitted_near(bench: Workbench, effects: Sequence[Candidate], start: dict[str, float]) -> Hypothesis:
    """A fit with pulled rollouts, to the end, and then with free ones."""
    near = fit_pulled(bench, effects, [start], bench.fine, bench.training)
    near = bench.fit(effects, near.values, bench.fine, LOOK, pull_time=PULL_S)
    return bench.refit(let_go(bench, near), bench.fine, LOOK)


def starts_of(effects: Sequence[Candidate]) -> list[dict[str, float]]:
    """Every combination of the places where searches of these effects begin."""
    combinations = itertools.product(*(candidate.starts for candidate in effects))
    return [{path: value for start in chosen for path, value in start.items()} for chosen in combinations]


def started_again(hypothesis: Hypothesis) -> list[dict[str, float]]:
    """Its values, with those of its effects where their searches begin; when something happens is kept."""
    starts = starts_of(hypothesis.effects)
    return different([{**hypothesis.values, **start, **_timing(hypothesis)} for start in starts])


def begun_anew(
    bench: Workbench, effects: Sequence[Candidate], values: dict[str, float]
) -> list[dict[str, float]]:
    """Effects where their searches begin, and the joint's own parameters as the rig has them.

    Args:
        bench: knows the rig.
        effects: of the fits that are to begin.
        values: full path -> value of a model; of these, what other joints are and when something happens is kept.
    """
    joints = bench.joints_of(effects)
    moments = {free.path for free in moments_of(effects)}
    kept = {k: v for k, v in values.items() if k in moments or of_another_joint(k, joints)}
    return different([{**start, **kept} for start in starts_of(effects)])


def own_values(bench: Workbench, effects: Sequence[Candidate], begin: dict[str, float]) -> dict[str, float]:
    """Where a fit begins anew: effects as given, the joint's own parameters as the rig has them.

    A model that lacks an effect has bent its parameters to make up for it.
    """
    joints = bench.joints_of(effects)
    return {k: v for k, v in begin.items() if ".effects." in k or of_another_joint(k, joints)}


def _timing(hypothesis: Hypothesis) -> dict[str, float]:
    """When something happens, which rollouts that forget do not tell."""
    return {free.path: hypothesis.values[free.path] for free in moments_of(hypothesis.effects)}


def led_on(bench: Workbench, effects: Sequence[Candidate], starts: Sequence[dict[str, float]]) -> Hypothesis:
    """The best fit of some effects from several places, with differences from wide to narrow.

    Args:
        bench: data and fits.
        effects: what is added to the nominal model.
        starts: places to begin, the most promising first.
    """
    ahead = different(starts)[:MOST_LED]
    for width in WIDTHS:

        def led(values: dict[str, float], width: float = width) -> Hypothesis:
            return bench.fit(effects, values, LED_STEP * bench.fine, POLISH, tolerance=1e-3, difference=width)

        ended = sorted(bench.side_by_side(led, ahead), key=lambda h: h.fit.objective)
        ahead = [h.values for h in ended[: max(math.ceil(len(ended) / 2), LED_TO_THE_END)]]
    fits = bench.side_by_side(lambda values: bench.fit(effects, values, bench.fine, LOOK), ahead)
    return min(fits, key=lambda h: h.fit.objective)


def of_another_joint(path: str, joints: set[str]) -> bool:
    """Whether a parameter belongs to a joint, and to none of these."""
    return path.startswith("joints.") and path.split(".")[1] not in joints


def different(starts: Sequence[dict[str, float]]) -> list[dict[str, float]]:
    """Starts, each once."""
    kept: list[dict[str, float]] = []
    for start in starts:
        if not any(start == other for other in kept):
            kept.append(start)
    return kept
