"""Terms of laws read from unknown inputs: which function of time and movement follows what an input must have been."""

import numpy as np

from hydrolek_drake.diagnosis.laws.additions import LawTerm
from hydrolek_drake.diagnosis.laws.terms import TERMS, Span, law_record
from hydrolek_drake.diagnosis.locating.unknown_input import Seen, Unknown
from hydrolek_drake.diagnosis.settings import LOCATING
from hydrolek_drake.rollout.one_point import law_along, stroke_and_lever
from hydrolek_drake.rollout.rollout import Signals

STEADY = ("capacity_a", "capacity_b", "back_a", "back_b", "ramp", "coil_time", "flow_force")
"""Inputs that say how something is built, which no disturbance shakes."""


def terms_seen(seen: Seen, record: np.void, joint: str, span: Span) -> list[tuple[float, LawTerm]]:
    """Every term that has a physical meaning, with the fall of the squares that it promises, the best first.

    Args:
        seen: unknown inputs.
        record: the joint's parameters.
        joint: its name.
        span: what laws are told in.
    """
    rows, moments = _movement(seen, record)
    found: list[tuple[float, LawTerm]] = []
    for unknown in seen.unknowns:
        for term in TERMS:
            if not term.meant_for(unknown.input):
                continue
            values = law_along(law_record(unknown.input.probe, span, term, 1.0)[0], rows)
            gain, multiple = unknown.gain_of(_at_knots(unknown.times, moments, values))
            if unknown.input.one_sided and multiple < 0.0:
                gain = 0.0
            found.append((gain, LawTerm(unknown.input, term, joint, span, seen=(multiple,))))
        if unknown.input.probe not in STEADY:
            found += _periodic(unknown, joint, span)
    return sorted(found, key=lambda each: -each[0])


def _periodic(unknown: Unknown, joint: str, span: Span) -> list[tuple[float, LawTerm]]:
    """Sines that promise most at an input."""
    length = float(np.ptp(unknown.times))
    frequencies = np.arange(LOCATING.lowest / length, LOCATING.highest_hz, 0.25 / length)
    gains, pairs = np.zeros(frequencies.size), []
    for k, frequency in enumerate(frequencies):
        angle = 2.0 * np.pi * frequency * unknown.times
        gains[k], multiples = unknown.gain_of_pair(np.sin(angle), np.cos(angle))
        pairs.append(multiples)
    padded = np.concatenate([[-np.inf], gains, [-np.inf]])
    peaks = np.flatnonzero((padded[1:-1] > padded[:-2]) & (padded[1:-1] >= padded[2:]))
    best = sorted(peaks, key=lambda k: -gains[k])[: LOCATING.peaks]
    return [
        (
            float(gains[k]),
            LawTerm(unknown.input, None, joint, span, float(frequencies[k]), seen=tuple(pairs[k].tolist())),
        )
        for k in best
    ]


def _movement(seen: Seen, record: np.void) -> tuple[np.ndarray, np.ndarray]:
    """What laws may depend on, as rows, and when."""
    parts = [_seen_by_laws(signals, record) for signals in seen.signals]
    rows = np.concatenate(parts)
    return rows, rows[:, 0]


def _at_knots(knots: np.ndarray, moments: np.ndarray, values: np.ndarray) -> np.ndarray:
    """A course at the knots; recordings follow one another, each with its own clock."""
    begins = [0, *(np.flatnonzero(np.diff(moments) < 0.0) + 1), len(moments)]
    firsts = [0, *(np.flatnonzero(np.diff(knots) < 0.0) + 1), len(knots)]
    parts = [
        np.interp(knots[a:b], moments[i:j], values[i:j])
        for a, b, i, j in zip(firsts[:-1], firsts[1:], begins[:-1], begins[1:], strict=True)
    ]
    return np.concatenate(parts)


def _seen_by_laws(run: Signals, record: np.void) -> np.ndarray:
    """What a law may depend on (`physics.law.Seen` as rows), where the rollout is finite."""
    there = np.isfinite(run.position)
    t, q, w, p_a, p_b, x = (
        each[there]
        for each in (run.time, run.position, run.velocity, run.pressure_a, run.pressure_b, run.spool)
    )
    stroke, lever = np.array([stroke_and_lever(angle, record) for angle in q.tolist()]).T
    return np.stack([t, q, w, stroke, lever * w, p_a, p_b, x], axis=1)
