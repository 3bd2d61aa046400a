"""Physics in no list: the stage where it enters, when, and a short law for it.

What the best model leaves is held against every law of `laws`, at every stage, by the gain that its response
promises (`law_search`), as for a listed effect. The most promising are fitted together with the nominal parameters
(`law_fit`), and the one that predicts the held-out data best is named; of several that predict alike, the one that
leaves least of all data, where they stand at different stages after a fit to all of them.
Where a periodic disturbance stands in its cycle when a recording begins is no property of the machine, so its phase
is fitted to each recording.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.attempt import FAR_AHEAD
from hydrolek_drake.diagnosis.conclusion import EXPLAINED
from hydrolek_drake.diagnosis.effort import COARSE
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_counterpart import counterpart
from hydrolek_drake.diagnosis.law_fit import STEPS, fitted, glance, left_of_all
from hydrolek_drake.diagnosis.law_growing import grown
from hydrolek_drake.diagnosis.law_inputs import Input, inputs_of
from hydrolek_drake.diagnosis.law_naming import ahead_to_beat, helping, likeliest
from hydrolek_drake.diagnosis.law_problem import FoundLaw, Law, left_in_all, records_of
from hydrolek_drake.diagnosis.law_scan import STEADY
from hydrolek_drake.diagnosis.law_search import promising
from hydrolek_drake.diagnosis.laws import CONSTANT, Span, span_of
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiment import Experiment

TRIED = 24
"""So many laws are fitted with a few steps: the best of every input, periodic or not, what is simplest where an input
says how the machine is built, and what promises most."""

FINER = 2.0
"""Integration step of the last fits over the rig's own, at most."""

FITTED = 6
"""So many of them are fitted to the end, and the best of every other input that did as well but for `UNDECIDED`."""

UNDECIDED = 1.1
"""First fits whose squared residuals are within this factor are not told apart by the part of the data they saw."""

ALIKE = 1.1
"""Laws whose held-out errors lie within this factor predict alike: so much the parameters' own uncertainty adds."""

NEAR = 1.5
"""Laws whose held-out errors lie within this factor of the best may overtake it with more terms."""

Begun = tuple[Law, tuple[float, dict[str, float], np.ndarray]]
"""A law and its first fit, see `glance`."""


def find_law(
    bench: Workbench, named: Judged, held_out: Sequence[Experiment], scales: Scales
) -> FoundLaw | None:
    """The law that explains best what a fitted model leaves, or None if none predicts held-out data better.

    Args:
        bench: data and fits.
        named: the model that leaves it.
        held_out: what decides.
        scales: natural scales of the joint.
    """
    asked = Asked.of(bench, named.hypothesis, held_out, scales)
    laws = promising(bench, asked.left, asked.inputs, asked.span, asked.step)
    return best_of(bench, asked, laws, ahead_to_beat(named.over_noise))


@dataclass(frozen=True)
class Asked:
    """What a law is asked to explain.

    Attributes:
        left: the model that leaves it.
        held_out: what decides.
        inputs: unknown inputs of the joint.
        span: what the laws' variables are told in.
        step: of the integration in the first fits [s].
    """

    left: Hypothesis
    held_out: Sequence[Experiment]
    inputs: tuple[Input, ...]
    span: Span
    step: float

    @classmethod
    def of(
        cls, bench: Workbench, left: Hypothesis, held_out: Sequence[Experiment], scales: Scales
    ) -> "Asked":
        """What a fitted model leaves; arguments as of `find_law`."""
        joint = bench.training[0].joint
        pressure = bench.rig.value("supply.pressure")
        limit = bench.rig.value(f"joints.{joint}.command.limit")
        inputs = inputs_of(scales, pressure, limit, bench.training[0].channels[0].unit)
        step = bench.coarsest(left, left.fit.over_noise, COARSE)
        return cls(left, held_out, inputs, _span(bench, left, step), step)


