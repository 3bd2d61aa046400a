"""A law for physics in no list, as it was found and is told, and how far its numbers are known."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from hydrolek_drake.diagnosis.intervals.curvature import NORMAL, Interval, covariance_of
from hydrolek_drake.diagnosis.settings import LOCATING
from hydrolek_drake.diagnosis.structures.inputs import Input
from hydrolek_drake.diagnosis.structures.term_forms import CONSTANT, Span, Term, law_record, law_records
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.physics.law import PLACED
from hydrolek_drake.replay.display import shown
from hydrolek_drake.rollout.rollout import Signals

FRICTIONS = ("sign(v)", "v", "v |v|")
"""Factors of a term that changes its sign with the speed."""


@dataclass(frozen=True)
class Law:
    """A law at a stage.

    Attributes:
        input: what it gives.
        terms: of which it is the sum; none for a periodic one.
        frequency: first guess [Hz]; 0 for terms.
    """

    input: Input
    terms: tuple[Term, ...]
    frequency: float

    @property
    def periodic(self) -> bool:
        """Whether it is a sine in time."""
        return not self.terms

    @property
    def placed(self) -> tuple[tuple[int, str], ...]:
        """Which of its terms have which numbers of a place (`physics.law.PLACED`), that are fitted."""
        return tuple(
            (number, name) for number, term in enumerate(self.terms) for name in PLACED.get(term.place, ())
        )

    @property
    def sizes(self) -> int:
        """How many of its parameters are amplitudes."""
        return 2 if self.periodic else len(self.terms)

    @property
    def size(self) -> int:
        """How many parameters it has: amplitudes, then a frequency, or the numbers of its places."""
        return 3 if self.periodic else self.sizes + len(self.placed)

    def at(self, values: np.ndarray) -> "Law":
        """The law with its placed terms where they were fitted."""
        if not self.placed:
            return self
        terms = list(self.terms)
        for (number, name), value in zip(self.placed, values[self.sizes :].tolist(), strict=True):
            terms[number] = replace(terms[number], **{name: value})
        return replace(self, terms=tuple(terms))


@dataclass(frozen=True)
class FoundLaw:
    """A fitted law.

    Attributes:
        law: stage and form.
        values: amplitudes (SI), then the numbers of its places (`Law.placed`, as in `terms.Term`); or sine and cosine
            amplitudes and frequency [Hz].
        parameters: full path -> nominal parameters fitted with it.
        fit: on the training data.
        held_out_over_noise: root mean square on held-out data over the noise.
        difference: of the reading on the first training recording, with and without the law. # (n,)
        span: what its variables are told in.
        held_out_values: its values on each held-out recording of the joint, where a periodic one has a phase of its
            own.
        joint: at which it acts; of several that were driven, the one whose data `fit` and held-out error are of.
        rivals: other stages at which a law leaves as little of all data.
        intervals: full path -> the parameters fitted with it, with their intervals.
    """

    law: Law
    values: np.ndarray
    parameters: dict[str, float]
    fit: Fit
    held_out_over_noise: float
    difference: np.ndarray
    span: Span
    held_out_values: tuple[np.ndarray, ...]
    joint: str
    rivals: tuple[str, ...] = ()
    intervals: Mapping[str, Interval] = field(default_factory=dict)

    of_the_machine: ClassVar[bool] = True
    """Whether a rig can hold it."""

    remark: ClassVar[str] = ""
    """What is to be said of it where it has no letters to explain."""

    @property
    def condition(self) -> str:
        """When it acts, as far as its form tells; empty if it does not."""
        return f"periodic, {self.values[2]:.3g} Hz" if self.law.periodic else ""

    @property
    def acts(self) -> tuple[tuple[float, float], ...]:
        """When it acts in the first training recording [s], if its form tells; empty if it always may."""
        return ()

    def more(self) -> dict[str, Any]:
        """What `report.json` tells of it beside its amplitudes."""
        return {}

    def signals(
        self, experiment: Experiment, records: np.ndarray, step: float, values: np.ndarray
    ) -> Signals:
        """What a model with the law does.

        Args:
            experiment: whose commands it is given.
            records: of all joints of the rig. # (joints,)
            step: of the integration [s].
            values: the law's on this recording.
        """
        return experiment.simulate(records, step, law=records_of(self.law, self.span, values)).signals

    def held_against(self, held_out: Sequence[Experiment], records: np.ndarray, step: float) -> "FoundLaw":
        """The law with what it leaves of held-out data, of which the weights may have changed since it was found.

        Args:
            held_out: in the order of `held_out_values`, of all joints.
            records: of all joints of the rig, with the parameters fitted with the law. # (joints,)
            step: of the integration [s].
        """
        at_joint = [experiment for experiment in held_out if experiment.joint == self.joint]
        left = [
            e.residuals(self.signals(e, records, step, own))
            for e, own in zip(at_joint, self.held_out_values, strict=True)
        ]
        squares = sum(float(part @ part) for part in left)
        counted = sum(experiment.counted for experiment in at_joint)
        return replace(self, held_out_over_noise=math.sqrt(squares / max(counted, 1)))

    @property
    def amplitudes(self) -> list[float]:
        """Sizes of the input (SI): of every term with its sign, or the largest of a periodic one."""
        sizes = self.values[: self.law.sizes]
        return [math.hypot(*sizes)] if self.law.periodic else sizes.tolist()

    @property
    def names(self) -> list[str]:
        """Of its terms, with the places near which they act."""
        reach = self.span.at(self.law.input.probe)

        def told(term: Term) -> str:
            if term.place not in PLACED:
                return term.name
            where = [reach.position(term.centre), reach.distance(term.reach)][: len(PLACED[term.place])]
            told = ", ".join(shown(each, reach.unit) for each in where)
            return term.name.replace(term.place, f"{term.place}({told})")

        return [told(term) for term in self.law.at(self.values).terms]

    def equation(self) -> str:
        """The law as an equation."""
        sizes = [shown(size, self.law.input.unit) for size in self.amplitudes]
        if self.law.periodic:
            phase = math.atan2(self.values[1], self.values[0])
            sine = f"sin(2 pi {self.values[2]:.4g} Hz t {'-' if phase < 0.0 else '+'} {abs(phase):.2f})"
            return f"{self.law.input.symbol} = {sizes[0]} * {sine}"
        products = [
            size if name == CONSTANT else f"{size} * {name}"
            for size, name in zip(sizes, self.names, strict=True)
        ]
        return f"{self.law.input.symbol} = {' + '.join(products).replace('+ -', '- ')}"


def records_of(law: Law, span: Span, values: np.ndarray) -> np.ndarray:
    """A law with its values (SI) as the rollout takes it. # (k,) of `physics.law.LAW`."""
    if law.periodic:
        return law_record(law.input.probe, span, None, *values.tolist())
    return law_records(law.input.probe, span, law.at(values).terms, values[: law.sizes].tolist())


