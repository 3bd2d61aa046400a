"""Least squares by continuation: from problems with few local minima to the one that is meant.

- An observer forgets its errors, soon at first (prediction errors; Ljung, System Identification, 1999, chapter 7).
- A chain is cut where it is measured: with the recorded supply pressure in place of the supply, what lies behind the
  supply is fitted by itself.
- A horizon grows: a pump's line with a relief valve rings, and where the valve sticks next depends on all before it, so
  that its numbers have a local minimum for every oscillation that they are off. Over a short time there are few, and
  many starts are cheap; those that fit best are followed over twice the time, fewer each time (successive halving;
  Jamieson and Talwalkar, AISTATS 2016; on shooting over growing intervals, Bock, 1983, in Springer Series in Chemical
  Physics 18, 102).
"""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.rigs.machine.driven_by import SUPPLY, counts

RUNGS: tuple[tuple[float | None, int], ...] = ((0.1, 8), (0.5, 8), (None, 10))
"""Time constants of the observer [s], and steps of a fit with it; the last one is free."""

HORIZONS = (8, 6, 4, 4, 4, 4, 4)
"""So many places go on from each horizon; each is twice as long as the one before, the last one is all."""

FEWEST = 50
"""Samples of the shortest horizon, at least: fewer do not tell a supply's numbers apart."""

STEPS = 10
"""Of a fit over each horizon: what is near the noise then is fitted on with all other numbers."""

SEED = 1
"""Of the sequence: the same starts each time."""

TRIED, STARTS, ATTEMPTS, FOLLOWED = 1024, 24, 3, 2.0
"""So many places are tried over the shortest horizon, and the best of them are fitted there; what these lead to over
all of the time is attempted so often until it leaves so many times the noise or less, since what is drawn is not quite
right either. Over the shortest horizon few of them reach it, and longer ones lead on."""

FAR = 3.0
"""A chain that leaves so many times the noise behind the cut lacks something there: the supply is left as it is."""

EDGE = 1e-6
"""Starts are pulled so far inside the cube, from where steps to both sides can be made."""

LAST_STEPS, LAST_WORTH, LAST_SHARE = 32, 0.1, 1e-6
"""Steps of the last fit; it ends where a step promises less squares than this, a third of a standard error, or a lesser
share of what is left."""


