"""What held-out data say of structures that were fitted to training data.

The training data leave a structure's parameters uncertain by a covariance S. To first order the held-out
residuals r of one that is right then have the covariance I + J S J', J their Jacobian (`predictive`; MacKay, Bayesian
interpolation, Neural Computation 4, 1992).
"""

import math
from collections.abc import Sequence

import numpy as np

from hydrolek_drake.diagnosis.evidence.judged import Judged, with_probabilities
from hydrolek_drake.diagnosis.search.cost import gain_needed
from hydrolek_drake.diagnosis.search.tried import Tried
from hydrolek_drake.diagnosis.settings import GAINS
from hydrolek_drake.diagnosis.structures.workbench import SPREAD, Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit


def judge_as_fitted(
    bench: Workbench, hypotheses: Sequence[Hypothesis], held_out: Sequence[Experiment]
) -> list[Judged]:
    """The same in haste, after an interrupt: one rollout each, and what is uncertain of the parameters counts as error.

    Args:
        bench: rollouts.
        hypotheses: as they were fitted when the search ended.
        held_out: recordings that nothing was fitted to.
    """
    return with_probabilities(_looked_at(bench, hypotheses, held_out))


def judge_given_up(bench: Workbench, found: Tried, held_out: Sequence[Experiment]) -> list[Judged]:
    """What the held-out data say of hypotheses that were not fitted to the end, the best first."""
    left = [h for key, h in found.given_up.items() if key not in found.hypotheses]
    return sorted(_looked_at(bench, left, held_out), key=lambda j: j.half_chi_squared)


def _looked_at(
    bench: Workbench, hypotheses: Sequence[Hypothesis], held_out: Sequence[Experiment]
) -> list[Judged]:
    """What hypotheses leave of the held-out data as they are fitted."""
    counted = sum(experiment.counted for experiment in held_out)
    return bench.side_by_side(
        lambda h: Judged(h, bench.residuals(h, held_out, bench.fine), counted), hypotheses
    )


def predictive(residuals: np.ndarray, jacobian: np.ndarray, fit: Fit) -> tuple[float, float]:
    """Squared residuals r' (I + J S J')^-1 r and spread log det (I + J S J') of held-out data.

    Args:
        residuals: r. # (values,)
        jacobian: J. # (values, n)
        fit: to the training data; S is the inverse of its information, with a range's variance for a parameter of
            which nothing else is known.
    """
    known = fit.jacobian.T @ fit.jacobian + fit.prior_jacobian.T @ fit.prior_jacobian
    free = np.diag(fit.prior_jacobian) == 0.0
    known[free, free] += 1.0 / SPREAD**2
    both = known + jacobian.T @ jacobian
    pulled = jacobian.T @ residuals
    chi_squared = float(residuals @ residuals - pulled @ np.linalg.solve(both, pulled))
    spread = float(np.linalg.slogdet(both)[1] - np.linalg.slogdet(known)[1])
    return chi_squared, spread


def pays(hypothesis: Hypothesis, others: Sequence[Hypothesis]) -> bool:
    """Whether every further effect also lowers the error of the training data by what chance could not.

    The same is asked of an effect in place of its special case. Two fits of nearly the same model end in slightly
    different places; on held-out data that can look like the gain of an effect that does next to nothing.
    """
    return all(
        other.fit.objective - hypothesis.fit.objective >= _to_pay(hypothesis, other) for other in others
    )


def predicts(judged: Judged, others: Sequence[Judged]) -> bool:
    """Whether a hypothesis predicts the held-out data better than everything that it contains.

    What lowers the error of the training data alone stands for something else there, such as an error of the step.
    """
    return all(
        other.ahead > judged.ahead
        for other in others
        if _to_pay(judged.hypothesis, other.hypothesis) > -math.inf
    )


def _to_pay(hypothesis: Hypothesis, other: Hypothesis) -> float:
    """Fall of the squared residuals that a hypothesis owes to another one that it contains; else minus infinity."""
    own = [c for c in hypothesis.effects if c.size_path not in other.ids]
    special = [c for c in other.effects if c.size_path not in hypothesis.ids]
    if own and not special:
        return gain_needed(other.fit) * len(own)
    contained = [any(s.is_special_case_of(c) for c in own) for s in special]
    return GAINS.needed * len(own) if special and all(contained) and len(own) == len(special) else -math.inf
