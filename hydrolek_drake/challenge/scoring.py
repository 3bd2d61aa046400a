"""How a diagnosis did on a concealed case, and on all of them."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from hydrolek_drake.challenge.build import BENCH
from hydrolek_drake.challenge.drawing import SHOWS
from hydrolek_drake.diagnosis.settings import NOISE

BINS = (0.0, 0.5, 0.7, 0.9, 0.99, 1.0 + 1e-9)
"""Edges of the probabilities for the calibration."""


def score(case: Mapping[str, Any], report: Mapping[str, Any]) -> dict[str, Any]:
    """What was right about one report.

    Args:
        case: the label, as in `cases.Case`.
        report: `report.json`.
    """
    truth = set(case["effects"])
    named = {e["id"] for e in report["effects"] if not e["id"].startswith("unlisted.")}
    stages = [place["stage"] for place in report["locations"]]
    baseline = (report["fit"] or {}).get("baseline", {})
    result = {
        "name": case["name"],
        "rig": case.get("rig", BENCH),
        "kind": case["kind"],
        "size": case["size"],
        "drive": case["drive"],
        "pressures": case["pressures"],
        "truth": sorted(truth) or sorted(case["unlisted"]),
        "verdict": report["verdict"],
        "named": sorted(named),
        "shows": _shown(case),
        "stage": stages[0] if stages else None,
        "probability": min((e["probability"] for e in report["effects"]), default=None),
        "seconds": report["seconds"],
        "holdout_over_noise": (report["fit"] or {}).get("with_effects", {}).get("holdout_over_noise"),
        "baseline_over_noise": baseline.get("train_over_noise"),
        "baseline_holdout_over_noise": baseline.get("holdout_over_noise"),
    }
    if case["kind"] == "healthy":
        result["right"] = report["verdict"] == "none"
        result["right_stage"] = result["right"]
    elif case["kind"] == "unlisted":
        result["right"] = report["verdict"] == "unlisted_physics"
        result["right_stage"] = case["stages"][0] in stages[:1]
    else:
        group = {effect for g in report["not_distinguishable"] for effect in g}
        result["right"] = named == truth and report["verdict"] == "missing_physics"
        result["in_group"] = bool(truth & group)
        result["right_stage"] = set(case["stages"]) <= set(stages)
        result["parameter_errors"] = _errors(case["effects"], report["effects"])
        result["intervals_hold"] = _held(case["effects"], report["effects"])
    return result


def _shown(case: Mapping[str, Any]) -> dict[str, float]:
    """Effect -> how many times the noise it shows; old labels tell only how many were wanted."""
    told: dict[str, float] = case.get("shows", {})
    wanted = SHOWS.get(case["size"], 0.0)
    return told or dict.fromkeys([*case["effects"], *case["unlisted"]], wanted)


def _errors(truth: Mapping[str, Mapping[str, float]], told: Sequence[Mapping[str, Any]]) -> list[float]:
    return [abs(known["value"] - value) / abs(value) for value, known in _numbers(truth, told) if value]


def _held(truth: Mapping[str, Mapping[str, float]], told: Sequence[Mapping[str, Any]]) -> list[bool]:
    """Whether the 95 % interval of each number of the effects that are named rightly holds the true value."""
    return [bool(known["low"] <= value <= known["high"]) for value, known in _numbers(truth, told)]


def _numbers(
    truth: Mapping[str, Mapping[str, float]], told: Sequence[Mapping[str, Any]]
) -> Iterator[tuple[float, Mapping[str, float]]]:
    """True value and what is told of it, of each number of the effects that are named rightly."""
    found = {e["id"]: e["parameters"] for e in told}
    for effect in truth.keys() & found.keys():
        for name, value in truth[effect].items():
            yield value, found[effect][name]


def summary(results: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Shares over all cases."""
    of = {
        kind: [r for r in results if r["kind"] == kind]
        for kind in ("healthy", "single", "double", "unlisted")
    }
    visible = [r for r in of["single"] if r["size"] != "barely" and _shows(r)]
    errors = [error for r in results for error in r.get("parameter_errors", [])]
    seconds = [r["seconds"] for r in results]
    return {
        "cases": len(results),
        "false_alarms": _told([not r["right"] for r in of["healthy"]]),
        "visible_singles_right": _told([r["right"] for r in visible]),
        "visible_singles_right_stage": _told([r["right_stage"] for r in visible]),
        "visible_singles_beyond_a_refit_right": _told([r["right"] for r in visible if _beyond_a_refit(r)]),
        "barely_visible_singles_right": _told([r["right"] for r in of["single"] if r not in visible]),
        "doubles_right": _told([r["right"] for r in of["double"]]),
        "unlisted_recognised": _told([r["right"] for r in of["unlisted"]]),
        "unlisted_right_stage": _told([r["right_stage"] for r in of["unlisted"]]),
        "intervals_that_hold": _told([held for r in results for held in r.get("intervals_hold", [])]),
        "median_parameter_error": float(np.median(errors)) if errors else None,
        "median_seconds": float(np.median(seconds)) if seconds else None,
        "median_seconds_healthy": float(np.median([r["seconds"] for r in of["healthy"]]))
        if of["healthy"]
        else None,
        "calibration": _calibration(results),
    }


