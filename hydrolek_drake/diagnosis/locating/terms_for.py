"""Terms of laws that may be added: which function of time and movement follows what an unknown input must have been."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from hydrolek_drake.diagnosis.locating.lost_windows_seen import lost_seen
from hydrolek_drake.diagnosis.locating.unknown_input import (
    Estimate,
    Seen,
    Unknown,
    near,
    unknown_inputs,
)
from hydrolek_drake.diagnosis.settings import LOCATING
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.inputs import SIDES, Input, inputs_of
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm
from hydrolek_drake.diagnosis.structures.lost_windows import LostWindows
from hydrolek_drake.diagnosis.structures.term_forms import TERMS, Span, law_record, span_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.rollout.one_point import law_along, stroke_and_lever
from hydrolek_drake.rollout.rollout import Signals
from hydrolek_drake.rollout.run import Run


@dataclass(frozen=True)
class Slightly:
    """An input that is moved so little that all answers to it are linear; its unit is its scale."""

    input: Input
    share: ClassVar[float] = LOCATING.amplitude
    spacing_s: ClassVar[float] = LOCATING.knots_s

    def run(
        self, experiment: Experiment, records: np.ndarray, step: float, pull: float | None, moved: np.ndarray
    ) -> Run:
        """See `knot_responses.Trial`."""
        rows = np.zeros((moved.size, len(PROBES)))
        rows[moved, PROBES.index(self.input.probe)] = LOCATING.amplitude * self.input.scale
        return experiment.run(records, step, (LOCATING.knots_s, rows), pull)


def terms_for(
    bench: Workbench, parent: Hypothesis, scales: Mapping[str, Scales]
) -> tuple[LawTerm | LostWindows, ...]:
    """What in no list may explain what a structure leaves: terms that promise most, and commands that got lost.

    These are asked for beside the nominal model, since windows fit a little of whatever a structure leaves.

    Args:
        bench: data and problems.
        parent: the structure.
        scales: natural scales of the joints.
    """
    joint = _followed_worst(bench, parent, list(scales))
    if len(scales) > 1:  # what the others do to it is an input, as an observer of each has measured it
        bench = bench.with_training([e for e in bench.training if e.joint == joint])
    inputs = _inputs(bench, joint, scales[joint])
    by_probe = {each.probe: each for each in inputs}
    across = {one: by_probe.get(other) for one, other in (SIDES, SIDES[::-1])}
    has = {c.input.probe for c in parent.effects if isinstance(c, LawTerm)}
    inputs = tuple(each for each in inputs if not has or each.probe in has)
    values = near(bench, parent, LOCATING.observer_s)
    seen = unknown_inputs(bench, parent, values, [Slightly(i) for i in inputs], LOCATING.observer_s)
    parameters = bench.parameters(parent.effects)
    record = parameters.records(parameters.unit(values))[bench.training[0].index]
    span = _span(bench, seen.signals, record, joint)
    promised = [term for gain, term in terms_seen(seen, record, joint, span) if gain > 0.0]
    own = [t for t in promised if t.size_path not in parent.ids and not t.is_listed]
    ranked = [replace(t, across=across.get(t.input.probe)) for t in own]
    taken: dict[str, int] = {}
    first: list[LawTerm] = []
    rest: list[LawTerm] = []
    for term in ranked:
        taken[term.input.probe] = taken.get(term.input.probe, 0) + 1
        (first if taken[term.input.probe] <= LOCATING.each else rest).append(term)
    terms = [*first, *rest][: max(LOCATING.offered, len(first))]
    if parent.effects or len(scales) > 1:
        return tuple(terms)
    command = next(each for each in _inputs(bench, joint, scales[joint]) if each.probe == "command")
    lost = lost_seen(bench, parent, command, float(record["command"]["neutral"]), {}, span)
    return (*terms, lost) if lost is not None else tuple(terms)


def _followed_worst(bench: Workbench, parent: Hypothesis, joints: Sequence[str]) -> str:
    """The joint whose recordings a structure follows worst, for their noise."""
    ends = np.cumsum([0, *(len(e.channels) * e.time.size for e in bench.training)])
    squares, counted = dict.fromkeys(joints, 0.0), dict.fromkeys(joints, 1)
    for experiment, begin, end in zip(bench.training, ends[:-1], ends[1:], strict=True):
        if experiment.joint in squares:
            squares[experiment.joint] += float(np.sum(parent.fit.residuals[begin:end] ** 2))
            counted[experiment.joint] += experiment.counted
    return max(joints, key=lambda joint: squares[joint] / counted[joint])


def estimates_for(bench: Workbench, nominal: Hypothesis, joint: str, scales: Scales) -> tuple[Estimate, ...]:
    """The most likely course of every unknown input around the nominal model, the likeliest first.

    Args:
        bench: data and problems.
        nominal: the nominal model, fitted.
        joint: at which inputs are asked for.
        scales: its natural scales.
    """
    inputs = [Slightly(i) for i in _inputs(bench, joint, scales) if i.probe not in STEADY]
    values = near(bench, nominal, LOCATING.observer_s)
    seen = unknown_inputs(bench, nominal, values, inputs, LOCATING.observer_s)
    return tuple(sorted((u.estimated() for u in seen.unknowns), key=lambda e: -e.evidence))


def _inputs(bench: Workbench, joint: str, scales: Scales) -> tuple[Input, ...]:
    """The unknown inputs of a joint."""
    pressure = bench.rig.value("supply.pressure")
    limit = bench.rig.value(f"joints.{joint}.command.limit")
    return inputs_of(scales, pressure, limit, bench.training[0].channels[0].unit)


def _span(bench: Workbench, signals: tuple[Signals, ...], record: np.void, joint: str) -> Span:
    """What the variables of laws are told in, as an observer saw the machine move."""
    return span_of(
        signals,
        record,
        max(float(np.ptp(e.time)) for e in bench.training),
        bench.training[0].channels[0].unit,
        "m" if bench.rig.variant(joint, "cylinder") == "cylinder" else "rad",
    )


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
    angles = 2.0 * np.pi * np.outer(unknown.times, frequencies)
    gains, pairs = unknown.gains_of_pairs(np.sin(angles), np.cos(angles))
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
