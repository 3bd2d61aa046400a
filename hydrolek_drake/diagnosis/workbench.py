"""Fits of the nominal model and of models with effects, all to the same recordings."""

import math
import threading
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor, wait
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.effort import GLANCE_S
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm, WithTerms
from hydrolek_drake.diagnosis.structures.lost_windows import LostProblem, LostWindows, WithWindows
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit, fit_from
from hydrolek_drake.identification.parameter_set import Free, ParameterSet
from hydrolek_drake.identification.problem import DIFFERENCE, Problem
from hydrolek_drake.identification.valleys import along_valleys
from hydrolek_drake.physics import supply
from hydrolek_drake.rigs import Rig

SPREAD = 1.0 / math.sqrt(12.0)
"""Standard deviation, in ranges, of a parameter of which only its range is known.

Used as a weak prior about the rig's own values: what a recording does not tell stays where the rig has it,
instead of wandering off to make up for physics that is missing.
"""

STEP_SHARE = 0.5
"""A coarse step may be wrong by this share of what is to be explained: a quarter of the squared residuals."""


@dataclass(frozen=True)
class Hypothesis:
    """The nominal model with some effects, fitted.

    Attributes:
        effects: what is added to the nominal model; empty for the nominal model itself.
        values: full path -> fitted value (SI), nominal parameters first.
        fit: how well it follows the training data, and its Jacobian.
        step: integration step with which it was fitted [s].
    """

    effects: tuple[Candidate, ...]
    values: dict[str, float]
    fit: Fit
    step: float

    @property
    def ids(self) -> frozenset[str]:
        """What identifies it: id and joint of its effects."""
        return key_of(self.effects)

    def without(self, effect: Candidate) -> tuple[Candidate, ...]:
        """Its effects but for one."""
        return tuple(c for c in self.effects if c is not effect)

    @property
    def extra(self) -> int:
        """Parameters that the nominal model does not have."""
        return sum(len(candidate.free) for candidate in self.effects)


def key_of(effects: Iterable[Candidate]) -> frozenset[str]:
    """A set of effects, whatever their order."""
    return frozenset(candidate.size_path for candidate in effects)


def moments_of(effects: Iterable[Candidate]) -> list[Free]:
    """Parameters of some effects that say when something happens."""
    return [free for candidate in effects for free in candidate.moments]