def summaries(results: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Shares over all cases, over the bench's and the arms', and over each rig's."""
    groups: dict[str, list[Mapping[str, Any]]] = {"all": list(results)}
    groups["bench"] = [r for r in results if r["rig"] == BENCH]
    groups["arms"] = [r for r in results if r["rig"] != BENCH]
    for name in sorted({r["rig"] for r in groups["arms"]}):
        groups[name] = [r for r in results if r["rig"] == name]
    return {name: summary(members) for name, members in groups.items() if members or name == "all"}


def summaries_markdown(told_by: Mapping[str, Mapping[str, Any]]) -> str:
    """One row a share, one column a group of rigs."""
    rows = [name for name in next(iter(told_by.values())) if name != "calibration"]
    lines = ["| | " + " | ".join(told_by) + " |", "|---" * (len(told_by) + 1) + "|"]
    lines += [
        f"| {row.replace('_', ' ')} | " + " | ".join(_cell(told[row]) for told in told_by.values()) + " |"
        for row in rows
    ]
    return "\n".join(lines) + "\n"


def _cell(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"{value['count']} of {value['of']}" if value["of"] else "-"
    return "-" if value is None else f"{value:.3g}"


def _shows(result: Mapping[str, Any]) -> bool:
    """Whether effects show as visible ones should; the largest sensible size may not."""
    return all(shown > 0.5 * SHOWS["middle"] for shown in result["shows"].values())


def _beyond_a_refit(result: Mapping[str, Any]) -> bool:
    """Whether the nominal model, refitted, leaves more of either recording than the noise level is uncertain by.

    Of an effect that other nominal numbers stand for just as well, the data hold nothing.
    """
    left = (result["baseline_over_noise"], result["baseline_holdout_over_noise"])
    return any(each is not None and each > NOISE.above for each in left)


def _told(right: Sequence[bool]) -> dict[str, Any]:
    return {"count": sum(right), "of": len(right), "share": sum(right) / len(right) if right else None}


def _calibration(results: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Of the effects named with a probability in each bin, how many were right."""
    named = [r for r in results if r["named"] and r["probability"] is not None]
    told = []
    for low, high in itertools.pairwise(BINS):
        inside = [r for r in named if low <= r["probability"] < high]
        mean = float(np.mean([r["probability"] for r in inside])) if inside else None
        told.append({"from": low, "to": min(high, 1.0), "mean": mean, **_told([r["right"] for r in inside])})
    return told


def markdown(results: Sequence[Mapping[str, Any]]) -> str:
    """Every case in a table, failures first."""
    lines = [
        "| case | rig | kind | size | drive | pressures | concealed | verdict | named | p | right | s |",
        "|---" * 12 + "|",
    ]
    for r in sorted(results, key=lambda r: (r["right"], r["name"])):
        p = "" if r["probability"] is None else f"{r['probability']:.2f}"
        lines.append(
            f"| {r['name']} | {r['rig']} | {r['kind']} | {r['size']} | {r['drive']} | "
            f"{'yes' if r['pressures'] else 'no'} | {', '.join(r['truth'])} | {r['verdict']} | "
            f"{', '.join(r['named'])} | {p} | "
            f"{'yes' if r['right'] else 'NO'} | {r['seconds']:.0f} |"
        )
    return "\n".join(lines) + "\n"
