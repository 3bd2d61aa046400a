"""Terms of laws that may be added to a structure."""

from collections.abc import Mapping, Sequence

import numpy as np

from hydrolek_drake.diagnosis.laws.additions import LawTerm
from hydrolek_drake.diagnosis.laws.inputs import Input, inputs_of
from hydrolek_drake.diagnosis.laws.terms import Span, span_of
from hydrolek_drake.diagnosis.locating.law_forms import STEADY, terms_seen
from hydrolek_drake.diagnosis.locating.unknown_input import Estimate, Slightly, near, unknown_inputs
from hydrolek_drake.diagnosis.lost_commands.seen import lost_seen
from hydrolek_drake.diagnosis.lost_commands.windows import LostWindows
from hydrolek_drake.diagnosis.settings import LOCATING
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.rollout.rollout import Signals


def terms_for(
    bench: Workbench, parent: Hypothesis, scales: Mapping[str, Scales], cores: int
) -> tuple[LawTerm | LostWindows, ...]:
    """What in no list may explain what a structure leaves: terms that promise most, and commands that got lost.

    These are asked for beside the nominal model, since windows fit a little of whatever a structure leaves.

    Args:
        bench: data and problems.
        parent: the structure.
        scales: natural scales of the joints.
        cores: that roll out at the same time.
    """
    joint = _followed_worst(bench, parent, list(scales))
    if len(scales) > 1:  # what the others do to it is an input, as an observer of each has measured it
        bench = bench.with_training([e for e in bench.training if e.joint == joint])
    inputs = _inputs(bench, joint, scales[joint])
    has = {c.input.probe for c in parent.effects if isinstance(c, LawTerm)}
    inputs = tuple(each for each in inputs if not has or each.probe in has)
    values = near(bench, parent, LOCATING.observer_s, cores)
    seen = unknown_inputs(bench, parent, values, [Slightly(i) for i in inputs], LOCATING.observer_s, cores)
    parameters = bench.parameters(parent.effects)
    record = parameters.records(parameters.unit(values))[bench.training[0].index]
    span = _span(bench, seen.signals, record, joint)
    ranked = [term for gain, term in terms_seen(seen, record, joint, span) if gain > 0.0]
    ranked = [term for term in ranked if term.size_path not in parent.ids]
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
    lost = lost_seen(bench, parent, command, float(record["command"]["neutral"]), {}, span, cores)
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


def estimates_for(
    bench: Workbench, nominal: Hypothesis, joint: str, scales: Scales, cores: int
) -> tuple[Estimate, ...]:
    """The most likely course of every unknown input around the nominal model, the likeliest first.

    Args:
        bench: data and problems.
        nominal: the nominal model, fitted.
        joint: at which inputs are asked for.
        scales: its natural scales.
        cores: that roll out at the same time.
    """
    inputs = [Slightly(i) for i in _inputs(bench, joint, scales) if i.probe not in STEADY]
    values = near(bench, nominal, LOCATING.observer_s, cores)
    seen = unknown_inputs(bench, nominal, values, inputs, LOCATING.observer_s, cores)
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
