"""At which frequencies something that shakes the machine would explain what a structure leaves."""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.diagnosis.fitting.lockstep import Place, with_slopes
from hydrolek_drake.diagnosis.fitting.rolling import Request, residuals_at
from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.laws import Span
from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm
from hydrolek_drake.diagnosis.structures.race import hypothesis_of
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench

SECONDS = 12.0
"""Of the recordings that are seen."""

HIGHEST_HZ = 8.0
"""Frequencies up to this one are looked for; joints hardly follow faster ones."""

APART = 0.5
"""Cycles over `SECONDS` that frequencies are tried apart."""

AMPLITUDE = 1e-3
"""Of a trial, in scales of the input: small enough to be linear."""

SHAKEN = ("command", "supply", "load", "sensor", "amplifier", "valve", "cylinder")
"""Inputs at which something may shake; others say how a machine is built."""

PEAKS = 2
"""So many frequencies of each input are followed."""


def periodic_terms(
    bench: Workbench,
    parent: Hypothesis,
    values: dict[str, float],
    inputs: Sequence[Input],
    joint: str,
    span: Span,
    observer_s: float,
    cores: int,
) -> list[LawTerm]:
    """Sines that promise most at each input, as terms that may be added to a structure.

    Args:
        bench: data and problems.
        parent: the structure.
        values: full path -> where its parameters stand.
        inputs: of the joint.
        joint: its name.
        span: what laws are told in.
        observer_s: time constant of the observer; prediction errors of a short one hide all that is slow [s].
        cores: that roll out at the same time.
    """
    data = [e.until(SECONDS) for e in bench.training]
    step = 2.0 * bench.fine
    problem = bench.problem(parent.effects, step, data, observer_s)
    place = Place(problem, bench.movable(parent.effects, problem.parameters), problem.parameters.unit(values))
    place = with_slopes([place], bench.pool, cores, 1.0)[0]
    fit = hypothesis_of(parent.effects, place, step).fit
    object.__setattr__(fit, "slopes", place.slopes)
    across = Across(fit)
    assert place.residuals is not None
    left = across(np.concatenate([place.residuals, fit.off_prior]))
    frequencies = np.arange(1.0 / SECONDS, HIGHEST_HZ, APART / SECONDS)
    middle = 0.5 * (HIGHEST_HZ + 1.0 / SECONDS)
    shaken = [given for given in inputs if given.probe in SHAKEN]
    requests = []
    for given in shaken:
        term = LawTerm(given, None, joint, span, middle, 0.5 * HIGHEST_HZ)
        own = bench.problem((*parent.effects, term), step, data, observer_s)
        size = AMPLITUDE * given.scale
        paths = [free.path for free in term.free]
        units = [
            own.parameters.unit({**values, **dict(zip(paths, (sine, cosine, float(f)), strict=True))})
            for f in frequencies
            for sine, cosine in ((size, 0.0), (0.0, size))
        ]
        requests.append(Request(own, tuple(units)))
    found = []
    for given, moved in zip(shaken, residuals_at(requests, bench.pool, cores), strict=True):
        gains = np.zeros(frequencies.size)
        for k in range(frequencies.size):
            columns = np.stack(
                [across(np.concatenate([each, fit.off_prior]) - np.concatenate([place.residuals, fit.off_prior])) for each in moved[2 * k : 2 * k + 2]],
                axis=1,
            )
            if np.isfinite(columns).all():
                multiples, *_ = np.linalg.lstsq(columns, -left, rcond=None)
                gains[k] = float(np.sum((columns @ multiples) ** 2))
        padded = np.concatenate([[-np.inf], gains, [-np.inf]])
        peaks = np.flatnonzero((padded[1:-1] > padded[:-2]) & (padded[1:-1] >= padded[2:]))
        best = sorted(peaks, key=lambda k: -gains[k])[:PEAKS]
        found += [(gains[k], LawTerm(given, None, joint, span, float(frequencies[k]))) for k in best]
    return [term for _, term in sorted(found, key=lambda each: -each[0])]
