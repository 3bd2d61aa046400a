"""From judged hypotheses to a verdict."""

from collections.abc import Sequence
from dataclasses import dataclass

from hydrolek_drake.diagnosis.evidence.judged import Judged, probability_of
from hydrolek_drake.diagnosis.settings import EVIDENCE, NOISE
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis


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
    ahead = NOISE.explained_ahead if best.hypothesis.effects else NOISE.explained
    if best.hypothesis.fit.over_noise > NOISE.explained or best.over_noise > ahead:
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