def best_of(bench: Workbench, asked: Asked, laws: Sequence[Law], to_beat: float) -> FoundLaw | None:
    """The law that explains best what is asked, fitted; None if none leaves less than is to beat.

    Args:
        bench: data and fits.
        asked: what is to be explained.
        laws: that may explain it.
        to_beat: over the noise, on held-out data.
    """
    left, held_out, span = asked.left, asked.held_out, asked.span
    laws = sorted(laws, key=lambda law: -law.gain)
    if not laws or laws[0].gain <= 0.0:
        return None
    chosen = worth_trying(laws)
    finer = min(asked.step, FINER * bench.fine)  # what pulled rollouts told may explain the data at once
    begun = bench.side_by_side(
        lambda law: glance(bench, left, law, span, finer if law.pulled else asked.step), chosen
    )
    ranked = followed(sorted(zip(chosen, begun, strict=True), key=lambda item: item[1][0]))
    ended = bench.side_by_side(
        lambda item: fitted(bench, left, item[0], held_out, span, item[1][1:], finer), ranked
    )
    ended = bench.side_by_side(lambda found: grown(bench, left, found, held_out, finer), _ahead(ended))
    ended += _other_side(bench, left, ended, held_out, asked.inputs, finer)
    ended = helping(bench, left, ended, finer)
    least = min((found.held_out_over_noise for found in ended), default=math.inf)
    if not least < to_beat:
        return None
    alike = [found for found in ended if predicts_alike(found, least)]
    named = _named(bench, left, alike, held_out, finer)
    if named.held_out_over_noise < to_beat:
        return named
    # it explains all data, and the training data do not lead it there
    return _named(bench, left, [f for f in alike if f.held_out_over_noise <= ALIKE * least], held_out, finer)


def _named(
    bench: Workbench,
    left: Hypothesis,
    alike: Sequence[FoundLaw],
    held_out: Sequence[Experiment],
    step: float,
) -> FoundLaw:
    """Of laws that predict alike the likeliest, fitted to the end; of several stages by fits to all data."""
    in_all = [left_in_all(found.fit, found.held_out_over_noise, held_out) for found in alike]
    if len({found.law.input.stage for found in alike}) > 1 and not any(f.law.periodic for f in alike):
        in_all = bench.side_by_side(lambda found: left_of_all(bench, left, found, held_out, step), alike)
    counted = alike[0].fit.counted + sum(experiment.counted for experiment in held_out)
    return _finished(bench, left, likeliest(alike, in_all, counted), held_out, step)


def predicts_alike(found: FoundLaw, least: float) -> bool:
    """Whether a law predicts as the best one does, or explains the training data and goes somewhat astray ahead.

    Where it stuck by a hair's breadth, other numbers of the same law may follow both: a fit to all data tells.

    Args:
        found: the law.
        least: what the best one leaves of the held-out data, over the noise.
    """
    ahead = found.held_out_over_noise
    astray = found.fit.over_noise <= EXPLAINED and ahead <= FAR_AHEAD * least
    return ahead <= ALIKE * least or (astray and not found.law.periodic)


def _finished(
    bench: Workbench, left: Hypothesis, law: FoundLaw, held_out: Sequence[Experiment], step: float
) -> FoundLaw:
    """The law with the rig's own step: as it was fitted with a coarser one, or fitted on if it then predicts better."""

    def again(steps: int) -> FoundLaw:
        begin = (law.parameters, law.values)
        return fitted(
            bench, left, law.law, held_out, law.span, begin, bench.fine, steps, valleys=steps == STEPS
        )

    as_it_is, finer = again(1) if step > bench.fine else law, again(STEPS)
    better = finer.held_out_over_noise < as_it_is.held_out_over_noise
    return replace(finer if better else as_it_is, rivals=law.rivals)


