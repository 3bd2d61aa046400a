"""Hypotheses held against lesser ones that start where they ended.

Two fits of nearly the same model may end in different places. An effect that does nothing then looks as if it did
what the other way did; so the model without it is fitted from there too.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.effort import POLISH
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.parameter_set import Free

SLIGHT = 0.05
"""An effect that takes no more than this share of the squared residuals may have found another way down instead."""


def lessened(bench: Workbench, hypothesis: Hypothesis, candidates: Sequence[Candidate]) -> list[Hypothesis]:
    """The same with less, fitted: without each of its effects, and with each special case of one in its place."""
    work: list[tuple[tuple[Candidate, ...], dict[str, float]]] = []
    for effect in hypothesis.effects:
        rest = hypothesis.without(effect)
        work.append((rest, passed_on(bench.nominal, effect, hypothesis.values)))
        work += [
            ((*rest, special), {**hypothesis.values, **special.taken_over(effect, hypothesis.values)})
            for special in candidates
            if special.is_special_case_of(effect)
        ]
    return bench.side_by_side(lambda item: bench.fit(item[0], item[1], bench.fine, POLISH), work)


def slightly_worse(
    bench: Workbench,
    contenders: Sequence[Hypothesis],
    known: Mapping[frozenset[str], Hypothesis],
    slight: float = SLIGHT,
) -> list[Hypothesis]:
    """Every known hypothesis that a contender contains and hardly surpasses, fitted from where that one ended.

    And every one that leaves less there, as it stands, than where it ended itself: then it was another place that made
    the difference, and not the effect.

    Args:
        bench: fits.
        contenders: hypotheses that may win.
        known: all that were fitted, by their keys.
        slight: share of the squared residuals up to which it is hardly surpassed.
    """
    work: dict[frozenset[str], tuple[Hypothesis, Hypothesis, dict[str, float]]] = {}
    for contender in contenders:
        least = contender.fit.objective
        for other in known.values():
            start = start_of_lesser(contender, other, bench.nominal)
            if start is None or not least < other.fit.objective:
                continue
            hardly = other.fit.objective <= (1.0 + slight) * least
            if not hardly and _left(bench, other, start) >= other.fit.objective:
                continue
            if other.ids not in work or least < work[other.ids][0].fit.objective:
                work[other.ids] = (contender, other, start)
    return bench.side_by_side(
        lambda item: bench.fit(item[1].effects, item[2], min(item[0].step, item[1].step), POLISH),
        list(work.values()),
    )


def _left(bench: Workbench, hypothesis: Hypothesis, values: dict[str, float]) -> float:
    """What would be minimised for a hypothesis, at other values of its parameters."""
    problem = bench.problem(hypothesis.effects, hypothesis.step)
    unit = problem.parameters.unit(values)
    both = np.concatenate([problem.residuals(unit), problem.prior_residuals(unit)])
    bench.evaluations += problem.evaluations
    return float(both @ both)


def start_of_lesser(
    hypothesis: Hypothesis, other: Hypothesis, nominal: Sequence[Free]
) -> dict[str, float] | None:
    """Full path -> value where a fit of another hypothesis begins that this one contains; None if it does not.

    It contains what has fewer of its effects, and what has a special case in the place of one.

    Args:
        hypothesis: fitted.
        other: what is to be fitted.
        nominal: the rig's own free parameters.
    """
    own = [c for c in hypothesis.effects if c.size_path not in other.ids]
    if not own:
        return None
    start = dict(hypothesis.values)
    for effect in own:
        start = passed_on(nominal, effect, start)
    for special in other.effects:
        if special.size_path in hypothesis.ids:
            continue
        wider = next((c for c in own if special.is_special_case_of(c)), None)
        if wider is None:
            return None
        start |= special.taken_over(wider, hypothesis.values)
    return start


def passed_on(nominal: Sequence[Free], effect: Candidate, values: dict[str, float]) -> dict[str, float]:
    """Full path -> value with what an effect does done by the joint's own parameters, where they are free to do it."""
    free = {own.path: own for own in nominal}
    shifted = effect.shifted(values)
    able = len(shifted) == len(effect.effect.shifts) and all(
        path in free and free[path].lower <= value <= free[path].upper for path, value in shifted.items()
    )
    return {**values, **shifted} if able else values
