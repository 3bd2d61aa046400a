"""When a difference is an alarm: evidence over recordings, whose false alarms over a whole series are bounded.

What recordings say of each effect adds up (`evidence`), and an alarm is raised where it exceeds the number of effects
over the probability of a false alarm that is granted (Bonferroni): this holds however the tests depend on each other,
which all lean on the same reference.

By itself a recording is beyond a threshold where its gain is more than chance brings. If nothing changed, twice the
log-likelihood ratio of an effect with k numbers is at most distributed as chi squared with k degrees of freedom (Wilks,
Annals of Mathematical Statistics 9, 1938; less where sizes are one-sided: Chernoff, the same 25, 1954). The n-th
recording is granted the share 1 / (n (n + 1)) of the false alarms, which sum to one, and every test of it an equal
part.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.stats import chi2, norm

from hydrolek_drake.diagnosis.settings import GAINS, NOISE
from hydrolek_drake.watching.asking import OWN_NUMBERS, Answer, EffectTold
from hydrolek_drake.watching.common_error import SHARED, beyond_shared
from hydrolek_drake.watching.evidence import Evidence, as_one_number, bounded, by_chance, sizes_by
from hydrolek_drake.watching.fitting.likelihood import Profile
from hydrolek_drake.watching.settings import FALSE_ALARMS, LAST, TOGETHER

UNLISTED = "unlisted"
"""Stands for: something grows that no single effect explains."""


@dataclass(frozen=True)
class AlarmRule:
    """When to raise an alarm.

    Attributes:
        false_alarms: probability of any alarm in a whole series of a healthy machine.
    """

    false_alarms: float = FALSE_ALARMS

    def granted(self, number: int) -> float:
        """Share of the false alarms that the n-th recording may have, counted from 1; all sum to `false_alarms`."""
        return self.false_alarms / (number * (number + 1))

    def asked_for(self, tests: int) -> float:
        """Evidence that one of so many tests must exceed."""
        return tests / self.false_alarms


@dataclass(frozen=True)
class Healthy:
    """How a healthy machine differs from its own reference, by the reference recordings, each held against the others.

    Attributes:
        inflation: by how much their largest gain exceeds what chance gives; 1 at least.
        left: times the noise that they leave, root mean square; 1 at least.
        deviations: effect and joint -> standard deviation of its strength in one of them, and whether it has two signs.
    """

    inflation: float = 1.0
    left: float = 1.0
    deviations: Mapping[str, tuple[float, bool]] = field(default_factory=dict)


def healthy_by(answers: Sequence[Answer]) -> Healthy:
    """What the reference recordings say of a machine in which nothing changed; of one alone, not how it varies.

    Args:
        answers: of each, with what all others tell as the prior.
    """
    deviations = _deviations(answers)
    if len(answers) < 2:
        return Healthy(1.0, max([1.0, *(answer.left for answer in answers)]), deviations)
    tests = sum(len(answer.effects) for answer in answers)
    ratios = [
        told.gain / float(chi2.isf(1.0 / tests, told.parameters))
        for answer in answers
        for told in answer.effects
    ]
    left = float(np.sqrt(np.mean([answer.left**2 for answer in answers])))
    return Healthy(max(1.0, *ratios), max(1.0, left), deviations)


def _deviations(answers: Sequence[Answer]) -> dict[str, tuple[float, bool]]:
    """Of each effect, the median over the recordings."""
    found: dict[str, list[float]] = {}
    both: set[str] = set()
    for told in (told for answer in answers for told in answer.effects if len(told.strengths) > 1):
        deviation = Profile(told.strengths, told.rises).deviation
        if np.isfinite(deviation) and deviation > 0.0:
            found.setdefault(key_of(told), []).append(deviation)
        if min(told.strengths) < 0.0:
            both.add(key_of(told))
    return {key: (float(np.median(each)), key in both) for key, each in found.items()}


@dataclass(frozen=True)
class Judgement:
    """One recording against the thresholds, and what it adds to the evidence.

    Attributes:
        beyond: effects that are beyond theirs, `UNLISTED` among them.
        thresholds: effect -> gain that it would have to exceed.
        most_left: times the noise that the best effect may leave.
        number: of the recording in the series, from 1.
        ratios: effect -> bounded likelihood ratios against none, of each of its sizes, beside each error that the
            reference may have; `UNLISTED` among them. # (k, m) each
        none: effect -> logarithms of how likely the recording is by each of these errors alone. # (k,) each
    """

    beyond: tuple[str, ...]
    thresholds: dict[str, float]
    most_left: float
    number: int = 1
    ratios: Mapping[str, np.ndarray] = field(default_factory=dict, compare=False)
    none: Mapping[str, np.ndarray] = field(default_factory=dict, compare=False)


@dataclass(frozen=True)
class Alarm:
    """What is wrong and since when.

    Attributes:
        effect: id of the effect that explains most, `OWN_NUMBERS`, or `UNLISTED`.
        joint: where; empty for the machine.
        since: index of the recording with which the evidence begins.
        raised: index of the recording with which it exceeded what is asked for.
        as_well: effects that explain the recordings since then equally well.
        unlisted: whether something is left since then that no effect explains.
    """

    effect: str
    joint: str
    since: int
    raised: int
    as_well: tuple[str, ...]
    unlisted: bool


def name_of(told: EffectTold) -> tuple[str, str]:
    """Effect and joint."""
    return told.effect, told.joint


def key_of(told: EffectTold) -> str:
    """The same as one word."""
    return f"{told.joint}.{told.effect}" if told.joint else told.effect


def judged(answer: Answer, number: int, rule: AlarmRule, healthy: Healthy) -> Judgement:
    """Hold one recording against its thresholds.

    Args:
        answer: what it says.
        number: of the recording in the series, from 1.
        rule: of the alarm.
        healthy: what a healthy machine shows.
    """
    tests = len(answer.effects) + 1
    share = rule.granted(number) / tests
    thresholds, beyond, ratios, none = {}, [], {}, {}
    counts = sorted({told.parameters for told in answer.effects})
    chances = dict(zip(counts, chi2.isf(share, counts).tolist(), strict=True))
    tempered = max(healthy.inflation, answer.needed / GAINS.needed)
    most = float(np.log(rule.asked_for(tests)))
    for told in answer.effects:
        key = key_of(told)
        thresholds[key] = max(healthy.inflation * chances[told.parameters], answer.needed)
        if told.gain > thresholds[key]:
            beyond.append(told.effect)
        own, by_error = _ratios(told, healthy.deviations.get(key), tempered, rule.false_alarms / tests)
        ratios[key], none[key] = bounded(own, most), np.maximum(by_error, -most)
    error = float(np.hypot(NOISE.known, 1.0 / np.sqrt(2.0 * max(answer.counted, 1))))
    most_left = healthy.left * (1.0 + float(norm.isf(share)) * error)
    left = min(told.left for told in answer.effects)
    if left > most_left:
        beyond.append(UNLISTED)
    by = by_chance(float(norm.sf((left / healthy.left - 1.0) / error)))
    ratios[UNLISTED] = bounded(np.array([[by]]), most)
    return Judgement(tuple(beyond), thresholds, most_left, number, ratios, none)


def _ratios(
    told: EffectTold, healthy: tuple[float, bool] | None, tempered: float, granted: float
) -> tuple[np.ndarray, np.ndarray]:
    """Logarithms of the likelihood ratios of an effect's sizes, and of how likely errors of the reference are.

    Args:
        told: what a recording says of it.
        healthy: standard deviation of its strength in a recording of the reference, and whether it has two signs.
        tempered: squares that count as one.
        granted: probability with which the reference's error may be larger than what is left out of the gain.

    Returns:
        Ratios of each size beside each error, # (k, m), and of the errors, # (k,); of one number where sizes are not
        known.
    """
    gain = told.gain / tempered
    if healthy is None:
        gain = beyond_shared(gain, told.shared_shares, granted)
        return np.array([[by_chance(float(chi2.sf(gain, told.parameters)))]]), np.zeros(1)
    sizes, shared = sizes_by(*healthy), told.shared * SHARED
    if len(told.strengths) < 2:
        alone = by_chance(float(chi2.sf(gain, told.parameters)))
        return np.full((shared.size, sizes.count), alone), np.zeros(shared.size)
    share = as_one_number(gain, told.parameters) / gain if gain > 0.0 else 1.0
    profile = Profile(told.strengths, tuple(rise * share if rise < 0.0 else rise for rise in told.rises))
    return sizes.ratios(profile, tempered, shared), -0.5 * profile.roots(shared) ** 2 / tempered


@dataclass(frozen=True)
class Share:
    """Evidence for one effect after a recording.

    Attributes:
        share: of what an alarm asks for; above 1 it is raised.
        since: number of the recording with which it begins.
    """

    share: float
    since: int


def evidence_after(judgements: Sequence[Judgement], rule: AlarmRule) -> list[dict[str, Share]]:
    """Evidence after each recording, by effect (`key_of`).

    Args:
        judgements: of the recordings, in the order of time.
        rule: of the alarm.
    """
    evidence: dict[str, Evidence] = {}
    found = []
    for judgement in judgements:
        for key, ratios in judgement.ratios.items():
            evidence.setdefault(key, Evidence()).add(ratios, judgement.number, judgement.none.get(key))
        asked_for = rule.asked_for(len(judgement.ratios))
        found.append({key: Share(each.total / asked_for, each.since) for key, each in evidence.items()})
    return found


def alarm_of(answers: Sequence[Answer], judgements: Sequence[Judgement], rule: AlarmRule) -> Alarm | None:
    """The first alarm of a series, named by all recordings since it began; None for none.

    Args:
        answers: in the order of time.
        judgements: of them.
        rule: of the alarm.
    """
    after = evidence_after(judgements, rule)
    raised = next((i for i, shares in enumerate(after) if any(s.share > 1.0 for s in shares.values())), None)
    if raised is None:
        return None
    evidence = after[raised]
    beyond = {key for key, each in evidence.items() if each.share > 1.0}
    strongest = max(beyond, key=lambda key: evidence[key].share)
    numbers = [judgement.number for judgement in judgements]
    since = next(i for i, number in enumerate(numbers) if number >= evidence[strongest].since)
    later = [i for i in range(since, len(answers)) if judgements[i].beyond] or list(range(since, raised + 1))
    unlisted = all(UNLISTED in judgements[i].beyond for i in later[-LAST:])
    if beyond == {UNLISTED}:
        return Alarm(UNLISTED, "", since, raised, (), True)
    totals = _behind_the_best([answers[i] for i in later])
    best = max(totals, key=lambda name: totals[name])
    near = [name[0] for name in totals if name != best and totals[best] - totals[name] < TOGETHER]
    return Alarm(best[0], best[1], since, raised, tuple(near), unlisted)


def _behind_the_best(answers: Sequence[Answer]) -> dict[tuple[str, str], float]:
    """What recordings together say against each effect, as squares beside each recording's best one; none above zero.

    A recording's gains are what their fits have reached, and a fit may have ended in another local minimum. So no
    single recording says more against an effect than `TOGETHER` (bounded influence; Huber, Robust Statistics, 1981).
    """
    names = dict.fromkeys(name_of(told) for answer in answers for told in answer.effects)
    totals = dict.fromkeys(names, 0.0)
    for answer in answers:
        penalty = float(np.log(max(answer.counted, 2)))
        worths = {name_of(told): told.gain - told.parameters * penalty for told in answer.effects}
        most = max(worths.values())
        for name in names:
            totals[name] -= min(most - worths.get(name, -np.inf), TOGETHER)
    return totals


def is_effect(name: str) -> bool:
    """Whether an alarm's name is that of an effect with a size."""
    return name not in (OWN_NUMBERS, UNLISTED)
