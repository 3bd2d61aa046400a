"""Fits of a law for physics in no list, and how well it predicts."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.intervals import intervals_of
from hydrolek_drake.diagnosis.law_problem import SCAN_S, FoundLaw, Law, LawProblem
from hydrolek_drake.diagnosis.laws import Span
from hydrolek_drake.diagnosis.ranges import WIDER
from hydrolek_drake.diagnosis.score import AT_BOUND
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit, fit_from, fit_from_afar
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import PULLS_S
from hydrolek_drake.identification.valleys import along_valleys

STEPS, GLANCE = 15, 4
"""Trust-region steps of a fit, and of a first one that tells which law is worth it."""

CHANCE = 2.0
"""Fall of the squared residuals that one parameter more must bring, of two laws that do as well (Akaike, A new look at
the statistical model identification, IEEE Transactions on Automatic Control 19, 1974)."""

BEGUN = (0.3, 0.1, 0.03, 0.01)
"""Amplitudes, in scales of the input, at which a fit from the rig's own numbers may begin."""

PHASES = 12
"""Where a periodic law may stand when a recording begins is first tried at so many places."""


def glance(
    bench: Workbench, left: Hypothesis, law: Law, span: Span, step: float
) -> tuple[float, dict[str, float], np.ndarray]:
    """A few steps with a law on the first part of the training data.

    Begun at the fitted values of the model that leaves the mismatch and at the rig's own, which were not bent to
    make up for what is missing. The latter is far off, so that pulled rollouts go ahead, from the amplitude at which
    they fit best: what was promised beside bent numbers may be far from it. But for a periodic law, which no constant
    of the rig could make up for, unless pulled rollouts told it.

    Returns:
        Squared residuals, nominal parameters and the law's values (SI), the best of both.
    """
    bench.alive()
    parameters = bench.parameters(left.effects)
    own = {path: value for path, value in left.values.items() if ".effects." in path}
    ended = []
    steps = STEPS if law.pulled else GLANCE  # few laws are told so, and the way is longer
    scanned = [experiment.until(SCAN_S) for experiment in bench.training]
    from_own = (own, fit_from if law.periodic and not law.pulled else fit_from_afar)
    for values, first_fit in (from_own,) if law.pulled else ((left.values, fit_from), from_own):
        unit = parameters.unit(values)
        own_values = law.begun(law.input.scale * np.array(law.amplitudes))
        if first_fit is fit_from_afar and not law.periodic:
            own_values = begun_from_afar(LawProblem(parameters, bench.beginning(), step, law, span), unit)
        for part in (scanned, bench.beginning()) if law.periodic else (bench.beginning(),):
            problem = LawProblem(parameters, part, step, law, span)
            start = problem.start(unit, own_values)
            fit = first_fit(problem, start, most_steps=steps, tolerance=1e-3, stop=bench.interrupted)
            unit, own_values = fit.unit[: len(parameters)], problem.law_values(fit.unit)
            bench.evaluations += problem.evaluations
        ended.append((fit.objective, unit, own_values))
    objective, unit, own_values = min(ended, key=lambda end: end[0])
    return objective, parameters.values(unit), own_values


def begun_from_afar(problem: LawProblem, unit: np.ndarray) -> np.ndarray:
    """The values at which the fit of a law begins from far off: for one term, where tightly pulled rollouts fit best.

    Beside numbers that were bent to make up for a law, the amplitude that it promises may be a tenth of its own, or
    have the other sign.

    Args:
        problem: the data with the law.
        unit: place of the nominal parameters in the unit cube. # (n,)
    """
    law, pulled = problem.law, problem.pulled(PULLS_S[0])
    signs = (1.0,) if law.input.one_sided else (1.0, -1.0)
    others = [(sign * size,) for size in BEGUN for sign in signs] if law.sizes == 1 else []
    tried = [law.amplitudes, *others]
    values = [law.begun(law.input.scale * np.array(sizes)) for sizes in tried]
    left = [float(np.sum(pulled.residuals(problem.start(unit, each)) ** 2)) for each in values]
    problem.evaluations += pulled.evaluations
    return values[int(np.argmin(left))]


