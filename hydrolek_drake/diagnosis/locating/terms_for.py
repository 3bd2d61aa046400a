"""Terms of laws that may be added to a structure."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.fitting.lockstep import Place, descend
from hydrolek_drake.diagnosis.laws.additions import LawTerm
from hydrolek_drake.diagnosis.laws.inputs import Input, inputs_of
from hydrolek_drake.diagnosis.laws.terms import Span, span_of
from hydrolek_drake.diagnosis.locating.law_forms import STEADY, terms_seen
from hydrolek_drake.diagnosis.locating.unknown_input import Estimate, unknown_inputs
from hydrolek_drake.diagnosis.lost_commands.share import share_lost
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.rollout.rollout import Signals

OBSERVER_S = 0.3
"""Time constant of the observer whose innovations tell of unknown inputs [s]: longer than a valve takes to open, and
far shorter than a move."""

FITTED = 3
"""Steps by which the structure's own parameters are fitted to these innovations before."""

EACH = 3
"""So many terms of each input are offered, and the best of all beyond these."""

OFFERED = 20


@dataclass(frozen=True)
class Offer:
    """What in no list may explain what a structure leaves.

    Attributes:
        terms: of laws, the most promising first.
        lost: which share of it commands that got lost would take.
        span: what laws are told in.
    """

    terms: tuple[LawTerm, ...]
    lost: float
    span: Span


def terms_for(bench: Workbench, parent: Hypothesis, scales: Mapping[str, Scales], cores: int) -> Offer:
    """Terms that promise most beside a structure, and what lost commands do.

    Args:
        bench: data and problems.
        parent: the structure.
        scales: natural scales of the joints.
        cores: that roll out at the same time.
    """
    joint = next(iter(scales))
    inputs = _inputs(bench, joint, scales[joint])
    has = {c.input.probe for c in parent.effects if isinstance(c, LawTerm)}
    inputs = tuple(each for each in inputs if not has or each.probe in has)
    values = _near(bench, parent, cores)
    seen = unknown_inputs(bench, parent, values, inputs, OBSERVER_S, cores)
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
        (first if taken[term.input.probe] <= EACH else rest).append(term)
    lost = 0.0
    if not parent.effects:
        command = next(u for u in seen.unknowns if u.input.probe == "command")
        lost = share_lost(
            command,
            bench.training,
            float(record["command"]["neutral"]),
            sum(e.counted for e in bench.training),
        )
    return Offer(tuple([*first, *rest][: max(OFFERED, len(first))]), lost, span)


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
    inputs = tuple(i for i in _inputs(bench, joint, scales) if i.probe not in STEADY)
    values = _near(bench, nominal, cores)
    seen = unknown_inputs(bench, nominal, values, inputs, OBSERVER_S, cores)
    return tuple(sorted((u.estimated() for u in seen.unknowns), key=lambda e: -e.evidence))


def _near(bench: Workbench, parent: Hypothesis, cores: int) -> dict[str, float]:
    """Full path -> value of a structure's parameters where an observer's innovations are small, from the rig's own."""
    own = {path: value for path, value in parent.values.items() if ".effects." in path or ".law." in path}
    problem = bench.problem(parent.effects, 2.0 * bench.fine, bench.training, OBSERVER_S)
    moving = bench.movable(parent.effects, problem.parameters)
    begun = Place(problem, moving, np.clip(problem.parameters.unit(own), 1e-6, 1.0 - 1e-6))
    return problem.parameters.values(descend([begun], FITTED, bench.pool, cores)[0].unit)


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
