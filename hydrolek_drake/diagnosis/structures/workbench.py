"""Fits of the nominal model and of models with effects, all to the same recordings."""

import contextlib
import math
import threading
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor, wait
from dataclasses import replace
from typing import Any

import numpy as np

from hydrolek_drake.diagnosis.progress import Progress
from hydrolek_drake.diagnosis.settings import FITS, Settings
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis, moments_of
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm, WithTerms
from hydrolek_drake.diagnosis.structures.lost_windows import LostProblem, LostWindows, WithWindows
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.recorded_together import OneRecording
from hydrolek_drake.identification.parameter_set import Free, ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_together import ProblemTogether
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.pool import RolloutPool

SPREAD = 1.0 / math.sqrt(12.0)
"""Standard deviation, in ranges, of a parameter of which only its range is known.

Used as a weak prior about the rig's own values: what a recording does not tell stays where the rig has it,
instead of wandering off to make up for physics that is missing.
"""


class Workbench:
    """Recordings for training, the rig's nominal parameters, and fits of any set of effects."""

    def __init__(
        self,
        rig: Rig,
        nominal: Sequence[Free],
        training: Sequence[Experiment],
        pool: Executor,
        cores: int = 1,
        progress: Progress | None = None,
        *,
        settings: Settings | None = None,
        signals_apart: bool = False,
        coarsest: float = FITS.coarse,
    ) -> None:
        """Prepare.

        Args:
            rig: the machine with nominal values and all searched effects off.
            nominal: its free parameters.
            training: the recordings that are fitted; weighed anew in time.
            pool: threads for fits side by side, and for the columns of a fit's Jacobian where some are idle.
            cores: that roll out at the same time.
            progress: told how the fits stand; None for nobody.
            settings: of the search; None for the usual ones.
            signals_apart: whether each signal has a discrepancy of its own (`weighing`).
            coarsest: rollouts in steps so many times the rig's own do not run away (`fitting.longest_step`).
        """
        self.rig = rig
        self.nominal = tuple(nominal)
        self.training = tuple(training)
        self.pool = pool
        self.cores = cores
        self.progress = progress or Progress()
        self.settings = settings or Settings()
        self.signals_apart = signals_apart
        self.coarsest = coarsest
        self._stopped = threading.Event()
        self.evaluations = 0
        self._places: dict[Free, tuple[np.ndarray, np.ndarray]] = {}
        self._moving: dict[Any, OneRecording] = {}
        self._sets: dict[frozenset[Free], ParameterSet] = {}

    def with_training(
        self, training: Sequence[Experiment], *, signals_apart: bool | None = None
    ) -> "Workbench":
        """Another one for other recordings of the same machine.

        Args:
            training: these.
            signals_apart: whether each signal has a discrepancy of its own; None for as here.
        """
        apart = self.signals_apart if signals_apart is None else signals_apart
        self.progress.anew()
        return Workbench(
            self.rig,
            self.nominal,
            training,
            self.pool,
            self.cores,
            self.progress,
            settings=self.settings,
            signals_apart=apart,
            coarsest=self.coarsest,
        )

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

    def step_for(self, effects: Iterable[Addition], coarse: float = 1.0) -> float:
        """The integration step that resolves a structure [s]; joints that move together have one step.

        Args:
            effects: of the structure.
            coarse: so many times as long, where rollouts in such steps do not run away.
        """
        share = 1.0 if self.together else min((c.step_share for c in effects), default=1.0)
        return share * min(coarse, self.coarsest) * self.fine

    @property
    def together(self) -> bool:
        """Whether joints move at the same time."""
        return any(experiment.others is not None for experiment in self.training)

    @property
    def cut(self) -> bool:
        """Whether a recorded signal stands in place of a part of the machine, which the rig does not say."""
        return any(experiment.cut for experiment in self.training)

    @property
    def follows_supply(self) -> bool:
        """Whether a supply's pressure is among what is followed."""
        return any(channel.model == "supply_pressure" for e in self.training for channel in e.channels)

    def numbers(self, effects: Sequence[Addition]) -> tuple[Free, ...]:
        """The rig's own searched numbers with these effects: those of the nominal model, and what the effects read."""
        read = {n: None for c in effects if isinstance(c, Candidate) for n in c.numbers}
        return (*self.nominal, *(n for n in read if n not in self.nominal))

    def parameters(self, effects: Sequence[Addition]) -> ParameterSet:
        """The searched parameters of the nominal model with these effects."""
        numbers = self.numbers(effects)
        own = [p for candidate in effects for p in candidate.free]
        key = frozenset([*numbers, *own])  # with their ranges, which may be widened
        if key not in self._sets:
            terms = [c for c in effects if isinstance(c, LawTerm)]
            lost = [c for c in effects if isinstance(c, LostWindows)]
            of_rig = [p for c in effects if not isinstance(c, LawTerm | LostWindows) for p in c.free]
            found = (
                WithTerms(self.rig, [*numbers, *of_rig], terms, self._places)
                if terms
                else ParameterSet(self.rig, [*numbers, *of_rig], self._places)
            )
            self._sets[key] = WithWindows(found, lost) if lost else found
        return self._sets[key]

    def problem(
        self,
        effects: Sequence[Addition],
        step: float,
        experiments: Sequence[Experiment] | None = None,
        pull_time: float | None = None,
        kind: type[Problem] = Problem,
    ) -> Problem:
        """Residuals of this model, on the training data unless others are given."""
        parameters = self.parameters(effects)
        prior = np.full(len(parameters), np.inf)
        prior[: len(self.numbers(effects))] = SPREAD
        if kind is Problem and isinstance(parameters, WithWindows):
            kind = LostProblem
        known = {"known": self._moving} if issubclass(kind, ProblemTogether) else {}
        return kind(
            parameters,
            experiments or self.training,
            step,
            pool=self.pool,
            prior=prior,
            pull_time=pull_time,
            wide=FITS.wide if any(c.step_share < 1.0 for c in effects) else (),
            **known,
        )

    def values_in(self, hypothesis: Hypothesis, recording: str) -> dict[str, float]:
        """Full path -> value of a fitted structure in a recording; the same in all of them.

        Args:
            hypothesis: the structure.
            recording: its name.
        """
        return hypothesis.values

    @staticmethod
    def movable(effects: Sequence[Addition], parameters: ParameterSet) -> np.ndarray:
        """Parameters that least squares can move: all but moments, see `intervals.last_numbers`. # (n,)."""
        held = {free.path for free in moments_of(effects)}
        return np.array([path not in held for path in parameters.paths])

    def without_jumps(self, hypothesis: Hypothesis) -> Hypothesis:
        """The same fit with slopes that are worth an interval (`Problem.jacobian_without_jumps`).

        Of joints that move together the slopes are those of the fit.
        """
        if self.together:
            return hypothesis
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
        """Results of independent pieces of work, in their order; an interrupt cancels those not begun.

        What several pieces roll out at the same time goes into common tables of lanes.
        """
        with self._threads() as threads:
            futures = [threads.submit(work, item) for item in items]
            try:
                return [future.result() for future in futures]
            except BaseException:
                self._stopped.set()
                for future in futures:
                    future.cancel()
                wait(futures)
                raise

    def _threads(self) -> contextlib.AbstractContextManager[Executor]:
        """Threads for pieces of work; a cluster has its own."""
        if isinstance(self.pool, ThreadPoolExecutor):
            return RolloutPool(self.cores)
        return contextlib.nullcontext(self.pool)