def amplitude_intervals(found: FoundLaw) -> list[Interval]:
    """Sizes of a law's terms with their 95 % intervals, or the amplitude of a periodic one (SI).

    Sine and cosine of a periodic one have the amplitude a = sqrt(s^2 + c^2), whose variance is (s, c) C (s, c)' / a^2
    to first order.

    Args:
        found: a fitted law; of commands that got lost, which are each found by themselves, nothing is told.
    """
    if not found.of_the_machine:
        return []
    law = found.law
    own = covariance_of(found.fit)[-law.size :, -law.size :]
    covariance = (2.0 * law.input.scale) ** 2 * own[: law.sizes, : law.sizes]
    if law.periodic:
        [amplitude] = found.amplitudes
        along = found.values[: law.sizes] / max(amplitude, np.finfo(float).tiny)
        variances = [float(along @ covariance @ along)]
    else:
        variances = np.diag(covariance).tolist()
    return [_interval(size, variance) for size, variance in zip(found.amplitudes, variances, strict=True)]


def frequency_interval(found: FoundLaw) -> Interval:
    """Frequency of a periodic law with its 95 % interval [Hz]."""
    return _interval(float(found.values[2]), float(covariance_of(found.fit)[-1, -1]) / LOCATING.scan_s**2)


def _interval(value: float, variance: float) -> Interval:
    half = NORMAL * math.sqrt(max(variance, 0.0))
    return Interval(value, value - half, value + half)
