"""Which hypothesis is right, judged on data that none of them was fitted to.

The log-likelihood of the held-out data under a hypothesis that was fitted to the training data is
-chi^2 / 2, less the cost of its effects and of their parameters, all divided by tau. Fitted parameters that
are off within their uncertainty add about one to chi^2 each. Where the best model's chi^2 exceeds the noise by
more, something systematic is left, and tau is that excess for each parameter: differences of that size do not
decide (quasi-likelihood, McCullagh, Nelder, Generalized Linear Models, 1989, chapter 9). Probabilities are the
normalised exponentials (Bayes with equal odds for all hypotheses of the same number of effects).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.search import FIDELITY, NEARLY, Search, gain_needed
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

EFFECT_COST = 4.5
"""Log-odds against each further effect at least: with some twenty to choose from, chance has to be paid for."""

PARAMETER_COST = 2.0
"""Log-odds against each further parameter, so that a special case is preferred to what contains it."""

NOISE_KNOWN = 0.015
"""Relative uncertainty of the noise level, which is estimated from the recording."""

FINER = 0.5
"""Last fits use this fraction of the rig's own step, so that the step's error cannot decide."""

FINISH = 4
"""Trust-region steps of the last fits, which begin at the optimum of the rig's own step."""

CONTENDERS = 8
"""At most so many hypotheses are fitted with the finer step."""

OUT_OF_REACH = 150.0
"""Half the squared residuals by which a hypothesis is beyond all doubt behind the best."""


@dataclass(frozen=True)
class Judged:
    """A hypothesis and what the held-out data say of it.

    Attributes:
        hypothesis: fitted to the training data.
        held_out: residuals on the held-out data, in units of the noise. # (values,)
        held_out_counted: how many of them count.
        probability: among all that were judged.
    """

    hypothesis: Hypothesis
    held_out: np.ndarray
    held_out_counted: int
    probability: float = math.nan

    @property
    def over_noise(self) -> float:
        """Held-out root mean square over the noise."""
        return math.sqrt(float(self.held_out @ self.held_out) / max(self.held_out_counted, 1))

    @property
    def support(self) -> float:
        """Log-likelihood less the cost of its effects and parameters."""
        effect = max(EFFECT_COST, 0.5 * FIDELITY * self.held_out_counted)
        cost = effect * len(self.hypothesis.effects) + PARAMETER_COST * self.hypothesis.extra
        return -self.half_chi_squared - cost

    @property
    def half_chi_squared(self) -> float:
        """Half of the held-out squared residuals."""
        return 0.5 * float(self.held_out @ self.held_out)


def judge(bench: Workbench, found: Search, held_out: Sequence[Experiment]) -> list[Judged]:
    """Hold the hypotheses of a search against held-out data, the most probable first.

    Args:
        bench: fits.
        found: hypotheses, fitted to the training data.
        held_out: recordings that nothing was fitted to.
    """
    counted = sum(experiment.counted for experiment in held_out)
    first = bench.side_by_side(
        lambda h: Judged(h, bench.residuals(h, held_out, bench.fine), counted),
        list(found.hypotheses.values()),
    )
    finer = FINER * bench.fine
    chosen = _contenders(first, found)
    refitted = bench.side_by_side(
        lambda h: bench.refit(h, finer, FINISH) if _decides(h, found) else h,
        chosen,
    )
    paying = [h for h in refitted if pays(h, refitted)]
    judged = bench.side_by_side(lambda h: Judged(h, bench.residuals(h, held_out, finer), counted), paying)
    return with_probabilities(judged)


def pays(hypothesis: Hypothesis, others: Sequence[Hypothesis]) -> bool:
    """Whether every further effect also lowers the error of the training data by what chance could not.

    Two fits of nearly the same model end in slightly different places; on held-out data that can look like
    the gain of an effect that does next to nothing.
    """
    return all(
        other.fit.objective - hypothesis.fit.objective
        >= gain_needed(other.fit) * len(hypothesis.ids - other.ids)
        for other in others
        if other.ids < hypothesis.ids
    )


def judge_given_up(bench: Workbench, found: Search, held_out: Sequence[Experiment]) -> list[Judged]:
    """What the held-out data say of hypotheses that were not fitted to the end, the best first."""
    counted = sum(experiment.counted for experiment in held_out)
    left = [h for key, h in found.given_up.items() if key not in found.hypotheses]
    judged = bench.side_by_side(lambda h: Judged(h, bench.residuals(h, held_out, bench.fine), counted), left)
    return sorted(judged, key=lambda j: j.half_chi_squared)


def _decides(hypothesis: Hypothesis, found: Search) -> bool:
    """Whether the error of the step could matter: only for those near the best, and if that is near the noise."""
    best = found.best.fit
    return best.over_noise < NEARLY and hypothesis.fit.objective < 2.0 * best.objective


def _contenders(first: Sequence[Judged], found: Search) -> list[Hypothesis]:
    """Those that may still win, and always the nominal model and the best fits without one of their effects."""
    ranked = sorted(first, key=lambda j: -j.support)
    best = ranked[0]
    scale = dispersion(best)
    near = [
        j.hypothesis for j in ranked if (j.half_chi_squared - best.half_chi_squared) / scale < OUT_OF_REACH
    ]
    chosen = [best.hypothesis, found.baseline, found.best, *near]
    unique = {h.ids: h for h in chosen}
    return list(unique.values())[:CONTENDERS]


def with_probabilities(judged: Sequence[Judged]) -> list[Judged]:
    """The same, with probabilities, the most probable first."""
    scale = dispersion(min(judged, key=lambda j: j.half_chi_squared))
    support = np.array([j.support for j in judged]) / scale
    weight = np.exp(support - support.max())
    weight /= weight.sum()
    ranked = sorted(zip(weight.tolist(), judged, strict=True), key=lambda pair: -pair[0])
    return [Judged(j.hypothesis, j.held_out, j.held_out_counted, w) for w, j in ranked]


def dispersion(best: Judged) -> float:
    """How much flatter than for pure noise the likelihood is: tau, from the best model's excess."""
    excess = 2.0 * best.half_chi_squared - (1.0 + NOISE_KNOWN) ** 2 * best.held_out_counted
    return max(1.0, excess / len(best.hypothesis.fit.unit))


def probability_of(effect_path: str, judged: Sequence[Judged]) -> float:
    """Probability that an effect is there: of all hypotheses that hold it."""
    return sum(j.probability for j in judged if effect_path in j.hypothesis.ids)