class Workbench:
    """Recordings for training, the rig's nominal parameters, and fits of any set of effects."""

    def __init__(
        self,
        rig: Rig,
        nominal: Sequence[Free],
        training: Sequence[Experiment],
        pool: Executor,
    ) -> None:
        """Prepare.

        Args:
            rig: the machine with nominal values and all searched effects off.
            nominal: its free parameters.
            training: the recordings that are fitted; `training` is weighed anew in time, and `recorded` stays.
            pool: threads for fits side by side, and for the columns of a fit's Jacobian where some are idle.
        """
        self.rig = rig
        self.nominal = tuple(nominal)
        self.recorded = self.training = tuple(training)
        self.pool = pool
        self._stopped = threading.Event()
        self.evaluations = 0
        self.first_s = GLANCE_S
        self._sets: dict[frozenset[Free], ParameterSet] = {}

    def with_training(self, training: Sequence[Experiment]) -> "Workbench":
        """Another one for other recordings of the same machine."""
        return Workbench(self.rig, self.nominal, training, self.pool)

    def beginning(self) -> list[Experiment]:
        """The part of the recordings that first fits see, see `beginning`."""
        return [experiment.until(self.first_s) for experiment in self.training]

    def interrupted(self) -> bool:
        """Whether the user has interrupted."""
        return self._stopped.is_set()

    def alive(self) -> None:
        """End this thread's work if the user has interrupted."""
        if self.interrupted():
            raise KeyboardInterrupt

    def resume(self) -> None:
        """Work again after an interrupt."""
        self._stopped.clear()

    @property
    def fine(self) -> float:
        """The rig's own integration step [s]."""
        return self.training[0].longest_step

    @property
    def together(self) -> bool:
        """Whether joints move at the same time."""
        return any(experiment.others is not None for experiment in self.training)

    @property
    def alike(self) -> int:
        """How many signals count alike, see `balance`; 1 where each counts by its noise."""
        channels = {c.key: c.widened for experiment in self.training for c in experiment.channels}
        return len(channels) if any(widened > 1.0 for widened in channels.values()) else 1

    def parameters(self, effects: Sequence[Candidate]) -> ParameterSet:
        """The searched parameters of the nominal model with these effects."""
        own = [p for candidate in effects for p in candidate.free]
        key = frozenset(own)  # with their ranges, which may be widened
        if key not in self._sets:
            terms = [c for c in effects if isinstance(c, LawTerm)]
            lost = [c for c in effects if isinstance(c, LostWindows)]
            of_rig = [p for c in effects if not isinstance(c, LawTerm | LostWindows) for p in c.free]
            found = (
                WithTerms(self.rig, [*self.nominal, *of_rig], terms)
                if terms
                else ParameterSet(self.rig, [*self.nominal, *of_rig])
            )
            self._sets[key] = WithWindows(found, lost) if lost else found
        return self._sets[key]

    def problem(
        self,
        effects: Sequence[Candidate],
        step: float,
        experiments: Sequence[Experiment] | None = None,
        pull_time: float | None = None,
        difference: float = DIFFERENCE,
        kind: type[Problem] = Problem,
    ) -> Problem:
        """Residuals of this model, on the training data unless others are given."""
        parameters = self.parameters(effects)
        prior = np.full(len(parameters), np.inf)
        prior[: len(self.nominal)] = SPREAD
        if kind is Problem and isinstance(parameters, WithWindows):
            kind = LostProblem
        return kind(
            parameters,
            experiments or self.training,
            step,
            pool=self.pool,
            prior=prior,
            pull_time=pull_time,
            difference=difference,
        )

    def fit(
        self,
        effects: Sequence[Candidate],
        values: dict[str, float],
        step: float,
        most_steps: int,
        tolerance: float = 1e-5,
        experiments: Sequence[Experiment] | None = None,
        pull_time: float | None = None,
        alone: bool = False,
        difference: float = DIFFERENCE,
    ) -> Hypothesis:
        """Fit the nominal model with these effects; when something happens stays as it starts, see `moments`.

        Args:
            effects: what is added.
            values: full path -> start; parameters that are not named start at the rig's own value.
            step: integration step [s].
            most_steps: of the trust-region method.
            tolerance: relative change of the squared residuals at which it ends.
            experiments: to be fitted; None for all training data.
            pull_time: of the rollouts, as in `Problem`; None for free ones.
            alone: leave joints on which none of the effects acts as they start.
            difference: of the Jacobian, as in `Problem`.
        """
        self.alive()
        effects = tuple(effects)
        problem = self.problem(effects, step, experiments, pull_time, difference)
        parameters = problem.parameters
        moving = self.movable(effects, parameters)
        if alone and effects:
            moving &= self._acted_on(effects, parameters)
        fit = fit_from(
            problem,
            parameters.unit(values),
            most_steps=most_steps,
            tolerance=tolerance,
            stop=self.interrupted,
            moving=moving,
        )
        self.evaluations += fit.evaluations
        return Hypothesis(effects, parameters.values(fit.unit), fit, step)

    @staticmethod
    def movable(effects: Sequence[Candidate], parameters: ParameterSet) -> np.ndarray:
        """Parameters that least squares can move: all but moments, see `moments`. # (n,)."""
        held = {free.path for free in moments_of(effects)}
        return np.array([path not in held for path in parameters.paths])

    def joints_of(self, effects: Sequence[Candidate]) -> set[str]:
        """Joints on which effects act: the supply's act on every joint, whichever carries their parameters."""
        if any(candidate.effect.stage == supply.STAGE.name for candidate in effects):
            return set(self.rig.joints)
        return {candidate.joint for candidate in effects}

    def _acted_on(self, effects: Sequence[Candidate], parameters: ParameterSet) -> np.ndarray:
        """Parameters of the joints on which effects act, and those that all joints share. # (n,)."""
        joints = self.joints_of(effects)
        return np.array(
            [not path.startswith("joints.") or path.split(".")[1] in joints for path in parameters.paths]
        )

    def refit(
        self,
        hypothesis: Hypothesis,
        step: float,
        most_steps: int,
        tolerance: float = 1e-5,
        alone: bool = False,
    ) -> Hypothesis:
        """Go on from where a fit ended, usually with a finer step."""
        return self.fit(hypothesis.effects, hypothesis.values, step, most_steps, tolerance, alone=alone)

    def along_valleys(self, hypothesis: Hypothesis, tolerance: float = 1e-4) -> Hypothesis:
        """Go on from lower places along what the data tell least, if there are any (`valleys.along_valleys`)."""
        self.alive()
        problem = self.problem(hypothesis.effects, hypothesis.step)
        moving = self.movable(hypothesis.effects, problem.parameters)
        fit = along_valleys(problem, hypothesis.fit, tolerance, self.interrupted, moving)
        self.evaluations += problem.evaluations
        return replace(hypothesis, values=problem.parameters.values(fit.unit), fit=fit)

    def without_jumps(self, hypothesis: Hypothesis) -> Hypothesis:
        """The same fit with slopes that are worth an interval (`Problem.jacobian_without_jumps`)."""
        problem = self.problem(hypothesis.effects, hypothesis.step)
        moving = self.movable(hypothesis.effects, problem.parameters)
        unit = hypothesis.fit.unit
        slopes = problem.jacobian_without_jumps(unit, problem.residuals(unit), moving)
        return replace(hypothesis, fit=replace(hypothesis.fit, slopes=slopes))

    def residuals(self, hypothesis: Hypothesis, experiments: Sequence[Experiment], step: float) -> np.ndarray:
        """Residuals of a fitted model on any recordings, in units of the noise. # (values,)."""
        problem = self.problem(hypothesis.effects, step, experiments)
        return problem.residuals(problem.parameters.unit(hypothesis.values))

    def side_by_side(self, work: Callable, items: Sequence) -> list:
        """Results of independent pieces of work, in their order; an interrupt cancels those not begun."""
        futures = [self.pool.submit(work, item) for item in items]
        try:
            return [future.result() for future in futures]
        except BaseException:
            self._stopped.set()
            for future in futures:
                future.cancel()
            wait(futures)
            raise

    def coarsest(self, hypothesis: Hypothesis, over: float, most: float) -> float:
        """Integration step [s] at most so many times the rig's own whose error is below what is to be explained.

        Args:
            hypothesis: at whose values the error is told.
            over: what is to be explained, in units of the noise.
            most: the coarsest that is asked for, over the rig's own.
        """
        if most <= 1.0:
            return self.fine
        exact = self.residuals(hypothesis, self.training, self.fine)
        counted = sum(experiment.counted for experiment in self.training)
        while most > 1.0:
            error = self.residuals(hypothesis, self.training, most * self.fine) - exact
            if np.nan_to_num(error @ error, nan=np.inf) < (STEP_SHARE * over) ** 2 * counted:
                break
            most *= 0.5
        return max(most, 1.0) * self.fine
