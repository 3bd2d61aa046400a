"""Which laws could explain what a model leaves, from rollouts and linear algebra alone (as in `score`)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.law_problem import SCAN_S, Law
from hydrolek_drake.diagnosis.law_terms import TRIED, Fitted, gain_along, terms_scored
from hydrolek_drake.diagnosis.laws import TERMS, Span, Term, law_record
from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.problem import Problem

HIGHEST_HZ = 8.0
"""Frequencies up to this one are looked for; joints hardly follow faster ones."""

LOWEST = 1.0
"""Cycles at least within `SCAN_S`."""

SPACING = 0.25
"""Frequencies are tried so many cycles over the recording apart. Two half a cycle apart are hardly told from each other
by their sines alone; but the fitted parameters undo a part of both, and what is left of a peak is narrower."""

SCANNED = ("command", "supply", "load", "sensor")
"""Inputs at which all frequencies are tried. What shakes at another one shows near the same frequencies at one of
these: a force at the rod as a moment at the load, and what changes the flow in proportion as the supply does."""

STEADY = ("capacity_a", "capacity_b", "back_a", "back_b", "ramp", "coil_time", "flow_force")
"""Inputs that say how something is built, which no disturbance shakes: no frequency is tried there."""

FOLLOWED = 6
"""So many peaks of the first part are looked at with more of the recording, where frequencies lie further apart."""

LONGER_S = 60.0
"""With so many seconds of it. Of an input both frequencies are told that promise most, with these and with the first
part: a nominal model that made up for a disturbance goes astray later on, and with it what is promised there."""


@dataclass(frozen=True)
class _Part:
    """The beginning of the first recording, and what of a change there the fitted parameters cannot undo."""

    experiments: list[Experiment]
    across: Across
    counted: int


def promising(
    bench: Workbench,
    left: Hypothesis,
    inputs: Sequence[Input],
    span: Span,
    step: float,
    terms: Sequence[Term] = TERMS,
) -> list[Law]:
    """Every law with the gain that it promises, and the amplitude at which its fit should begin.

    Args:
        bench: training data and rig.
        left: the model that leaves the mismatch.
        inputs: unknown inputs of the joint.
        span: what the laws' variables are told in.
        step: of the integration [s].
        terms: that are tried; none for periodic laws alone.
    """
    parameters = bench.parameters(left.effects)
    records = parameters.records(parameters.unit(left.values))
    across = Across(left.fit)
    off = left.fit.off_prior
    counted = sum(e.counted for e in bench.training)

    def response(
        experiments: Sequence[Experiment],
        given: Input,
        term: Term | None,
        sine: float,
        cosine: float = 0.0,
        frequency: float = 0.0,
    ) -> np.ndarray:
        scale = given.scale
        law = law_record(given.probe, span, term, scale * sine, scale * cosine, frequency)
        parts = [e.residuals(e.simulate(records, step, law=law).signals) for e in experiments]
        residuals = np.concatenate(parts)
        return residuals if np.isfinite(residuals).all() else np.full_like(residuals, np.nan)

    def of_terms(given: Input) -> list[Law]:
        model = Fitted(records, span, step, across, off)
        return [
            Law(given, (term,), 0.0, gain, (start,))
            for term, gain, start in terms_scored(bench, model, given, terms)
        ]

    def beginning(seconds: float) -> _Part:
        part = [bench.training[0].until(seconds)]
        own = Problem(parameters, part, step)
        base = own.residuals(parameters.unit(left.values))
        jacobian = own.jacobian(left.fit.unit, base)
        nearby = Across(Fit(left.fit.unit, base, off, jacobian, left.fit.prior_jacobian, own.counted, 0))
        return _Part(part, nearby, own.counted)

    longest = min(float(np.ptp(bench.training[0].time)), LONGER_S)
    short, longer = bench.side_by_side(beginning, (SCAN_S, longest))

    def gains(given: Input, part: _Part, frequencies: np.ndarray) -> list[Law]:
        here = response(part.experiments, given, TERMS[0], 0.0)
        rest = part.across(np.concatenate([here, off]))
        found = []
        for frequency in frequencies.tolist():
            bench.alive()
            columns = []
            for sine, cosine in ((TRIED, 0.0), (0.0, TRIED)):
                moved = response(part.experiments, given, None, sine, cosine, frequency) - here
                columns.append(part.across(np.concatenate([moved, np.zeros(off.size)])))
            gain, amplitudes = gain_along(np.stack(columns, axis=1), rest)
            found.append(Law(given, (), frequency, gain * counted / max(part.counted, 1), amplitudes))
        return found

    spacing = SPACING / SCAN_S

    def scanned(given: Input) -> list[Law]:
        every = gains(given, short, np.arange(LOWEST / SCAN_S, HIGHEST_HZ, spacing))
        return _peaks(every)[:FOLLOWED]

    def of_frequencies(given: Input) -> list[Law]:
        here = at[given.probe] if given.probe in at else gains(given, short, frequencies)
        around = np.arange(-0.5 * spacing, 0.5 * spacing, SPACING / longest)
        best = sorted(here, key=_promised)[: -FOLLOWED - 1 : -1]
        near = gains(given, longer, np.concatenate([law.frequency + around for law in best]))
        loudest, at_first = max(near, key=_promised), max(near[: around.size], key=_promised)
        return [loudest] if loudest is at_first else [loudest, at_first]

    shaken = [given for given in inputs if given.probe not in STEADY]
    through = [given for given in shaken if given.probe in SCANNED] or shaken
    at = {
        given.probe: peaks for given, peaks in zip(through, bench.side_by_side(scanned, through), strict=True)
    }
    frequencies = np.unique([law.frequency for peaks in at.values() for law in peaks])
    work = [(of_terms, given) for given in (inputs if terms else ())]
    work += [(of_frequencies, given) for given in shaken]
    return [law for laws in bench.side_by_side(lambda item: item[0](item[1]), work) for law in laws]


def _promised(law: Law) -> float:
    return law.gain


def _peaks(laws: Sequence[Law]) -> list[Law]:
    """Those that promise more than their neighbours in frequency, the best first."""
    gains = np.array([-np.inf, *(law.gain for law in laws), -np.inf])
    higher = (gains[1:-1] > gains[:-2]) & (gains[1:-1] >= gains[2:])
    return sorted((law for law, peak in zip(laws, higher, strict=True) if peak), key=lambda law: -law.gain)
