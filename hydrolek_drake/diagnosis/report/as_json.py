"""`report.json`, as the contract promises it."""

import math
from dataclasses import asdict
from typing import Any

import numpy as np

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.laws.law import FoundLaw, amplitude_intervals, frequency_interval
from hydrolek_drake.diagnosis.locating.place import left_at
from hydrolek_drake.diagnosis.report.panels import after
from hydrolek_drake.diagnosis.report.reliability import kind_of, reliability
from hydrolek_drake.diagnosis.report.words import (
    effect_sentence,
    headline,
    known_to,
    law_sentence,
    off_zero_sentences,
    path_of,
    quantity,
    unit_at,
    where_sentence,
)
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.replay.display import display_factor, display_unit

MOST_LISTED = 12
"""So many hypotheses are listed."""


def as_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """The report as a tree."""
    report: dict[str, Any] = {
        "schema": 1,
        "verdict": diagnosis.verdict,
        "sentence": headline(diagnosis),
        "locations": [
            {
                "stage": place.stage,
                "joint": place.joint,
                "share_of_mismatch": round(place.share, 4),
                "when": [[round(a, 3), round(b, 3)] for a, b in place.when],
                "condition": place.condition,
            }
            for place in diagnosis.locations
        ],
        "effects": effects_json(diagnosis),
        "not_zero": off_zero_sentences(diagnosis),
        "not_distinguishable": [list(g) for g in diagnosis.conclusion.groups] if diagnosis.conclusion else [],
        "next_experiment": diagnosis.proposal.sentence if diagnosis.proposal else None,
        "detectable_from": detectable(diagnosis),
        "fit": fit_json(diagnosis),
        "candidates": candidates_json(diagnosis),
        "reasons": list(diagnosis.reasons),
        "seconds": round(diagnosis.seconds, 1),
    }
    return report


