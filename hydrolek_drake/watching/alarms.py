"""When a difference is an alarm: a test whose false alarms over a whole series are bounded.

If nothing changed, twice the log-likelihood ratio of an effect with k numbers is at most distributed as chi squared
with k degrees of freedom (Wilks, Annals of Mathematical Statistics 9, 1938; less where sizes are one-sided: Chernoff,
the same 25, 1954).
The n-th recording of a series is granted the share 1 / (n (n + 1)) of the false alarms, which sum to one however long
it becomes, and every test of that recording an equal part of it (Bonferroni), which holds however the tests depend on
each other: all lean on the same reference.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2, norm

from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.watching.asking import OWN_NUMBERS, Answer, EffectTold
from hydrolek_drake.watching.settings import FALSE_ALARMS, PERSISTENCE, TOGETHER

UNLISTED = "unlisted"
"""Stands for: something grows that no single effect explains."""


@dataclass(frozen=True)
class AlarmRule:
    """When to raise an alarm.

    Attributes:
        false_alarms: probability of any alarm in a whole series of a healthy machine.
        persistence: recordings in a row that must be beyond the threshold.
    """

    false_alarms: float = FALSE_ALARMS
    persistence: int = PERSISTENCE

    def granted(self, number: int) -> float:
        """Share of the false alarms that the n-th recording may have, counted from 1; all sum to `false_alarms`."""
        return self.false_alarms / (number * (number + 1))


@dataclass(frozen=True)
class Healthy:
    """How a healthy machine differs from its own reference, by the reference recordings, each held against the others.

    Attributes:
        inflation: by how much their largest gain exceeds what chance gives; 1 at least.
        left: times the noise that they leave, root mean square; 1 at least.
    """

    inflation: float = 1.0
    left: float = 1.0


def healthy_by(answers: Sequence[Answer]) -> Healthy:
    """What the reference recordings say of a machine in which nothing changed; of fewer than two, nothing.

    Args:
        answers: of each, with what all others tell as the prior.
    """
    if len(answers) < 2:
        return Healthy(1.0, max([1.0, *(answer.left for answer in answers)]))
    tests = sum(len(answer.effects) for answer in answers)
    ratios = [
        told.gain / float(chi2.isf(1.0 / tests, told.parameters))
        for answer in answers
        for told in answer.effects
    ]
    left = float(np.sqrt(np.mean([answer.left**2 for answer in answers])))
    return Healthy(max(1.0, *ratios), max(1.0, left))


@dataclass(frozen=True)
class Judgement:
    """One recording against the thresholds.

    Attributes:
        beyond: effects that are beyond theirs, `UNLISTED` among them.
        thresholds: effect -> gain that it would have to exceed.
        most_left: times the noise that the best effect may leave.
    """

    beyond: tuple[str, ...]
    thresholds: dict[str, float]
    most_left: float


@dataclass(frozen=True)
class Alarm:
    """What is wrong and since when.

    Attributes:
        effect: id of the effect that explains most, `OWN_NUMBERS`, or `UNLISTED`.
        joint: where; empty for the machine.
        since: index of the first recording of those in a row that were beyond the threshold.
        raised: index of the recording with which the alarm was raised.
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


def judged(answer: Answer, number: int, rule: AlarmRule, healthy: Healthy) -> Judgement:
    """Hold one recording against its thresholds.

    Args:
        answer: what it says.
        number: of the recording in the series, from 1.
        rule: of the alarm.
        healthy: what a healthy machine shows.
    """
    share = rule.granted(number) / (len(answer.effects) + 1)
    thresholds, beyond = {}, []
    counts = sorted({told.parameters for told in answer.effects})
    by_chance = dict(zip(counts, chi2.isf(share, counts).tolist(), strict=True))
    for told in answer.effects:
        chance = healthy.inflation * by_chance[told.parameters]
        key = f"{told.joint}.{told.effect}" if told.joint else told.effect
        thresholds[key] = max(chance, answer.needed)
        if told.gain > thresholds[key]:
            beyond.append(told.effect)
    error = float(np.hypot(NOISE.known, 1.0 / np.sqrt(2.0 * max(answer.counted, 1))))
    most = healthy.left * (1.0 + float(norm.isf(share)) * error)
    if min(told.left for told in answer.effects) > most:
        beyond.append(UNLISTED)
    return Judgement(tuple(beyond), thresholds, most)


def alarm_of(answers: Sequence[Answer], judgements: Sequence[Judgement], rule: AlarmRule) -> Alarm | None:
    """The first alarm of a series, named by all recordings since it began; None for none.

    Args:
        answers: in the order of time.
        judgements: of them.
        rule: of the alarm.
    """
    run = 0
    raised = None
    for index, judgement in enumerate(judgements):
        run = run + 1 if judgement.beyond else 0
        if run >= rule.persistence:
            raised = index
            break
    if raised is None:
        return None
    since = raised - rule.persistence + 1
    later = [i for i in range(since, len(answers)) if judgements[i].beyond]
    unlisted = all(UNLISTED in judgements[i].beyond for i in later[-rule.persistence :])
    totals = _behind_the_best([answers[i] for i in later])
    best = max(totals, key=lambda name: totals[name])
    explained = any(best[0] in judgements[i].beyond for i in later)
    if not explained:
        return Alarm(UNLISTED, "", since, raised, (), True)
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
