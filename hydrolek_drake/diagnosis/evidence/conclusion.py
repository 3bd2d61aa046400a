"""From judged hypotheses to a verdict."""

from collections.abc import Sequence
from dataclasses import dataclass

from hydrolek_drake.diagnosis.evidence.judged import Judged, probability_of
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis

SURE = 0.7
"""Below this probability of the best hypothesis the answer is a group, not a name."""

POSSIBLE = 0.05
"""A hypothesis at least this probable belongs to the group that the data cannot tell apart."""

EXPLAINED = 1.12
"""A model explains the recording if it leaves at most this many times the noise on the training data.

The noise is known to 1 to 2 %, and a listed effect that is named wrongly leaves 3 times the noise or more.
"""

EXPLAINED_AHEAD = 1.5
"""The same on held-out data for a structure with additions, where these numbers' own uncertainty adds to the noise.

That nothing is missing is said of a nominal model only if it predicts held-out data as well as it must explain the
others.
"""


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
    ahead = EXPLAINED_AHEAD if best.hypothesis.effects else EXPLAINED
    if best.hypothesis.fit.over_noise > EXPLAINED or best.over_noise > ahead:
        return Conclusion("unlisted_physics", best, probability, groups if best.hypothesis.effects else ())
    if not best.hypothesis.effects:
        return Conclusion("none" if best.probability >= SURE else "ambiguous", best, probability, groups)
    verdict = "missing_physics" if best.probability >= SURE or not groups else "ambiguous"
    return Conclusion(verdict, best, probability, groups)


def _groups(best: Judged, judged: Sequence[Judged]) -> tuple[tuple[str, ...], ...]:
    """Effects by which possible hypotheses differ from the best one."""
    groups = []
    for other in judged[1:]:
        if other.probability < POSSIBLE:
            continue
        mine = _only(best.hypothesis, other.hypothesis)
        theirs = _only(other.hypothesis, best.hypothesis)
        group = tuple(sorted({*mine, *theirs})) or ()
        if len(group) > 1 and group not in groups:
            groups.append(group)
    return tuple(groups)


def _only(one: Hypothesis, other: Hypothesis) -> list[str]:
    return [c.id for c in one.effects if c.size_path not in other.ids]