def effects_json(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """What was added to the model, the most probable first; of its numbers those that were fitted."""
    if diagnosis.conclusion is None:
        return []
    told: list[dict[str, Any]] = []
    for candidate in diagnosis.best.hypothesis.listed:
        parameters = {}
        for parameter in candidate.effect.parameters:
            known = diagnosis.intervals.get(path_of(candidate, parameter))
            if known is not None:
                parameters[parameter.name] = {"value": known.value, "low": known.low, "high": known.high}
        told.append(
            {
                "id": candidate.id,
                "joint": candidate.joint,
                "probability": round(_probability(diagnosis, candidate.size_path), 4),
                "parameters": parameters,
                "sentence": effect_sentence(candidate, diagnosis),
            }
        )
    if diagnosis.law is not None:
        told.append(_law_json(diagnosis, diagnosis.law))
    return sorted(told, key=lambda entry: -entry["probability"])


def _law_json(diagnosis: Diagnosis, law: FoundLaw) -> dict[str, Any]:
    known = law.law.input
    parameters: dict[str, dict[str, Any]] = {}
    intervals = amplitude_intervals(law)
    for number, size in enumerate(law.amplitudes):
        key = "amplitude" if number == 0 else f"amplitude_{number + 1}"
        parameters[key] = {"value": size, "unit": known.unit}
        if intervals:
            parameters[key] |= {"low": intervals[number].low, "high": intervals[number].high}
        if not law.law.periodic:
            parameters[key]["of"] = law.names[number]
    if law.law.periodic:
        frequency = frequency_interval(law)
        parameters["frequency"] = {**asdict(frequency), "unit": "Hz"}
    return {
        "id": f"unlisted.{known.stage}",
        "joint": law.joint,
        # stages that the data do not tell apart share it
        "probability": round(_law_posterior(diagnosis, law) * reliability("law") / (1 + len(law.rivals)), 4),
        "parameters": parameters,
        "holdout_over_noise": law.held_out_over_noise,
        **law.more(),
        "sentence": f"{law_sentence(law)}{known_to(law)}{where_sentence(law)}",
    }


def _probability(diagnosis: Diagnosis, path: str) -> float:
    """That an effect of the best model is there: posterior among what was tried, as far as that can be trusted."""
    assert diagnosis.conclusion is not None
    return diagnosis.conclusion.probability[path] * reliability(kind_of(diagnosis, path))


def _law_posterior(diagnosis: Diagnosis, law: FoundLaw) -> float:
    """Probability of the law beside the best known effects, by held-out likelihood made as flat as its misfit."""
    before, counted = left_at(law.joint, diagnosis.best.held_out, diagnosis.held_out)
    excess = max(1.0, law.held_out_over_noise**2 * counted - counted)
    log_odds = 0.5 * (before - law.held_out_over_noise**2 * counted)
    return 1.0 / (1.0 + math.exp(-float(np.clip(log_odds * len(law.fit.unit) / excess, -50.0, 50.0))))


def models_of(diagnosis: Diagnosis, fit: dict[str, Any]) -> list[tuple[str, dict[str, float]]]:
    """The models of `fit_json` in words, each with its errors."""
    told = [("nominal model, refitted", fit["baseline"])]
    if "without_law" in fit:
        told.append(("with the effects named", fit["without_law"]))
    if diagnosis.law is not None:
        told.append(("with the law found", fit["with_effects"]))
    elif diagnosis.best.hypothesis.effects:
        told.append(("with the effects named", fit["with_effects"]))
    return told


def detectable(diagnosis: Diagnosis) -> dict[str, str]:
    """Effect -> smallest size that these data would have shown."""
    found = {}
    for visible in diagnosis.visible:
        effect = visible.candidate.effect
        size = next(p for p in effect.parameters if p.name == effect.size)
        unit = unit_at(diagnosis.rig, visible.candidate, size.unit)
        bound = "at most" if effect.weakens else "at least"
        found[effect.id] = f"{size.meaning}: {bound} {quantity(visible.size, unit)}"
    return found


def fit_json(diagnosis: Diagnosis) -> dict[str, Any] | None:
    """Errors of the position before and with everything that was added, in the unit that people read.

    Where a law was found beside effects, also with these alone.
    """
    if diagnosis.bench is None:
        return None
    training, held_out = diagnosis.bench.training, diagnosis.held_out
    channel = training[0].channels[0]
    factor = display_factor(channel.unit)
    sides = {}
    for name, judged in (("baseline", diagnosis.baseline), ("with_effects", diagnosis.best)):
        hypothesis = judged.hypothesis
        train = diagnosis.bench.residuals(hypothesis, training, hypothesis.step)
        sides[name] = {
            "train_rms": factor * position_rms(training, train),
            "holdout_rms": factor * position_rms(held_out, judged.held_out),
            "train_over_noise": hypothesis.fit.over_noise,
            "holdout_over_noise": judged.over_noise,
        }
    if diagnosis.law is not None:
        train, held = (
            np.concatenate([e.residuals(after(diagnosis, e)) for e in experiments])
            for experiments in (training, held_out)
        )
        if diagnosis.best.hypothesis.effects:
            sides["without_law"] = sides["with_effects"]
        sides["with_effects"] = {
            "train_rms": factor * position_rms(training, train),
            "holdout_rms": factor * position_rms(held_out, held),
            "train_over_noise": _over_noise(training, train),
            "holdout_over_noise": _over_noise(held_out, held),
        }
    return {
        "noise_floor": factor * _mean_noise(training, channel.key),
        "unit": display_unit(channel.unit),
        **sides,
    }


def position_rms(experiments: tuple[Experiment, ...], residuals: np.ndarray) -> float:
    """Root mean square of the positions' residuals [SI], from residuals in units of the noise."""
    squared, count, place = 0.0, 0, 0
    for experiment in experiments:
        for index, channel in enumerate(experiment.channels):
            part = residuals[place : place + experiment.time.size]
            place += experiment.time.size
            if index == 0:
                squared += float(np.sum((part * channel.deviation) ** 2))
                count += experiment.counted_of(channel)
    return math.sqrt(squared / max(count, 1))


def _over_noise(experiments: tuple[Experiment, ...], residuals: np.ndarray) -> float:
    return math.sqrt(float(residuals @ residuals) / max(sum(e.counted for e in experiments), 1))


def _mean_noise(experiments: tuple[Experiment, ...], key: str) -> float:
    levels = [c.noise for e in experiments for c in e.channels[:1] if c.key == key]
    return float(np.sqrt(np.mean(np.square(levels))))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def candidates_json(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """The hypotheses that were compared on held-out data, the most probable first."""
    return [
        {
            "effects": [c.id for c in judged.hypothesis.effects],
            "probability": round(judged.probability, 6),
            "train_over_noise": judged.hypothesis.fit.over_noise,
            "holdout_over_noise": judged.over_noise,
            "behind": _finite(judged.behind),
            "behind_standard_error": _finite(judged.behind_error),
        }
        for judged in diagnosis.judged[:MOST_LISTED]
    ] + [
        {
            "effects": [c.id for c in judged.hypothesis.effects],
            "probability": 0.0,
            "given_up": True,
            "train_over_noise": judged.hypothesis.fit.over_noise,
            "holdout_over_noise": judged.over_noise,
        }
        for judged in diagnosis.also_tried[:MOST_LISTED]
    ]
