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

from hydrolek_drake.diagnosis.search import FIDELITY, POLISH, Search
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

EFFECT_COST = 4.5
"""Log-odds against each further effect at least: with some twenty to choose from, chance has to be paid for."""

PARAMETER_COST = 1.0
"""Log-odds against each further parameter: what chance gains on data that it was fitted to (Akaike)."""

NOISE_KNOWN = 0.015
"""Relative uncertainty of the noise level, which is estimated from the recording."""

FINER = 0.5
"""Last fits use this fraction of the rig's own step, so that the step's error cannot decide."""

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
        lambda h: bench.refit(h, finer, POLISH) if h.fit.objective < 2.0 * found.best.fit.objective else h,
        chosen,
    )
    judged = bench.side_by_side(lambda h: Judged(h, bench.residuals(h, held_out, finer), counted), refitted)
    return with_probabilities(judged)


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
