"""What the page is told: signals, innovations, alarms, effects, the link and what happened, as JSON."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from hydrolek_drake.replay.display import display_factor, display_unit
from hydrolek_drake.replay.readings import position_key
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.asking import OWN_NUMBERS
from hydrolek_drake.watching.live.detecting import STATISTICS
from hydrolek_drake.watching.live.following import Follower, Observed
from hydrolek_drake.watching.live.series import WindowSeries
from hydrolek_drake.watching.live.settings import WINDOW_S
from hydrolek_drake.watching.live.sources import Link
from hydrolek_drake.watching.words import beside_text, headline, size_text, title_of

_DIGITS = 6


def description(rig: Rig, joints: Sequence[str]) -> dict[str, Any]:
    """What does not change: title, joints and units."""
    units = ["m" if position_key(rig, joint).endswith(".position") else "rad" for joint in joints]
    return {
        "title": f"Live watch of {rig.name}",
        "joints": list(joints),
        "units": [display_unit(unit) for unit in units],
        "pressure_unit": display_unit("Pa"),
    }


def samples_of(rig: Rig, joints: Sequence[str], samples: Sequence[Observed]) -> list[list[Any]]:
    """Samples as rows: number, time, judged, and of each joint command, measured, modelled and innovations.

    Args:
        rig: the machine.
        joints: in the order of the rows.
        samples: to be shown.
    """
    position = [
        display_factor("m" if position_key(rig, joint).endswith(".position") else "rad") for joint in joints
    ]
    factors = np.column_stack([position, *[np.full(len(joints), display_factor("Pa"))] * 2])
    rows = []
    for each in samples:
        flat = np.column_stack(
            [each.volts, each.measured * factors, each.modelled * factors, each.innovations]
        )
        rows.append([each.number, round(each.time, 4), int(each.settled), [_numbers(row) for row in flat]])
    return rows


def status(
    follower: Follower, series: WindowSeries, link: Link, busy: bool, passed_over: int
) -> dict[str, Any]:
    """Everything but the samples.

    Args:
        follower: of the stream.
        series: of the windows.
        link: how the source does.
        busy: whether a window is being asked.
        passed_over: windows that were not asked.
    """
    alarms = [text for text in (series.alarmed, follower.alarm_text) if text]
    return {
        "alarm": alarms,
        "settled": follower.settled,
        "link": {
            "name": link.name,
            "state": link.state,
            "text": link.text,
            "bad": link.bad,
            "dropped": link.dropped,
            **follower.merger.counts.as_dict(),
        },
        "events": [
            {"time": _moment(e.time), "kind": e.kind, "text": e.text, "now": e.now} for e in follower.events
        ],
        "innovations": _innovations(follower),
        "windows": _windows(series, follower, busy, passed_over),
    }


def _innovations(follower: Follower) -> list[dict[str, Any]]:
    """Of each joint: the evidence over the threshold, of the channel that has most."""
    detector, block = follower.detector, follower.last_block
    rows = []
    for place, joint in enumerate(follower.joints):
        evidence = detector.evidence[:, place]
        known = np.isfinite(evidence)
        where = np.unravel_index(int(np.argmax(np.where(known, evidence, -np.inf))), evidence.shape)
        level = float(evidence[where]) if known.any() else 0.0
        rows.append(
            {
                "joint": joint,
                "share": _number(max(level, 0.0) / detector.threshold),
                "what": STATISTICS[int(where[0])],
                "since": _moment(float(detector.since[where[0], place, where[1]])),
                "mean": _number(float(block.mean[place, 0])) if block is not None else None,
                "rms": _number(math.sqrt(float(block.square[place, 0]))) if block is not None else None,
            }
        )
    return rows


def _windows(series: WindowSeries, follower: Follower, busy: bool, passed_over: int) -> dict[str, Any]:
    told: dict[str, Any] = {
        "count": series.count,
        "passed_over": passed_over,
        "busy": busy,
        "asks": follower.asks,
        "length": WINDOW_S,
        "gathered": round(follower.windows.seconds, 1),
        "headline": headline(series.watched()) if series.count else "",
        "effects": [],
    }
    latest = series.latest
    if latest is None or latest[0].answer is None:
        return told
    seen, judgement = latest
    assert seen.answer is not None
    told["time"] = seen.stamp.iso
    for each in seen.answer.effects:
        key = f"{each.joint}.{each.effect}" if each.joint else each.effect
        own = each.effect == OWN_NUMBERS
        told["effects"].append(
            {
                "effect": each.effect,
                "joint": each.joint,
                "title": title_of(each.effect),
                "size": f"{each.size:.3g} of a range" if own else size_text(each),
                "beside": beside_text(each),
                "gain": _number(each.gain),
                "threshold": _number(judgement.thresholds[key]),
                "beyond": each.effect in judgement.beyond,
            }
        )
    return told


def _numbers(values: np.ndarray) -> list[float | None]:
    return [_number(value) for value in values.tolist()]


def _moment(seconds: float) -> float | None:
    """A time, which may be that of a calendar and has more digits than a number that is shown."""
    return round(seconds, 4) if math.isfinite(seconds) else None


def _number(value: float) -> float | None:
    """A number for JSON, which knows no NaN."""
    return float(f"{value:.{_DIGITS}g}") if math.isfinite(value) else None