def _ahead(ended: Sequence[FoundLaw]) -> list[FoundLaw]:
    """Laws that come near the one that predicts best; of each input only the best one."""
    least = min(found.held_out_over_noise for found in ended)
    near = sorted(
        (found for found in ended if found.held_out_over_noise <= NEAR * least),
        key=lambda found: found.held_out_over_noise,
    )
    best: dict[str, FoundLaw] = {}
    for found in near:
        best.setdefault(found.law.input.probe, found)
    return list(best.values())


def _other_side(
    bench: Workbench,
    left: Hypothesis,
    ended: Sequence[FoundLaw],
    held_out: Sequence[Experiment],
    inputs: Sequence[Input],
    step: float,
) -> list[FoundLaw]:
    """Of the law that predicts best its counterpart beyond the linkage, which may have grown by other terms."""
    best = min(ended, key=lambda found: found.held_out_over_noise)
    parameters = bench.parameters(left.effects)
    records = parameters.records(parameters.unit(best.parameters))
    law = records_of(best.law, best.span, best.values)
    signals = [e.simulate(records, step, law=law).signals for e in bench.training]
    other = counterpart(best, inputs, signals, records[bench.training[0].index])
    if other is None:
        return []
    same = (other[0].input.probe, other[0].terms)
    if any((f.law.input.probe, f.law.terms) == same for f in ended):
        return []
    begin = (best.parameters, other[1])
    there = fitted(bench, left, other[0], held_out, best.span, begin, step)
    return [grown(bench, left, there, held_out, step)]


def without_effects(
    bench: Workbench, nominal: Judged, law: FoundLaw, held_out: Sequence[Experiment]
) -> FoundLaw:
    """A law that was found beside effects, fitted beside the nominal model.

    Args:
        bench: data and fits.
        nominal: the model without effects.
        law: found beside a model with some.
        held_out: what decides.
    """
    left = nominal.hypothesis
    step = bench.coarsest(left, left.fit.over_noise, FINER)
    begin = (law.parameters, law.values)
    return fitted(bench, left, law.law, held_out, _span(bench, left, step), begin, step)


def _span(bench: Workbench, left: Hypothesis, step: float) -> Span:
    """What a law's variables are told in, from the training data as a model has them."""
    parameters = bench.parameters(left.effects)
    records = parameters.records(parameters.unit(left.values))
    return span_of(
        [e.simulate(records, step).signals for e in bench.training],
        records[bench.training[0].index],
        max(float(np.ptp(e.time)) for e in bench.training),
        bench.training[0].channels[0].unit,
        "m" if bench.rig.variant(bench.training[0].joint, "cylinder") == "cylinder" else "rad",
    )


def followed(ranked: Sequence[Begun]) -> list[Begun]:
    """Those of the first fits that are fitted to the end.

    Args:
        ranked: first fits, the best first.
    """
    first = list(ranked[:FITTED])
    seen = {law.input.probe for law, _ in first}
    least = ranked[0][1][0]
    for law, fit in ranked[FITTED:]:
        if fit[0] < UNDECIDED * least and law.input.probe not in seen:
            first.append((law, fit))
            seen.add(law.input.probe)
    return first


def worth_trying(laws: Sequence[Law]) -> list[Law]:
    """The best law of every input and kind (a sine, one term, two) first, then the rest, as many as are tried.

    How a machine is built does not change, so that a constant is likely there even if, far from the fitted nominal
    model, another term promises more.

    Args:
        laws: what promises most first.
    """
    seen: set[tuple[str, int, bool]] = set()
    first: list[Law] = []
    built: list[Law] = []
    rest: list[Law] = []
    for law in laws:
        key = (law.input.probe, len(law.terms), law.pulled)
        if key not in seen:
            first.append(law)
        elif law.input.probe in STEADY and [term.name for term in law.terms] == [CONSTANT]:
            built.append(law)
        else:
            rest.append(law)
        seen.add(key)
    return [*first, *built, *rest][:TRIED]
