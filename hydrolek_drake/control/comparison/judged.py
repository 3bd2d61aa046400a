"""Verdicts on changed machines as rows of text and as numbers."""

from collections.abc import Mapping, Sequence
from math import inf, isfinite
from typing import Any

from hydrolek_drake.control.catalogue import CONTROLLERS
from hydrolek_drake.control.comparison.judging import Verdict

Found = Mapping[tuple[str, bool], Sequence[Verdict]]
"""(controller, whether after learning) -> verdicts."""


def as_rows(found: Found) -> tuple[list[str], list[list[str]]]:
    """One row per controller and step, best first: cases that meet objectives and aim, and the worst of each."""
    head = [
        "controller", "step", "objectives met", "aim met", "worst rise [s]", "worst rise / possible",
        "worst overshoot [%]", "worst error [deg]", "mean switching [V²]",
    ]  # fmt: skip
    keyed = sorted(found.items(), key=lambda item: (-_met(item[1]), -_aimed(item[1])))
    return head, [_row(name, learned, verdicts) for (name, learned), verdicts in keyed]


def _row(name: str, learned: bool, verdicts: Sequence[Verdict]) -> list[str]:
    worst = [
        max(_or_never(getattr(verdict, key)) for verdict in verdicts)
        for key in ("rise_s", "rise_share", "overshoot_percent", "error_deg")
    ]
    count = len(verdicts)
    return [
        CONTROLLERS[name][0],
        "third" if learned else "first",
        f"{_met(verdicts)} of {count}",
        f"{_aimed(verdicts)} of {count}",
        *("never" if value == inf else f"{value:.2f}" for value in worst),
        f"{sum(verdict.switching for verdict in verdicts) / count:.3f}",
    ]


def _or_never(value: float) -> float:
    return value if isfinite(value) else inf


def _met(verdicts: Sequence[Verdict]) -> int:
    return sum(verdict.meets_objectives for verdict in verdicts)


def _aimed(verdicts: Sequence[Verdict]) -> int:
    return sum(verdict.meets_aim for verdict in verdicts)


def as_json(found: Found) -> dict[str, Any]:
    """Every case; what is not finite is null."""
    return {
        "schema": 1,
        "cases": [
            {
                "controller": name,
                "step": "third" if learned else "first",
                "joint": v.case.joint,
                "condition": str(v.case.condition),
                "from_deg": v.case.begin_deg,
                "to_deg": v.case.end_deg,
                "possible_rise_s": _finite(v.case.possible_s),
                "rise_s": _finite(v.rise_s),
                "overshoot_percent": _finite(v.overshoot_percent),
                "error_deg": _finite(v.error_deg),
                "largest_deg": _finite(v.largest_deg),
                "switching": _finite(v.switching),
                "meets_objectives": v.meets_objectives,
                "meets_aim": v.meets_aim,
            }
            for (name, learned), verdicts in found.items()
            for v in verdicts
        ],
    }


def _finite(value: float) -> float | None:
    return float(value) if isfinite(value) else None
