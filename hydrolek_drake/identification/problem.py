"""The residuals of recordings as a function of the searched parameters."""

import copy
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import TypeVar

import numpy as np

from hydrolek_drake.identification.anchor import Anchor
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.sharing import shared_map
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes, sharing
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.run import Run

DIFFERENCE = 1e-6
"""Step of the forward differences, as a fraction of a parameter's range.

Far above rounding (rollouts repeat to 1e-12), and below the 1e-4 over which the residuals of a joint that
sticks and slips already bend; a step of 1e-4 left fits 10 % above the noise. What says when commands arrive is moved by
a whole step of the integration: steps end there, so that the error of the integration is a saw-tooth over that time,
with the step as its period, whose slope is up to a third of the true one (bench, 0.5 ms) and more with longer steps.
"""

LONGER = 2.0
"""Slopes that only lead a search are told by rollouts with steps so many times as long, ..."""

ALIKE = 0.5
"""... if their residuals differ from those of the problem's own step by no more than this share of these, ..."""

SAME = 0.5
"""... and the slope in a direction to which every parameter adds alike by no more than this share of it. How good a
place is, the residuals with the problem's own step tell (inexact Newton methods: Dembo, Eisenstat, Steihaug, SIAM
Journal on Numerical Analysis 19, 1982)."""

DIVERGED = 1e7
"""Residual, in units of noise, where a diverged simulation has no value: worse than any that ends."""

Own = TypeVar("Own", bound="Problem")
"""A problem, or one of joints that move together; what is made from it is of the same kind."""


