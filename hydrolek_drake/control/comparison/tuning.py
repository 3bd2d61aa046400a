"""Tuning the feedforward law on perturbed machines by random search."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace

import numpy as np

from hydrolek_drake.control.comparison.judging import (
    ERROR_DEG,
    OVERSHOOT_PERCENT,
    RISE_SHARE,
    Case,
    Verdict,
    judge,
)
from hydrolek_drake.control.laws.feedforward import FeedforwardLaw
from hydrolek_drake.control.laws.feedforward_tuning import FeedforwardTuning, tuning_data
from hydrolek_drake.control.laws.rate_map import RateMap
from hydrolek_drake.control.thesis_gains import sample_s, voltage_limit_V


def cost(verdicts: Sequence[Verdict]) -> float:
    """Mean over the cases: how far each aim is missed, and a little of what is always wanted less of."""
    weights = {key: float(item["value"]) for key, item in tuning_data()["cost"].items()}
    margin = weights["margin"]
    total = 0.0
    for verdict in verdicts:
        share = verdict.rise_share if np.isfinite(verdict.rise_s) else weights["never"]
        total += weights["rise"] * max(0.0, share - 1.0 - margin * (RISE_SHARE - 1.0)) + (share - 1.0)
        total += weights["overshoot"] * max(0.0, verdict.overshoot_percent - margin * OVERSHOOT_PERCENT)
        total += weights["error"] * max(0.0, verdict.error_deg - margin * ERROR_DEG)
        total += weights["switching"] * verdict.switching
    return total / len(verdicts)


def tune(
    start: FeedforwardTuning,
    maps: Mapping[str, RateMap],
    cases: Sequence[Case],
    trials: int,
    generator: np.random.Generator,
    on_better: Callable[[int, float, FeedforwardTuning], None] | None = None,
) -> tuple[FeedforwardTuning, float]:
    """Random search: each trial changes some numbers of the best tuning so far by random factors.

    Args:
        start: first tuning.
        maps: rate map of each joint in the cases.
        cases: machines and steps.
        trials: how many tunings are tried.
        generator: of the changes.
        on_better: called with trial, cost and tuning when a better one is found; may raise to stop.

    Returns:
        Best tuning and its cost.
    """
    search = {key: float(item["value"]) for key, item in tuning_data()["search"].items()}
    ranges = tuning_data()["ranges"]

    def evaluate(candidate: FeedforwardTuning) -> float:
        def law_for(joint: str) -> FeedforwardLaw:
            return FeedforwardLaw(maps[joint], sample_s(), voltage_limit_V(), candidate)

        seed = int(search["seed"])
        return cost(
            [
                # what can only be learned is judged after learning
                judge(law_for(case.joint), case, seed + i, learned=case.condition.dead_zone != 1.0)
                for i, case in enumerate(cases)
            ]
        )

    best, least = start, evaluate(start)
    width = search["first_width"]
    for trial in range(trials):
        changes = {}
        for key, value in asdict(best).items():
            if generator.random() >= search["changed"]:
                continue
            low, high = map(float, ranges[key])
            drawn = value * float(np.exp(width * generator.standard_normal()))
            changes[key] = float(min(max(drawn, low), high))
        candidate = replace(best, **changes)
        found = evaluate(candidate)
        if found < least:
            best, least = candidate, found
            if on_better is not None:
                on_better(trial, least, best)
        width = max(search["last_width"], width * search["shrink"])
    return best, least
