"""Structures compared on data that nothing was fitted to: how probable that makes each, how surely, and the verdict.

Residuals that lie close together err alike, so that the difference of two log-densities is summed over blocks of the
recordings, and its standard error is told by how these differ (Vehtari, Gelman, Gabry, Practical Bayesian model
evaluation, Statistics and Computing 27, 2017, section 5.1, with blocks in place of single values).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from hydrolek_drake.diagnosis.settings import EVIDENCE, GAINS, NOISE
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.cost import cost, dispersion
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.splitting import short_blocks
from hydrolek_drake.diagnosis.structures.weighing import least_over_noise
from hydrolek_drake.identification.experiments.experiment import Experiment


@dataclass(frozen=True)
class Judged:
    """A hypothesis and what the held-out data say of it.

    Attributes:
        hypothesis: fitted to the training data.
        held_out: residuals on the held-out data, in units of the noise. # (values,)
        held_out_counted: how many of them count.
        probability: among all that were judged.
        chi_squared: r' (I + J S J')^-1 r; None for r' r.
        shares: of each value in it; None for those in r' r. # (values,)
        spread: log det (I + J S J').
        behind: log-density of the held-out data less than that of the most probable (`with_differences`).
        behind_error: standard error of that.
        fitted_too: times the noise that it leaves of these data beyond what it leaves of the others, fitted to both;
            behind the recorded pressure of a pump where there is one; None where nobody asked.
        left_behind_cut: times the noise that it leaves of these data behind the recorded pressure of a pump
            (`over_noise_behind`); None where there is none, or nobody asked.
        trained_behind_cut: the same of the training data.
        least_held_out: times the noise that the rig's equations leave of these data at best, by its `model_error`.
        least_trained: the same of the training data.
        stands: recording (`windows.recording_of`) -> additions and place in the unit cube there (`nuisance`).
    """

    hypothesis: Hypothesis
    held_out: np.ndarray
    held_out_counted: int
    probability: float = math.nan
    chi_squared: float | None = None
    shares: np.ndarray | None = None
    spread: float = 0.0
    behind: float = 0.0
    behind_error: float = math.nan
    fitted_too: float | None = None
    left_behind_cut: float | None = None
    trained_behind_cut: float | None = None
    least_held_out: float = 1.0
    least_trained: float = 1.0
    stands: Mapping[str, tuple[tuple[Addition, ...], np.ndarray]] = field(default_factory=dict)

    @property
    def over_noise(self) -> float:
        """Held-out root mean square over the noise."""
        return math.sqrt(float(self.held_out @ self.held_out) / max(self.held_out_counted, 1))

    @property
    def explains_held_out(self) -> bool:
        """Whether it leaves so little of the held-out data that nothing is missing that these show.

        When a relief valve sticks and its line rings next depends on all before it, which no model tells for long: one
        that explains what lies behind the recorded pressure may be off in the line now and then, but not be far from
        the noise on the whole.
        """
        most = self.least_held_out * (
            NOISE.explained_held_out if self.hypothesis.effects else NOISE.explained
        )
        if self.fitted_too is not None and self.fitted_too <= most:
            return True
        if self.left_behind_cut is None:
            return self.over_noise <= most
        return self.left_behind_cut <= most and self.over_noise <= max(NOISE.far, most)

    @property
    def explains_training(self) -> bool:
        """Whether it leaves so little of the training data that nothing is missing that these show, as for held-out."""
        left, most = self.hypothesis.fit.over_noise, self.least_trained * NOISE.explained
        if self.trained_behind_cut is None:
            return left <= most
        return self.trained_behind_cut <= most and left <= max(NOISE.far, most)

    @property
    def granted(self) -> bool:
        """Whether it explains the data by what the rig says that its equations leave at best, and not without that."""
        strict = replace(self, least_held_out=1.0, least_trained=1.0)
        explains = self.explains_training and self.explains_held_out
        return explains and not (strict.explains_training and strict.explains_held_out)

    @property
    def fails_held_out_alone(self) -> bool:
        """Whether it explains what it was fitted to, and not the held-out data."""
        behind = self.trained_behind_cut
        left = self.hypothesis.fit.over_noise if behind is None else behind
        return left <= self.least_trained * NOISE.held_out and not self.explains_held_out

    @property
    def log_density(self) -> float:
        """Of the held-out data given the training data, less what is the same for all structures."""
        return -self.half_chi_squared - 0.5 * self.spread

    @property
    def support(self) -> float:
        """Log-likelihood of held-out and training data, less the cost of its effects and parameters in each."""
        fit = self.hypothesis.fit
        share = max(GAINS.fidelity, fit.unsure / max(fit.counted, 1))
        effect = max(EVIDENCE.effect_cost, 0.5 * share * self.held_out_counted)
        added = effect * len(self.hypothesis.effects) + EVIDENCE.parameter_cost * self.hypothesis.extra
        return self.log_density - added - 0.5 * cost(self.hypothesis)

    @property
    def half_chi_squared(self) -> float:
        """Half of the held-out squared residuals that the parameters' uncertainty does not account for."""
        if self.chi_squared is not None:
            return 0.5 * self.chi_squared
        return 0.5 * float(self.held_out @ self.held_out)

    @property
    def lost(self) -> np.ndarray:
        """What each value contributes to `half_chi_squared`. # (values,)."""
        if self.shares is None:
            return 0.5 * self.held_out**2
        return self.shares * self.half_chi_squared / max(float(self.shares.sum()), 1.0)


def with_probabilities(judged: Sequence[Judged]) -> list[Judged]:
    """The same, with probabilities, the most probable first."""
    scale = dispersion_of(min(judged, key=lambda j: j.half_chi_squared))
    support = np.array([j.support for j in judged]) / scale
    weight = np.exp(support - support.max())
    weight /= weight.sum()
    ranked = sorted(zip(weight.tolist(), judged, strict=True), key=lambda pair: -pair[0])
    return [replace(j, probability=w) for w, j in ranked]


def dispersion_of(best: Judged) -> float:
    """Of the likelihood, as the best structure tells it by all data; see `search.cost.dispersion`."""
    fit = best.hypothesis.fit
    left = 2.0 * best.half_chi_squared + fit.chi_squared
    return dispersion(left, best.held_out_counted + fit.counted, len(fit.unit))


def probability_of(effect_path: str, judged: Sequence[Judged]) -> float:
    """Probability that an effect is there: of all hypotheses that hold it."""
    return sum(j.probability for j in judged if effect_path in j.hypothesis.ids)


def with_differences(judged: Sequence[Judged], held_out: Sequence[Experiment]) -> tuple[Judged, ...]:
    """The same, each with how far it is behind the first.

    Args:
        judged: structures with residuals on the held-out data, the most probable first.
        held_out: these data.
    """
    told, blocks = [], blocks_of(held_out)
    for each in judged:
        behind, error = difference(judged[0], each, blocks)
        told.append(replace(each, behind=behind, behind_error=error))
    return tuple(told)


def difference(better: Judged, other: Judged, blocks: np.ndarray) -> tuple[float, float]:
    """By how much the log-density of held-out data is less given another structure, and its standard error over blocks.

    Args:
        better: a structure with residuals on the held-out data.
        other: another one.
        blocks: see `blocks_of`. # (values,)
    """
    lost = other.lost - better.lost
    sums = np.bincount(blocks[blocks >= 0], lost[blocks >= 0])[np.unique(blocks[blocks >= 0])]
    error = math.sqrt(sums.size * float(np.var(sums, ddof=1))) if sums.size > 1 else math.inf
    return float(sums.sum()), error


def with_behind_cut(judged: Judged, training: Sequence[Experiment], held_out: Sequence[Experiment]) -> Judged:
    """The same with what it leaves behind the recorded pressure of a pump, where the chain is cut there."""
    return replace(
        with_least(judged, training, held_out),
        left_behind_cut=over_noise_behind(judged.held_out, held_out),
        trained_behind_cut=over_noise_behind(judged.hypothesis.fit.residuals, training),
    )


def with_least(judged: Judged, training: Sequence[Experiment], held_out: Sequence[Experiment]) -> Judged:
    """The same with what equations leave at best."""
    return replace(
        judged, least_held_out=least_over_noise(held_out), least_trained=least_over_noise(training)
    )


def over_noise_behind(residuals: np.ndarray, experiments: Sequence[Experiment]) -> float | None:
    """Times the noise that is left behind the recorded pressure of a pump; None where the chain is not cut.

    Args:
        residuals: of all channels. # (values,)
        experiments: whose.
    """
    if not any(e.cut for e in experiments):
        return None
    behind = np.concatenate(
        [np.repeat([c.model != "supply_pressure" for c in e.channels], e.time.size) for e in experiments]
    )
    counted = sum(e.behind_cut().counted for e in experiments)
    return math.sqrt(float(residuals[behind] @ residuals[behind]) / max(counted, 1))


def blocks_of(held_out: Sequence[Experiment]) -> np.ndarray:
    """Number of the block of each value of held-out data; -1 of one that does not count. # (values,)."""
    parts, first = [], 0
    for experiment in held_out:
        own = np.where(experiment.used, short_blocks(experiment) + first, -1)
        parts.append(np.tile(own, len(experiment.channels)))
        first = max(int(own.max(initial=-1)) + 1, first)
    return np.concatenate(parts)


@dataclass(frozen=True)
class Conclusion:
    """What the data say.

    Attributes:
        verdict: none, missing_physics, ambiguous or unlisted_physics.
        best: the most probable hypothesis.
        probability: effect's path -> probability that it is there.
        groups: ids of effects that the data cannot tell apart.
    """

    verdict: str
    best: Judged
    probability: dict[str, float]
    groups: tuple[tuple[str, ...], ...]


def conclude(judged: Sequence[Judged]) -> Conclusion:
    """The verdict that judged hypotheses allow, the most probable first."""
    best = judged[0]
    paths = {path for j in judged for path in j.hypothesis.ids}
    probability = {path: probability_of(path, judged) for path in paths}
    groups = _groups(best, judged)
    if not (best.explains_training and best.explains_held_out):
        return Conclusion("unlisted_physics", best, probability, groups if best.hypothesis.effects else ())
    if not best.hypothesis.effects:
        return Conclusion(
            "none" if best.probability >= EVIDENCE.sure else "ambiguous", best, probability, groups
        )
    verdict = "missing_physics" if best.probability >= EVIDENCE.sure or not groups else "ambiguous"
    return Conclusion(verdict, best, probability, groups)


def _groups(best: Judged, judged: Sequence[Judged]) -> tuple[tuple[str, ...], ...]:
    """Effects by which possible hypotheses differ from the best one."""
    groups = []
    for other in judged[1:]:
        if other.probability < EVIDENCE.significance:
            continue
        mine = _only(best.hypothesis, other.hypothesis)
        theirs = _only(other.hypothesis, best.hypothesis)
        group = tuple(sorted({*mine, *theirs})) or ()
        if len(group) > 1 and group not in groups:
            groups.append(group)
    return tuple(groups)


def _only(one: Hypothesis, other: Hypothesis) -> list[str]:
    return [c.id for c in one.effects if c.size_path not in other.ids]