class Problem:
    """Weighted residuals of several experiments, all under the same parameters.

    Attributes:
        batch: so many places are best asked for at once.
        scales: differences by which slopes may be told, the widest first [ranges].
    """

    batch = LANES

    def __init__(
        self,
        parameters: ParameterSet,
        experiments: Sequence[Experiment],
        longest_step: float | None = None,
        pool: Executor | None = None,
        prior: np.ndarray | None = None,
        pull_time: float | None = None,
        wide: Sequence[float] = (),
    ) -> None:
        """Prepare.

        Args:
            parameters: what is searched.
            experiments: what must be followed.
            longest_step: of the rollouts [s]; None for the rig's own.
            pool: threads that share the columns of a Jacobian (rollouts run outside Python's lock); the caller may
                be one of them.
            prior: standard deviation of each parameter's place in the unit cube about the rig's own value,
                infinite for those of which nothing is known; None for none of them. # (n,)
            pull_time: with which rollouts are pulled to what was measured [s], so that errors do not pile up:
                residuals then are prediction errors over that time; None for free rollouts.
            wide: differences by which slopes lead a fit before those of `DIFFERENCE` do, the widest first [ranges];
                none where residuals change smoothly.
        """
        self.parameters = parameters
        self.experiments = tuple(experiments)
        self.longest_step = longest_step
        self.pool = pool
        self._arrivals = parameters.arrivals
        self._prior_mean = parameters.unit()
        self._prior_weight = np.zeros(len(parameters)) if prior is None else 1.0 / prior
        self.pull_time = pull_time
        self.scales = (*wide, DIFFERENCE)
        self._anchor = Anchor()
        self._longer_does = True
        self.evaluations = 0
        self.counted = sum(experiment.counted for experiment in self.experiments)
        self.unsure = sum(experiment.unsure for experiment in self.experiments)
        self.admitted = sum(experiment.admitted for experiment in self.experiments)

    def pulled(self: Own, pull_time: float) -> Own:
        """The same with rollouts that are pulled to what was measured, with a time constant [s]."""
        other = self._anew()
        other.pull_time, other._longer_does = pull_time, True
        return other

    def with_step(self: Own, times: float) -> Own:
        """The same with rollouts whose steps are so many times as long."""
        other = self._anew()
        other.longest_step = times * self._longest_step
        return other

    def _anew(self: Own) -> Own:
        """The same without what is known of places, to be given other rollouts."""
        other = copy.copy(self)
        other._anchor, other.evaluations = Anchor(), 0
        return other

    def residuals(self, unit: np.ndarray) -> np.ndarray:
        """Measured minus model over noise, of all experiments.

        Args:
            unit: place in the unit cube. # (n,)

        Returns:
            Experiment after experiment, channel after channel. # (values,)
        """
        return self.residuals_of_all([unit])[0]

    def runs(self, unit: np.ndarray) -> list[Run]:
        """The rollouts of a place, one for each experiment.

        Args:
            unit: place in the unit cube. # (n,)
        """
        records = self.parameters.records(unit)
        return [e.run(records, self.longest_step, pull_time=self.pull_time) for e in self.experiments]

    def residuals_of_all(self, units: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Residuals at several places, each as of `residuals`; they are rolled out in lanes.

        Args:
            units: places in the unit cube. # (n,) each
        """
        self.evaluations += len(units)
        wanted = [run for unit in units for run in self.runs(unit)]
        count = len(self.experiments)
        known = [self._anchor.known(i % count, run) for i, run in enumerate(wanted)]
        made = iter(roll_out_lanes([run for run, part in zip(wanted, known, strict=True) if part is None]))
        parts = [
            self.experiments[i % count].residuals(next(made).signals) if part is None else part
            for i, part in enumerate(known)
        ]
        return [self.bounded(parts[i : i + count]) for i in range(0, len(parts), count)]

    def _keep(self, unit: np.ndarray, base: np.ndarray) -> None:
        """Keep the residuals at a place: a column of the Jacobian changes few joints of a machine."""
        ends = np.cumsum([len(e.channels) * e.time.size for e in self.experiments])
        self._anchor = Anchor(self.runs(unit), np.split(base, ends[:-1]))

    @staticmethod
    def bounded(parts: Sequence[np.ndarray]) -> np.ndarray:
        """Residuals of all experiments in one vector, with a value where a simulation diverged."""
        residuals = np.concatenate(parts)
        return np.clip(np.nan_to_num(residuals, nan=DIVERGED), -DIVERGED, DIVERGED)

    def jacobian(
        self, unit: np.ndarray, at: np.ndarray | None = None, moving: np.ndarray | None = None
    ) -> np.ndarray:
        """Jacobian of the residuals by forward differences (backward near the upper end).

        Args:
            unit: place in the unit cube. # (n,)
            at: the residuals there, if known.
            moving: which parameters may move; None for all. # (n,)

        Returns:
            Change of each residual with each parameter's place, zero for those that are held. # (values, n)
        """
        base = self.residuals(unit) if at is None else at
        if len(self.experiments) > 1:
            self._keep(unit, base)
        return self._columns(unit, moving, base, self.differences(unit))

    def jacobian_without_jumps(
        self, unit: np.ndarray, at: np.ndarray, moving: np.ndarray | None = None
    ) -> np.ndarray:
        """The Jacobian where a hair's breadth may let a joint stop or go on: the smaller of two differences.

        The residuals jump there, from some time on, and a jump over a difference of 1e-6 is more than a slope; a column
        with one is like no other, so that its parameter looks as if it were known far better than it is. Forward and
        backward differences seldom both meet a jump.

        Args:
            unit: place in the unit cube. # (n,)
            at: the residuals there. # (values,)
            moving: as of `jacobian`.
        """
        if len(self.experiments) > 1:
            self._keep(unit, at)
        steps = self.differences(unit)
        back = np.where((unit - steps >= 0.0) & (unit - steps <= 1.0), -steps, 2.0 * steps)
        one, other = (self._columns(unit, moving, at, each) for each in (steps, back))
        return np.where(np.abs(one) < np.abs(other), one, other)

    def _columns(
        self, unit: np.ndarray, moving: np.ndarray | None, base: np.ndarray, steps: np.ndarray
    ) -> np.ndarray:
        """Differences of the residuals over the steps of each parameter that moves. # (values, n)."""

        def some(indices: list[int]) -> list[np.ndarray]:
            places = []
            for i in indices:
                moved = unit.copy()
                moved[i] += steps[i]
                places.append(moved)
            found = self.residuals_of_all(places)
            return [(there - base) / steps[i] for i, there in zip(indices, found, strict=True)]

        indices = list(range(len(unit))) if moving is None else np.flatnonzero(moving).tolist()
        at_once = len(indices) if self.batch > 1 and sharing() is not None else self.batch
        batches = [indices[k : k + at_once] for k in range(0, len(indices), max(at_once, 1))]
        shared = list(map(some, batches)) if self.pool is None else shared_map(self.pool, some, batches)
        columns = [column for found in shared for column in found]
        whole = np.zeros((base.size, len(unit)))
        if columns:
            whole[:, indices] = np.stack(columns, axis=1)
        return whole

    def leading_slopes(
        self, unit: np.ndarray, at: np.ndarray, moving: np.ndarray | None = None
    ) -> np.ndarray | None:
        """The Jacobian to within what a step of a search needs, from rollouts with a longer step.

        Args:
            unit: place in the unit cube. # (n,)
            at: the residuals there, with the problem's own step.
            moving: as of `jacobian`.

        Returns:
            None where a longer step does not do, or did not before.
        """
        if not self._longer_does:
            return None
        longer = self.with_step(LONGER)
        there, slopes = longer._there_and_slopes(unit, moving)
        if np.linalg.norm(there - at) >= ALIKE * np.linalg.norm(at):
            slopes = None
        elif slopes is None:
            slopes = longer.jacobian(unit, there, moving)
        self.evaluations += longer.evaluations
        self._longer_does = slopes is not None and self._same(unit, at, slopes)
        return slopes if self._longer_does else None

    def _there_and_slopes(
        self, unit: np.ndarray, moving: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        """Residuals at a place, and the Jacobian there if it is best had with them, in one table of lanes."""
        if sharing() is None or self.batch == 1 or len({e.index for e in self.experiments}) > 1:
            return self.residuals(unit), None
        steps = self.differences(unit)
        indices = np.arange(unit.size) if moving is None else np.flatnonzero(moving)
        there, *moved = self.residuals_of_all([unit, *(unit + np.diag(steps)[indices])])
        slopes = np.zeros((there.size, unit.size))
        for i, each in zip(indices, moved, strict=True):
            slopes[:, i] = (each - there) / steps[i]
        return there, slopes

    def _same(self, unit: np.ndarray, at: np.ndarray, slopes: np.ndarray) -> bool:
        """Whether slopes are those with the problem's own step, in a direction to which every parameter adds alike."""
        sizes = np.linalg.norm(slopes, axis=0)
        told = (sizes > 0.0) & (self._to_the_next_step(unit) == 0.0)
        way = np.zeros(unit.size)
        way[told] = np.min(sizes[told], initial=np.inf) / sizes[told]
        steps = way * self.differences(unit)
        change = self.residuals(unit + steps) - at
        return bool(np.linalg.norm(slopes @ steps - change) <= SAME * np.linalg.norm(change))

    def differences(self, unit: np.ndarray, scale: float = DIFFERENCE) -> np.ndarray:
        """Differences of the Jacobian: forward, and backward near the upper end. # (n,).

        Args:
            unit: place in the unit cube. # (n,)
            scale: of them [ranges].
        """
        sizes = np.clip(self._to_the_next_step(unit), scale, 0.5)
        return np.where(unit + sizes <= 1.0, sizes, -sizes)

    def _to_the_next_step(self, unit: np.ndarray) -> np.ndarray:
        """One step of the integration, as a change of what says when commands arrive; 0 for all else. # (n,)."""
        own = unit[: len(self.parameters)]
        changes = np.where(self._arrivals, self._longest_step / self.parameters.per_place(own), 0.0)
        return np.concatenate([changes, np.zeros(unit.size - own.size)])

    @property
    def _longest_step(self) -> float:
        """Of the rollouts [s]."""
        return self.longest_step or max(experiment.longest_step for experiment in self.experiments)

    def prior_residuals(self, unit: np.ndarray) -> np.ndarray:
        """Distance of each parameter from the rig's own value, in standard deviations. # (n,)."""
        return (unit - self._prior_mean) * self._prior_weight

    def prior_jacobian(self) -> np.ndarray:
        """Change of the prior residuals with each parameter's place. # (n, n)."""
        return np.diag(self._prior_weight)