@dataclass(frozen=True)
class Continuation:
    """Fits of the same parameters to the same experiments.

    Attributes:
        parameters: what is searched.
        experiments: what must be followed.
        pool: threads.
        cores: that roll out at the same time.
        longest_step: of the rollouts [s]; None for the rig's own.
        prior: as of `Problem`.
        stop: asked before each step; it raises what ends the fit.
        told: told how many rollouts a part took, the least over the noise in it, and where.
    """

    parameters: ParameterSet
    experiments: tuple[Experiment, ...]
    pool: Executor
    cores: int
    longest_step: float | None = None
    prior: np.ndarray | None = None
    stop: Callable[[], None] = lambda: None
    told: Callable[[int, float, np.ndarray], None] = lambda evaluations, over_noise, unit: None

    def from_starts(self, starts: Sequence[np.ndarray]) -> Place:
        """The best place to which some starts lead, fitted to the end.

        Args:
            starts: places in the unit cube. # (n,) each
        """
        cut = self.from_the_cut(starts)
        every = np.ones(len(self.parameters), dtype=bool)
        if cut is None:
            led = self._by_observers(self.experiments, starts, every)
            begun = [place.unit for place in led[:2]]
        else:
            begun = [cut]
        return self._descended(
            self.experiments, begun, every, None, LAST_STEPS, worth=LAST_WORTH, share=LAST_SHARE
        )[0]

    def from_the_cut(self, starts: Sequence[np.ndarray]) -> np.ndarray | None:
        """A place found part by part: what lies behind the recorded supply pressure, and then the supply's numbers.

        Args:
            starts: places in the unit cube. # (n,) each

        Returns:
            None where no pump's pressure is followed, or nothing of the supply is searched. # (n,)
        """
        parts, supply = self._behind(), self._supply
        if parts is None:
            return None
        behind = self._by_observers(parts, starts, ~supply)[0]
        if behind.objective > FAR**2 * behind.problem.counted:
            # what it lacks, the supply's numbers would make up for
            return np.where(supply, starts[0], behind.unit)
        return self.supply_before([np.where(supply, start, behind.unit) for start in starts])[0]

    def supply_before(self, starts: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Places where the supply's numbers have been found under the flow that is drawn of it, the best first.

        What lies behind it stays as it is. While its numbers are not quite right either, it is not told which of the
        places is.

        Args:
            starts: places in the unit cube, which differ in the supply's numbers. # (n,) each
        """
        supply = self._supply
        spread = np.tile(starts[0], (ATTEMPTS * TRIED, 1))
        spread[:, supply] = spread_evenly(ATTEMPTS * TRIED, int(supply.sum()))
        return self._over_growing_horizons(starts, np.split(spread, ATTEMPTS), supply)

    def _behind(self) -> tuple[Experiment, ...] | None:
        """The experiments behind the recorded supply pressure; None as above."""
        cut = cut_where_measured(self.parameters, self.experiments)
        return tuple(e.behind_cut() for e in cut) if any(e.cut for e in cut) else None

    @property
    def _supply(self) -> np.ndarray:
        """Which parameters only act on what lies before the recorded supply pressure. # (n,) truth values."""
        return of_the_supply(self.parameters)

    def _by_observers(
        self, experiments: tuple[Experiment, ...], starts: Sequence[np.ndarray], moving: np.ndarray
    ) -> list[Place]:
        """Fits through `RUNGS`, the best first."""
        units = list(starts)
        for pull_time, steps in RUNGS:
            places = self._descended(experiments, units, moving, pull_time, steps)
            if places[0].objective > FAR**2 * places[0].problem.counted:
                break  # a longer memory leaves no less
            units = [place.unit for place in places]
        return places

    def _over_growing_horizons(
        self, own: Sequence[np.ndarray], others: Sequence[np.ndarray], moving: np.ndarray
    ) -> list[np.ndarray]:
        """Where the numbers that move end, from short horizons to all of the time, the best first. # (n,) each.

        They begin at the starts themselves and at the best of some others, and again at the best of others as long as
        none is followed to the noise and none is far from it, as where the supply lacks something.
        """
        places: list[Place] = []
        for tried in others:
            places += self._led_over_horizons([] if places else own, tried, moving)
            places.sort(key=_objective)
            left = places[0].objective / places[0].problem.counted
            if left <= FOLLOWED**2 or left > FAR**2:
                break
        return [place.unit for place in places[: HORIZONS[-1]]]

    def _led_over_horizons(
        self, own: Sequence[np.ndarray], tried: np.ndarray, moving: np.ndarray
    ) -> list[Place]:
        """The best places over all of the time, from starts and from the best of those that are tried."""
        whole = max(float(e.time[-1] - e.time[0]) for e in self.experiments)
        samples = min(e.time.size for e in self.experiments)
        before = tuple(e.cut_at_supply().before_cut() for e in self.experiments)
        most = min(int(math.log2(max(samples / FEWEST, 1.0))), len(HORIZONS) - 1)
        units = list(own)
        for halvings in range(most, -1, -1):
            parts = tuple(e.until(whole / 2**halvings) if halvings else e for e in before)
            if halvings == most:
                looked_at = self._descended(parts, list(tried), moving, None, 0)
                units += [place.unit for place in looked_at[:STARTS]]
            places = self._descended(parts, units, moving, None, STEPS, share=1e-3)
            places = places[: HORIZONS[len(HORIZONS) - 1 - halvings]]
            units = [place.unit for place in places]
        return places

    def _descended(
        self,
        experiments: tuple[Experiment, ...],
        starts: Sequence[np.ndarray],
        moving: np.ndarray,
        pull_time: float | None,
        steps: int,
        *,
        worth: float = 1.0,
        share: float = 1e-4,
    ) -> list[Place]:
        """Fits from some places in lockstep, the best first."""
        problems = [
            Problem(self.parameters, experiments, self.longest_step, prior=self.prior, pull_time=pull_time)
            for _ in starts
        ]
        begun = [
            Place(problem, moving, np.where(moving, np.clip(start, EDGE, 1.0 - EDGE), start))
            for problem, start in zip(problems, starts, strict=True)
        ]
        places = descend(
            begun, steps, self.pool, self.cores, worth=worth, share=share, leading=1.0, stop=self.stop
        )
        places.sort(key=lambda place: place.objective)
        best = places[0]
        assert best.residuals is not None
        over_noise = float(np.sqrt(best.residuals @ best.residuals / max(best.problem.counted, 1)))
        self.told(sum(problem.evaluations for problem in problems), over_noise, best.unit)
        return places


def of_the_supply(parameters: ParameterSet) -> np.ndarray:
    """Which parameters only act on what lies before the recorded supply pressure. # (n,) truth values."""
    behind = [counts(path, (SUPPLY,), parameters.rig.joints) for path in parameters.paths]
    return ~np.array(behind, dtype=bool)


def cut_where_measured(parameters: ParameterSet, experiments: Sequence[Experiment]) -> tuple[Experiment, ...]:
    """Experiments cut at the supply pressure of a pump, where it was recorded and something of the pump is searched."""
    if parameters.rig.variants["supply"] != "pump" or not of_the_supply(parameters).any():
        return tuple(experiments)
    return tuple(e.cut_at_supply() for e in experiments)


def _objective(place: Place) -> float:
    return place.objective


def spread_evenly(count: int, size: int) -> np.ndarray:
    """Points of a unit cube that fill it evenly: the first ones of a scrambled Sobol sequence. # (count, size)."""
    points = qmc.Sobol(size, rng=np.random.default_rng(SEED)).random(2 ** math.ceil(math.log2(count)))
    return np.asarray(points[:count])
