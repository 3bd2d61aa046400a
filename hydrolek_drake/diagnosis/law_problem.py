"""Recordings fitted with the nominal parameters and a law's own."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.laws import CONSTANT, Input, Span, Term, law_record
from hydrolek_drake.diagnosis.workbench import SPREAD
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.rollout.rollout import Signals

SCAN_S = 12.0
"""Frequencies are first looked for in so many seconds."""


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
        rivals: other stages at which a law leaves as little of all data.
    """

    law: Law
    values: np.ndarray
    parameters: dict[str, float]
    fit: Fit
    held_out_over_noise: float
    difference: np.ndarray
    rivals: tuple[str, ...] = ()

    @property
    def amplitude(self) -> float:
        """Largest size of the input (SI), with its sign for a term."""
        return float(self.values[0]) if self.law.term is not None else math.hypot(*self.values[:2])

    def equation(self) -> str:
        """The law as an equation."""
        unit = "" if self.law.input.unit == "1" else f" {self.law.input.unit}"
        if self.law.term is not None:
            times = "" if self.law.term.name == CONSTANT else f" * {self.law.term.name}"
            return f"{self.law.input.symbol} = {self.amplitude:.3g}{unit}{times}"
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
        if self.law.term is None:
            values[2] = self.law.frequency + (own[2] - 0.5) / SCAN_S
        return values

    def start(self, nominal: np.ndarray, amplitudes: np.ndarray) -> np.ndarray:
        """Unit vector for nominal parameters and amplitudes (SI), with the frequency [Hz] if one is known better."""
        sizes = amplitudes[: self.law.size if self.law.term is not None else 2]
        own = np.clip(0.5 + 0.5 * sizes / self.law.input.scale, 0.0, 1.0)
        if self.law.term is None:
            known = amplitudes[2] if len(amplitudes) > 2 else self.law.frequency
            own = np.array([*own, 0.5 + (known - self.law.frequency) * SCAN_S])
        return np.concatenate([nominal, own])

    def signals(self, unit: np.ndarray) -> list[Signals]:
        """What the model with the law does in every experiment."""
        records = self.parameters.records(unit[: self._nominal])
        law = law_record(self.law.input.probe, self.span, self.law.term, *self.law_values(unit))
        return [e.simulate(records, self.longest_step, law=law).signals for e in self.experiments]

    def residuals(self, unit: np.ndarray) -> np.ndarray:
        """Measured minus model over noise, of all experiments."""
        self.evaluations += 1
        return self.bounded(
            [e.residuals(s) for e, s in zip(self.experiments, self.signals(unit), strict=True)]
        )

    def _keep(self, unit: np.ndarray, base: np.ndarray) -> None:
        """Nothing is kept: a law's own parameters change every rollout."""
