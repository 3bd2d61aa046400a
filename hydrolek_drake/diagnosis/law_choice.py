"""Whether physics in no list is named, and beside which model."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis.balance import squares_of
from hydrolek_drake.diagnosis.conclusion import MATERIAL, SURE, Conclusion
from hydrolek_drake.diagnosis.effort import AT_NOISE, MORE_AHEAD
from hydrolek_drake.diagnosis.gains import gain_needed
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_at_a_joint import law_at_a_joint, left_at
from hydrolek_drake.diagnosis.law_growing import explains
from hydrolek_drake.diagnosis.law_problem import FoundLaw, left_in_all
from hydrolek_drake.diagnosis.law_told_anew import Told, told_anew
from hydrolek_drake.diagnosis.ranges import ended
from hydrolek_drake.diagnosis.search import LAW_COSTS
from hydrolek_drake.diagnosis.unlisted import find_law, without_effects
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiment import Experiment

SIMPLER = 1.1
"""A law beside the nominal model may leave so many times what it leaves beside known effects, and is preferred."""

MANY = 3
"""So many effects at once are less likely than one in no list, which they may only imitate: where one law leaves no
more of all data, it is preferred. Of one less the same is asked if they are not sure, or not at the noise of either
data. Of a single one, if it leaves more than noise ahead, whatever its numbers' uncertainty accounts for: what is bent
is uncertain too; and of any of which a number ends at an end of its range. The law must be better by what it costs more
then."""


def with_law(
    bench: Workbench,
    conclusion: Conclusion,
    judged: Sequence[Judged],
    held_out: Sequence[Experiment],
    scales: Scales,
    say: Callable[[str], None],
) -> tuple[Conclusion, FoundLaw | None]:
    """The conclusion with a law where known effects do not explain the data, or only too many of them do.

    Args:
        bench: data and fits.
        conclusion: from known effects alone.
        judged: all hypotheses that were held against held-out data.
        held_out: what decides.
        scales: natural scales of the joint.
        say: told what is being done.
    """
    nominal = next(j for j in judged if not j.hypothesis.effects)
    if conclusion.verdict == "unlisted_physics":
        say("searching a law for physics that is in no list")
        law, named = _law_and_model(bench, conclusion.best, nominal, held_out, scales)
        groups = conclusion.groups if named is conclusion.best else ()
        return replace(conclusion, best=named, groups=(*groups, *_stages(law))), law
    if _imitating(conclusion.best):
        say("searching one law that could stand for known effects")
        law = find_law(bench, nominal, held_out, scales)
        if law is not None and _preferred(law, conclusion.best, held_out):
            return alone(conclusion, judged, law), law
    return conclusion, None


def _preferred(law: FoundLaw, best: Judged, held_out: Sequence[Experiment]) -> bool:
    """Whether a law leaves so little of all data that known effects may only have imitated it."""
    fit = best.hypothesis.fit
    dearer = max(LAW_COSTS - len(best.hypothesis.effects), 0) * gain_needed(fit)
    in_place = left_in_all(law.fit, law.held_out_over_noise, held_out)
    return in_place + dearer <= left_in_all(fit, best.over_noise, held_out)


def with_law_at_a_joint(
    bench: Workbench,
    conclusion: Conclusion,
    judged: Sequence[Judged],
    held_out: Sequence[Experiment],
    scales: Mapping[str, Scales],
    say: Callable[[str], None],
) -> Told | None:
    """A law at one of several joints that were driven, where known effects do not explain the data.

    It stands alone, and is told if it leaves no more of all joints than `SIMPLER` times what the effects leave.

    Args:
        bench: data and fits.
        conclusion: from known effects alone.
        judged: all hypotheses that were held against held-out data.
        held_out: what decides.
        scales: natural scales of the joints.
        say: told what is being done.
    """
    if conclusion.verdict != "unlisted_physics":
        return None
    nominal = next(j for j in judged if not j.hypothesis.effects)
    say("searching a law at one joint for physics that is in no list")
    law = law_at_a_joint(bench, nominal.hypothesis, held_out, scales)
    if law is None:
        return None
    told = told_anew(bench, nominal.hypothesis, law, held_out)
    beside = seen_beside(bench, nominal, told.held_out).held_out
    there, counted = left_at(law.joint, beside, told.held_out)
    left = float(beside @ beside) - there + told.law.held_out_over_noise**2 * counted
    named = conclusion.best.held_out
    return told if left <= SIMPLER**2 * float(named @ named) else None


def seen_beside(bench: Workbench, judged: Judged, held_out: Sequence[Experiment]) -> Judged:
    """What a judged model leaves of held-out data that were told anew.

    Args:
        bench: rollouts.
        judged: by these data as they were told before.
        held_out: as they are told now.
    """
    residuals = bench.residuals(judged.hypothesis, held_out, judged.hypothesis.step)
    return replace(judged, held_out=residuals, chi_squared=None)


def alone(conclusion: Conclusion, judged: Sequence[Judged], law: FoundLaw) -> Conclusion:
    """A law beside the nominal model is what is missing.

    Args:
        conclusion: from known effects alone.
        judged: all hypotheses that were held against held-out data.
        law: that explains it.
    """
    nominal = next(j for j in judged if not j.hypothesis.effects)
    return replace(conclusion, verdict="unlisted_physics", best=nominal, groups=_stages(law))


def _law_and_model(
    bench: Workbench, best: Judged, nominal: Judged, held_out: Sequence[Experiment], scales: Scales
) -> tuple[FoundLaw | None, Judged]:
    """A law for physics that is in no list, and the model that it adds to.

    Known effects that were fitted without the law may only have made up for it: the law is searched beside the
    nominal model too, which is preferred unless the effects make it predict better by `SIMPLER`. Effects that take
    no material part of the error are left out from the beginning, and so are all where the law alone explains the data.
    A law that was found beside effects may be another one than the nominal model led to, so it is tried without them.
    """
    by_itself = find_law(bench, nominal, held_out, scales)
    if _immaterial(best, nominal) or (by_itself is not None and explains(by_itself)):
        return by_itself, nominal
    law = find_law(bench, best, held_out, scales)
    to_beat = best.over_noise
    if law is not None:
        to_beat = SIMPLER * law.held_out_over_noise
        again = without_effects(bench, nominal, law, held_out)
        by_itself = min((found for found in (by_itself, again) if found is not None), key=_ahead)
    if by_itself is not None and by_itself.held_out_over_noise < to_beat:
        return by_itself, nominal
    return law, best


def material(conclusion: Conclusion, judged: Sequence[Judged], held_out: Sequence[Experiment]) -> Conclusion:
    """What is named where signals count alike: effects that take a material part of one signal's error, or nothing.

    The verdict stays that physics is missing which is in no list: no model explained the data by their noise, and what
    explains them by a wider one proves nothing.

    Args:
        conclusion: of signals that count alike (`balance`), beside which no law came near the noise.
        judged: all hypotheses that were held against held-out data.
        held_out: these data.
    """
    best = conclusion.best
    nominal = next(j for j in judged if not j.hypothesis.effects)
    left, before = squares_of(best.held_out, held_out), squares_of(nominal.held_out, held_out)
    matters = best.over_noise <= nominal.over_noise and any(
        left[key] < MATERIAL * before[key] for key in before
    )
    if not matters:
        return replace(conclusion, verdict="unlisted_physics", best=nominal, groups=())
    return replace(conclusion, verdict="unlisted_physics")


def _imitating(best: Judged) -> bool:
    """Whether the effects of a model may only imitate one in no list."""
    effects = len(best.hypothesis.effects)
    far = best.hypothesis.fit.over_noise > AT_NOISE or best.over_noise > MORE_AHEAD
    doubtful = best.probability < SURE or far
    off = effects > 0 and best.over_noise > MORE_AHEAD
    off = off or any(ended(best.hypothesis, candidate) for candidate in best.hypothesis.effects)
    return effects >= MANY or (effects == MANY - 1 and doubtful) or off


def _stages(law: FoundLaw | None) -> tuple[tuple[str, ...], ...]:
    """The stages of a law that the data cannot tell apart, as a group; none where there is one."""
    if law is None or not law.rivals:
        return ()
    return (tuple(f"unlisted.{stage}" for stage in (law.law.input.stage, *law.rivals)),)


def _immaterial(best: Judged, nominal: Judged) -> bool:
    return best.half_chi_squared > MATERIAL * nominal.half_chi_squared


def _ahead(law: FoundLaw) -> float:
    return law.held_out_over_noise
