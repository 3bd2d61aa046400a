"""Recordings fitted with the nominal parameters and a law's own."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.laws import CONSTANT, Input, Span, Term, law_record, law_records
from hydrolek_drake.diagnosis.workbench import SPREAD
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.rollout.rollout import Signals

SCAN_S = 12.0
"""Frequencies are first looked for in so many seconds."""


FRICTIONS = ("sign(v)", "v", "v |v|")
"""Factors of a term that changes its sign with the speed."""


@dataclass(frozen=True)
class Law:
    """A law at a stage.

    Attributes:
        input: what it gives.
        terms: of which it is the sum; none for a periodic one.
        frequency: first guess [Hz]; 0 for terms.
        gain: predicted fall of the squared residuals.
        amplitudes: that promise it, in scales of the input: one of each term, or of sine and cosine.
    """

    input: Input
    terms: tuple[Term, ...]
    frequency: float
    gain: float
    amplitudes: tuple[float, ...]

    @property
    def periodic(self) -> bool:
        """Whether it is a sine in time."""
        return not self.terms

    @property
    def brakes(self) -> bool:
        """Whether it is a friction, of whatever form."""
        return bool(self.terms) and all(term.speed in FRICTIONS for term in self.terms)

    @property
    def size(self) -> int:
        """How many parameters it has."""
        return 3 if self.periodic else len(self.terms)


@dataclass(frozen=True)
class FoundLaw:
    """A fitted law.

    Attributes:
        law: stage and form.
        values: amplitudes (SI), or sine and cosine amplitudes and frequency [Hz].
        parameters: full path -> nominal parameters fitted with it.
        fit: on the training data.
        held_out_over_noise: root mean square on held-out data over the noise.
        difference: of the reading on the first training recording, with and without the law. # (n,)
        span: what its variables are told in.
        ahead: its values on each held-out recording, where a periodic one has its phase of its own.
        rivals: other stages at which a law leaves as little of all data.
    """

    law: Law
    values: np.ndarray
    parameters: dict[str, float]
    fit: Fit
    held_out_over_noise: float
    difference: np.ndarray
    span: Span
    ahead: tuple[np.ndarray, ...]
    rivals: tuple[str, ...] = ()

    @property
    def amplitudes(self) -> list[float]:
        """Sizes of the input (SI): of every term with its sign, or the largest of a periodic one."""
        return [math.hypot(*self.values[:2])] if self.law.periodic else self.values.tolist()

    def equation(self) -> str:
        """The law as an equation."""
        unit = "" if self.law.input.unit == "1" else f" {self.law.input.unit}"
        sizes = [f"{size:.3g}{unit}" for size in self.amplitudes]
        if self.law.periodic:
            phase = math.atan2(self.values[1], self.values[0])
            return f"{self.law.input.symbol} = {sizes[0]} * sin(2 pi {self.values[2]:.4g} Hz t + {phase:.2f})"
        products = [
            size if term.name == CONSTANT else f"{size} * {term.name}"
            for size, term in zip(sizes, self.law.terms, strict=True)
        ]
        return f"{self.law.input.symbol} = {' + '.join(products).replace('+ -', '- ')}"


def left_in_all(fit: Fit, held_out_over_noise: float, held_out: Sequence[Experiment]) -> float:
    """Squared residuals, in units of the noise, of training and held-out data together.

    Where two laws predict alike, what they leave of the training data decides too.
    """
    return fit.objective + held_out_over_noise**2 * sum(experiment.counted for experiment in held_out)


def records_of(law: Law, span: Span, values: np.ndarray) -> np.ndarray:
    """A law with its values (SI) as the rollout takes it. # (k,) of `physics.law.LAW`."""
    if law.periodic:
        return law_record(law.input.probe, span, None, *values.tolist())
    return law_records(law.input.probe, span, law.terms, values.tolist())


class LawProblem(Problem):
    """Residuals as a function of the nominal parameters and of a law's own."""

    def __init__(
        self,
        parameters: ParameterSet,
        experiments: Sequence[Experiment],
        step: float,
        law: Law,
        span: Span,
    ) -> None:
        """Prepare."""
        prior = np.where([".effects." in path for path in parameters.paths], np.inf, SPREAD)
        super().__init__(parameters, experiments, step, prior=prior)
        self.law = law
        self.span = span
        self._nominal = len(parameters)
        self._prior_mean = np.concatenate([self._prior_mean, np.full(law.size, 0.5)])
        self._prior_weight = np.concatenate([self._prior_weight, np.zeros(law.size)])

    def law_values(self, unit: np.ndarray) -> np.ndarray:
        """Amplitudes (SI) and frequency [Hz] at a place in the unit cube."""
        own = unit[self._nominal :]
        values = (2.0 * own - 1.0) * self.law.input.scale
        if self.law.periodic:
            values[2] = self.law.frequency + (own[2] - 0.5) / SCAN_S
        return values

    def start(self, nominal: np.ndarray, amplitudes: np.ndarray) -> np.ndarray:
        """Unit vector for nominal parameters and amplitudes (SI), with the frequency [Hz] if one is known better."""
        sizes = amplitudes[: 2 if self.law.periodic else self.law.size]
        own = np.clip(0.5 + 0.5 * sizes / self.law.input.scale, 0.0, 1.0)
        if self.law.periodic:
            known = amplitudes[2] if len(amplitudes) > 2 else self.law.frequency
            own = np.array([*own, 0.5 + (known - self.law.frequency) * SCAN_S])
        return np.concatenate([nominal, own])

    def signals(self, unit: np.ndarray) -> list[Signals]:
        """What the model with the law does in every experiment."""
        records = self.parameters.records(unit[: self._nominal])
        law = records_of(self.law, self.span, self.law_values(unit))
        return [e.simulate(records, self.longest_step, law=law).signals for e in self.experiments]

    def residuals(self, unit: np.ndarray) -> np.ndarray:
        """Measured minus model over noise, of all experiments."""
        self.evaluations += 1
        return self.bounded(
            [e.residuals(s) for e, s in zip(self.experiments, self.signals(unit), strict=True)]
        )

    def _keep(self, unit: np.ndarray, base: np.ndarray) -> None:
        """Nothing is kept: a law's own parameters change every rollout."""