def fitted(
    bench: Workbench,
    left: Hypothesis,
    law: Law,
    held_out: Sequence[Experiment],
    span: Span,
    begin: tuple[dict[str, float], np.ndarray],
    step: float,
    most_steps: int = STEPS,
    valleys: bool = False,
) -> FoundLaw:
    """Fit a law together with the parameters of a model, from where a glance ended.

    Where an amplitude ends at what is large for this machine, the fit goes on with a wider scale, as for the ranges
    of known effects (`ranges`).

    Args:
        bench: training data and rig.
        left: the model that leaves the mismatch.
        law: what is added.
        held_out: data that nothing is fitted to.
        span: what the law's variables are told in.
        begin: nominal parameters and the law's values (SI).
        step: of the integration [s].
        most_steps: of the trust region; 1 leaves everything where it begins.
        valleys: go on from lower places along what the data tell least (`valleys.along_valleys`).
    """
    bench.alive()
    parameters = bench.parameters(left.effects)
    problem = LawProblem(parameters, bench.training, step, law, span)
    start = problem.start(parameters.unit(begin[0]), begin[1])
    fit = fit_from(problem, start, most_steps=most_steps, tolerance=1e-4, stop=bench.interrupted)
    count = len(parameters)
    if at_the_end(law, fit.unit):
        bench.evaluations += problem.evaluations
        law = replace(law, input=replace(law.input, scale=WIDER * law.input.scale))
        reached = problem.law_values(fit.unit)
        problem = LawProblem(parameters, bench.training, step, law, span)
        start = problem.start(fit.unit[:count], reached)
        fit = fit_from(problem, start, most_steps=most_steps, tolerance=1e-4, stop=bench.interrupted)
    if valleys:
        fit = along_valleys(problem, fit, 1e-4, bench.interrupted)
    values = problem.law_values(fit.unit)
    without = bench.training[0].simulate(parameters.records(fit.unit[:count]), step).signals
    difference = problem.signals(fit.unit)[0].reading - without.reading
    over, ahead = _ahead(parameters, fit, problem, held_out, step, span)
    bench.evaluations += problem.evaluations
    nominal = parameters.values(fit.unit[:count])
    joint = bench.training[0].joint
    intervals = intervals_of(parameters, fit)
    return FoundLaw(law, values, nominal, fit, over, difference, span, ahead, joint, intervals=intervals)


def left_of_all(
    bench: Workbench, left: Hypothesis, found: FoundLaw, held_out: Sequence[Experiment], step: float
) -> float:
    """What a law leaves of all data once it is fitted to all of them, and what its numbers cost.

    What is fitted to the training data alone predicts the held-out ones less well than the right numbers would, a
    short law at the right stage by as much as a long one at another stage. Fitted to all, both leave what their form
    cannot follow.

    Args:
        bench: training data and rig.
        left: the model that leaves the mismatch.
        found: the law, fitted to the training data; no periodic one, which has a phase in every recording.
        held_out: data that it was not fitted to.
        step: of the integration [s].
    """
    bench.alive()
    parameters = bench.parameters(left.effects)
    problem = LawProblem(parameters, [*bench.training, *held_out], step, found.law, found.span)
    start = problem.start(parameters.unit(found.parameters), found.values)
    fit = fit_from(problem, start, most_steps=STEPS, tolerance=1e-4, stop=bench.interrupted)
    bench.evaluations += problem.evaluations
    return fit.objective + CHANCE * found.law.size


def at_the_end(law: Law, unit: np.ndarray) -> bool:
    """Whether an amplitude of a fitted law lies at an end of its input's scale.

    Args:
        law: that was fitted.
        unit: where, in the unit cube; a law's own parameters come last.
    """
    own = unit[-law.size :][: law.sizes]
    return bool((np.abs(own - 0.5) > 0.5 - AT_BOUND).any())


def _ahead(
    parameters: ParameterSet,
    fit: Fit,
    problem: LawProblem,
    held_out: Sequence[Experiment],
    step: float,
    span: Span,
) -> tuple[float, tuple[np.ndarray, ...]]:
    """Held-out root mean square over the noise, and the law's values on each recording.

    The phase of a periodic law is fitted to each recording.
    """
    total, counted = 0.0, 0
    ahead: list[np.ndarray] = []
    for experiment in held_out:
        own = LawProblem(parameters, [experiment], step, problem.law, span)
        unit = fit.unit.copy()
        if problem.law.periodic:
            values = problem.law_values(fit.unit)
            amplitude = math.hypot(values[0], values[1])

            def at(phase: float, size: float = amplitude, like: LawProblem = own) -> np.ndarray:
                moved = fit.unit.copy()
                moved[-3] = 0.5 + 0.5 * size * math.cos(phase) / like.law.input.scale
                moved[-2] = 0.5 + 0.5 * size * math.sin(phase) / like.law.input.scale
                return moved

            def misfit(phase: float, like: LawProblem = own) -> float:
                residual = like.residuals(at(phase))
                return float(residual @ residual)

            phases = 2.0 * math.pi * np.arange(PHASES) / PHASES
            first = min(phases.tolist(), key=misfit)
            width = 2.0 * math.pi / PHASES
            for _ in range(6):
                first = min((first - width / 2.0, first, first + width / 2.0), key=misfit)
                width *= 0.5
            unit = at(first)
        residual = own.residuals(unit)
        ahead.append(own.law_values(unit))
        total += float(residual @ residual)
        counted += experiment.counted
    return math.sqrt(total / max(counted, 1)), tuple(ahead)
