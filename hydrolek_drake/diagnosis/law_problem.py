"""Recordings fitted with the nominal parameters and a law's own."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from hydrolek_drake.diagnosis.intervals import Interval
from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.laws import CONSTANT, FIRST_REACH, Span, Term, law_record, law_records
from hydrolek_drake.diagnosis.workbench import SPREAD
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.physics.law import PLACED
from hydrolek_drake.replay.display import shown
from hydrolek_drake.rollout.lanes import roll_out_lanes
from hydrolek_drake.rollout.rollout import Signals
from hydrolek_drake.rollout.run import Run

SCAN_S = 12.0
"""Frequencies are first looked for in so many seconds."""


WIDEST = 4.0
"""What acts near a place reaches so many times as far as where its fit begins at most, and as much less at least."""

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
        pulled: whether rollouts that are pulled to the measurements told it, from the rig's own values; then its fit
            begins so.
    """

    input: Input
    terms: tuple[Term, ...]
    frequency: float
    gain: float
    amplitudes: tuple[float, ...]
    pulled: bool = False

    @property
    def periodic(self) -> bool:
        """Whether it is a sine in time."""
        return not self.terms

    @property
    def brakes(self) -> bool:
        """Whether it is a friction, of whatever form."""
        return bool(self.terms) and all(term.speed in FRICTIONS for term in self.terms)

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

    def begun(self, sizes: np.ndarray) -> np.ndarray:
        """All its values, from its amplitudes (SI) alone and where it begins."""
        if self.periodic:
            return np.append(sizes, self.frequency)
        return np.append(sizes, [getattr(self.terms[number], name) for number, name in self.placed])


@dataclass(frozen=True)
class FoundLaw:
    """A fitted law.

    Attributes:
        law: stage and form.
        values: amplitudes (SI), then the numbers of its places (`Law.placed`, as in `laws.Term`); or sine and cosine
            amplitudes and frequency [Hz].
        parameters: full path -> nominal parameters fitted with it.
        fit: on the training data.
        held_out_over_noise: root mean square on held-out data over the noise.
        difference: of the reading on the first training recording, with and without the law. # (n,)
        span: what its variables are told in.
        ahead: its values on each held-out recording of the joint, where a periodic one has its phase of its own.
        joint: at which it acts; of several that were driven, the one whose data `fit` and held-out error are of.
        rivals: other stages at which a law leaves as little of all data.
        parts: of both recordings, to which it was fitted and which were held out, where the training data alone did not
            tell the machine's numbers (`law_by_both`); None where they did.
        intervals: full path -> the parameters fitted with it, with their intervals.
    """

    law: Law
    values: np.ndarray
    parameters: dict[str, float]
    fit: Fit
    held_out_over_noise: float
    difference: np.ndarray
    span: Span
    ahead: tuple[np.ndarray, ...]
    joint: str
    rivals: tuple[str, ...] = ()
    parts: tuple[tuple[Experiment, ...], tuple[Experiment, ...]] | None = None
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
            held_out: in the order of `ahead`, of all joints.
            records: of all joints of the rig, with the parameters fitted with the law. # (joints,)
            step: of the integration [s].
        """
        at_joint = [experiment for experiment in held_out if experiment.joint == self.joint]
        left = [
            e.residuals(self.signals(e, records, step, own))
            for e, own in zip(at_joint, self.ahead, strict=True)
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


def left_in_all(fit: Fit, held_out_over_noise: float, held_out: Sequence[Experiment]) -> float:
    """Squared residuals, in units of the noise, of training and held-out data together.

    Where two laws predict alike, what they leave of the training data decides too.
    """
    return fit.objective + held_out_over_noise**2 * sum(experiment.counted for experiment in held_out)


def records_of(law: Law, span: Span, values: np.ndarray) -> np.ndarray:
    """A law with its values (SI) as the rollout takes it. # (k,) of `physics.law.LAW`."""
    if law.periodic:
        return law_record(law.input.probe, span, None, *values.tolist())
    return law_records(law.input.probe, span, law.at(values).terms, values[: law.sizes].tolist())


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
        self._reaches = [at for at, (_, name) in enumerate(law.placed) if name == "reach"]
        self._prior_mean = np.concatenate([self._prior_mean, np.full(law.size, 0.5)])
        self._prior_weight = np.concatenate([self._prior_weight, np.zeros(law.size)])

    def law_values(self, unit: np.ndarray) -> np.ndarray:
        """A law's values (as of `FoundLaw`) at a place in the unit cube."""
        values = 2.0 * unit[self._nominal :] - 1.0
        sizes, places = values[: self.law.sizes], values[self.law.sizes :]
        sizes *= self.law.input.scale
        if self.law.periodic:
            values[2] = self.law.frequency + 0.5 * values[2] / SCAN_S
        reaches = self._reaches
        places[reaches] = FIRST_REACH * WIDEST ** places[reaches]
        return values

    def start(self, nominal: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Unit vector for nominal parameters and a law's values, the inverse of `law_values`."""
        own = values.astype(float)
        sizes, places = own[: self.law.sizes], own[self.law.sizes :]
        sizes /= self.law.input.scale
        if self.law.periodic:
            own[2] = 2.0 * (own[2] - self.law.frequency) * SCAN_S
        reaches = self._reaches
        places[reaches] = np.log(places[reaches] / FIRST_REACH) / math.log(WIDEST)
        return np.concatenate([nominal, np.clip(0.5 + 0.5 * own, 0.0, 1.0)])

    def runs(self, unit: np.ndarray) -> list[Run]:
        """As of `Problem`, with the law."""
        records = self.parameters.records(unit[: self._nominal])
        law = records_of(self.law, self.span, self.law_values(unit))
        return [
            e.run(records, self.longest_step, pull_time=self.pull_time, law=law) for e in self.experiments
        ]

    def signals(self, unit: np.ndarray) -> list[Signals]:
        """What the model with the law does in every experiment."""
        return [made.signals for made in roll_out_lanes(self.runs(unit))]
