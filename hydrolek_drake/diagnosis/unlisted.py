"""Physics in no list: the stage where it enters, when, and a short law for it.

What the best model leaves is held against every law of `laws`, at every stage, by the gain that its response
promises (`score`), as for a listed effect. The most promising are fitted together with the nominal parameters,
and the one that predicts the held-out data best is named. Where a periodic disturbance stands in its cycle when
a recording begins is no property of the machine, so its phase is fitted to each recording.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.evidence import Judged
from hydrolek_drake.diagnosis.laws import TERMS, Input, Term, inputs_of, probe_rows, variables_of
from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.workbench import SPREAD, Hypothesis, Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit, fit_from
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.rollout.rollout import Signals

GRID_S = 0.005
"""Spacing of the samples of an unknown input [s]."""

SCAN_S = 12.0
"""Frequencies are first looked for in so many seconds."""

HIGHEST_HZ = 8.0
"""Frequencies up to this one are looked for; joints hardly follow faster ones."""

TRIED = 1e-3
"""Amplitude of a trial, as a fraction of the input's scale: small enough to be linear."""

FITTED = 8
"""So many laws are fitted."""

BETTER = 0.8
"""A law must take the held-out error below this share of what it was, or it is no law of this machine."""

STEPS = 15
PHASES = 12


@dataclass(frozen=True)
class Law:
    """A law at a stage.

    Attributes:
        input: what it gives.
        term: of which; None for a periodic one.
        frequency: first guess [Hz]; 0 for a term.
        gain: predicted fall of the squared residuals.
        amplitudes: that promise it, in scales of the input: one, or of sine and cosine.
    """

    input: Input
    term: Term | None
    frequency: float
    gain: float
    amplitudes: tuple[float, ...]

    @property
    def size(self) -> int:
        """How many parameters it has."""
        return 1 if self.term is not None else 3


@dataclass(frozen=True)
class FoundLaw:
    """A fitted law.

    Attributes:
        law: stage and form.
        values: amplitude (SI), or sine and cosine amplitudes and frequency [Hz].
        parameters: full path -> nominal parameters fitted with it.
        fit: on the training data.
        held_out_over_noise: root mean square on held-out data over the noise.
        difference: of the reading on the first training recording, with and without the law. # (n,)
    """

    law: Law
    values: np.ndarray
    parameters: dict[str, float]
    fit: Fit
    held_out_over_noise: float
    difference: np.ndarray

    @property
    def amplitude(self) -> float:
        """Largest size of the input (SI), with its sign for a term."""
        return float(self.values[0]) if self.law.term is not None else math.hypot(*self.values[:2])

    def equation(self) -> str:
        """The law as an equation."""
        unit = "" if self.law.input.unit == "1" else f" {self.law.input.unit}"
        if self.law.term is not None:
            return f"{self.law.input.symbol} = {self.amplitude:.3g}{unit} * {self.law.term.name}"
        phase = math.atan2(self.values[1], self.values[0])
        return (
            f"{self.law.input.symbol} = {self.amplitude:.3g}{unit} * "
            f"sin(2 pi {self.values[2]:.4g} Hz t + {phase:.2f})"
        )


class LawProblem(Problem):
    """Residuals as a function of the nominal parameters and of a law's own."""

    def __init__(
        self,
        parameters: ParameterSet,
        experiments: Sequence[Experiment],
        step: float,
        law: Law,
        trajectories: Sequence[Signals],
        pressure: float,
    ) -> None:
        """Prepare; the terms are taken along given trajectories."""
        prior = np.where([".effects." in path for path in parameters.paths], np.inf, SPREAD)
        super().__init__(parameters, experiments, step, prior=prior)
        self.law = law
        self._nominal = len(parameters)
        self._prior_mean = np.concatenate([self._prior_mean, np.full(law.size, 0.5)])
        self._prior_weight = np.concatenate([self._prior_weight, np.zeros(law.size)])
        self._grids = [_grid(experiment) for experiment in experiments]
        self._terms = [
            _term_on_grid(law.term, experiment, grid, signals, pressure) if law.term is not None else None
            for experiment, grid, signals in zip(experiments, self._grids, trajectories, strict=True)
        ]

    def law_values(self, unit: np.ndarray) -> np.ndarray:
        """Amplitudes (SI) and frequency [Hz] at a place in the unit cube."""
        own = unit[self._nominal :]
        values = (2.0 * own - 1.0) * self.law.input.scale
        if self.law.term is None:
            values[2] = self.law.frequency + (own[2] - 0.5) / SCAN_S
        return values

    def start(self, nominal: np.ndarray, amplitudes: np.ndarray) -> np.ndarray:
        """Unit vector for nominal parameters and amplitudes (SI)."""
        own = np.clip(0.5 + 0.5 * amplitudes / self.law.input.scale, 0.0, 1.0)
        if self.law.term is None:  # the frequency begins at its first guess
            own = np.array([*own, 0.5])
        return np.concatenate([nominal, own])

    def signals(self, unit: np.ndarray) -> list[Signals]:
        """What the model with the law does in every experiment."""
        records = self.parameters.records(unit[: self._nominal])
        values = self.law_values(unit)
        done = []
        for experiment, grid, term in zip(self.experiments, self._grids, self._terms, strict=True):
            if term is None:
                angle = 2.0 * math.pi * values[2] * grid
                series = values[0] * np.sin(angle) + values[1] * np.cos(angle)
            else:
                series = values[0] * term
            rows = probe_rows(self.law.input.stage, series)
            done.append(experiment.simulate(records, self.longest_step, (GRID_S, rows)).signals)
        return done

    def residuals(self, unit: np.ndarray) -> np.ndarray:
        """Measured minus model over noise, of all experiments."""
        self.evaluations += 1
        return self.bounded(
            [e.residuals(s) for e, s in zip(self.experiments, self.signals(unit), strict=True)]
        )

    def _keep(self, unit: np.ndarray, base: np.ndarray) -> None:
        """Nothing is kept: a law's own parameters change every rollout."""


def _grid(experiment: Experiment) -> np.ndarray:
    """Times since the start at which an input is given [s]."""
    return np.arange(int(np.ptp(experiment.time) / GRID_S) + 2) * GRID_S


def _term_on_grid(
    term: Term, experiment: Experiment, grid: np.ndarray, signals: Signals, pressure: float
) -> np.ndarray:
    since = experiment.time - experiment.time[0]
    values = term.values(since / since[-1], variables_of(signals, pressure))
    return np.interp(grid, since, values)


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
    left = named.hypothesis
    joint = bench.training[0].joint
    pressure = bench.rig.value("supply.pressure")
    limit = bench.rig.value(f"joints.{joint}.command.limit")
    inputs = inputs_of(scales, pressure, limit, bench.training[0].channels[0].unit)
    laws = sorted(_promising(bench, left, inputs, pressure), key=lambda law: -law.gain)
    if not laws or laws[0].gain <= 0.0:
        return None
    chosen = _one_of_each(laws)
    fitted = bench.side_by_side(lambda law: _fitted(bench, left, law, held_out, pressure), chosen)
    best = min(fitted, key=lambda found: found.held_out_over_noise)
    return best if best.held_out_over_noise < BETTER * named.over_noise else None


def _one_of_each(laws: Sequence[Law]) -> list[Law]:
    """The best law of every stage and kind first, then the rest, as many as are fitted."""
    seen: set[tuple[str, bool]] = set()
    first: list[Law] = []
    rest: list[Law] = []
    for law in laws:
        key = (law.input.stage, law.term is None)
        (rest if key in seen else first).append(law)
        seen.add(key)
    return [*first[:FITTED], *rest][:FITTED]


def _promising(bench: Workbench, left: Hypothesis, inputs: Sequence[Input], pressure: float) -> list[Law]:
    parameters = bench.parameters(left.effects)
    records = parameters.records(parameters.unit(left.values))
    step = 4.0 * bench.fine
    across = Across(left.fit)
    off = left.fit.off_prior

    def response(experiments: Sequence[Experiment], stage: str, series: Sequence[np.ndarray]) -> np.ndarray:
        parts = []
        for experiment, values in zip(experiments, series, strict=True):
            probes = (GRID_S, probe_rows(stage, values))
            parts.append(experiment.residuals(experiment.simulate(records, step, probes).signals))
        return np.nan_to_num(np.concatenate(parts))

    def of_terms(given: Input) -> list[Law]:
        bench.alive()
        here = response(bench.training, given.stage, [np.zeros(_grid(e).size) for e in bench.training])
        rest = across(np.concatenate([here, off]))
        trajectories = [e.simulate(records, step).signals for e in bench.training]
        found = []
        for term in TERMS:
            series = [
                TRIED * given.scale * _term_on_grid(term, e, _grid(e), s, pressure)
                for e, s in zip(bench.training, trajectories, strict=True)
            ]
            e = across(
                np.concatenate([response(bench.training, given.stage, series) - here, np.zeros(off.size)])
            )
            found.append(Law(given, term, 0.0, *_gain(e[:, None], rest)))
        return found

    def of_frequencies(given: Input) -> list[Law]:
        bench.alive()
        part = [e.until(SCAN_S) for e in bench.training[:1]]
        zero = np.zeros(_grid(part[0]).size)
        here = response(part, given.stage, [zero])
        own = Problem(parameters, part, step)
        base = own.residuals(parameters.unit(left.values))
        nearby = Across(
            Fit(
                left.fit.unit,
                base,
                off,
                own.jacobian(left.fit.unit, base),
                left.fit.prior_jacobian,
                own.counted,
                0,
            )
        )
        rest = nearby(np.concatenate([here, off]))
        grid = _grid(part[0])
        spacing = 0.5 / SCAN_S
        found = []
        for frequency in np.arange(2.0 * spacing, HIGHEST_HZ, spacing):
            columns = []
            for wave in (np.sin, np.cos):
                series = TRIED * given.scale * wave(2.0 * math.pi * frequency * grid)
                moved = response(part, given.stage, [series]) - here
                columns.append(nearby(np.concatenate([moved, np.zeros(off.size)])))
            found.append(Law(given, None, float(frequency), *_gain(np.stack(columns, axis=1), rest)))
        whole = sum(e.counted for e in bench.training) / max(own.counted, 1)
        best = max(found, key=lambda law: law.gain)
        return [Law(given, None, best.frequency, best.gain * whole, best.amplitudes)]

    work = [(kind, given) for given in inputs for kind in (of_terms, of_frequencies)]
    return [law for laws in bench.side_by_side(lambda item: item[0](item[1]), work) for law in laws]


def _gain(columns: np.ndarray, rest: np.ndarray) -> tuple[float, tuple[float, ...]]:
    """Fall of the squared residuals if the columns take their best multiples, and these, in scales of the input."""
    norms = np.linalg.norm(columns, axis=0)
    if not (norms > 0.0).all():
        return 0.0, (0.0,) * columns.shape[1]
    multiples, *_ = np.linalg.lstsq(columns / norms, -rest, rcond=None)
    fitted = columns / norms @ multiples
    amplitudes = np.clip(TRIED * multiples / norms, -0.9, 0.9)
    return float(fitted @ fitted), tuple(amplitudes.tolist())


def _fitted(
    bench: Workbench, left: Hypothesis, law: Law, held_out: Sequence[Experiment], pressure: float
) -> FoundLaw:
    parameters = bench.parameters(left.effects)
    nominal = parameters.unit(left.values)
    records = parameters.records(nominal)
    step = 2.0 * bench.fine
    trajectories = [e.simulate(records, step).signals for e in bench.training]
    best: tuple[LawProblem, Fit] | None = None
    for _ in range(2):  # the terms follow the trajectory that the law itself bends
        bench.alive()
        problem = LawProblem(parameters, bench.training, step, law, trajectories, pressure)
        if best is None:
            own = problem.start(nominal, law.input.scale * np.array(law.amplitudes))
            fit = fit_from(problem, own, most_steps=STEPS, tolerance=1e-4)
        else:
            fit = fit_from(problem, best[1].unit, most_steps=STEPS, tolerance=1e-4)
        best = (problem, fit)
        if law.term is None:
            break
        trajectories = problem.signals(fit.unit)
    assert best is not None
    problem, fit = best
    count = len(parameters)
    values = problem.law_values(fit.unit)
    without = bench.training[0].simulate(parameters.records(fit.unit[:count]), step).signals
    difference = problem.signals(fit.unit)[0].reading - without.reading
    over = _ahead(parameters, fit, problem, held_out, step, pressure)
    bench.evaluations += problem.evaluations
    return FoundLaw(law, values, parameters.values(fit.unit[:count]), fit, over, difference)


def _ahead(
    parameters: ParameterSet,
    fit: Fit,
    problem: LawProblem,
    held_out: Sequence[Experiment],
    step: float,
    pressure: float,
) -> float:
    """Held-out root mean square over the noise; the phase of a periodic law is fitted to each recording."""
    total, counted = 0.0, 0
    records = parameters.records(fit.unit[: len(parameters)])
    for experiment in held_out:
        trajectories = [experiment.simulate(records, step).signals]
        own = LawProblem(parameters, [experiment], step, problem.law, trajectories, pressure)
        unit = fit.unit.copy()
        if problem.law.term is None:
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
        total += float(residual @ residual)
        counted += experiment.counted
    return math.sqrt(total / max(counted, 1))
