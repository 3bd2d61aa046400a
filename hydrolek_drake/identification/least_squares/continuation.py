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
from hydrolek_drake.rigs.driven_by import counts

RUNGS: tuple[tuple[float | None, int], ...] = ((0.1, 8), (0.5, 8), (None, 10))
"""Time constants of the observer [s], and steps of a fit with it; the last one is free."""

HORIZONS = (8, 6, 4, 4, 3, 2, 1)
"""So many places go on from each horizon; each is twice as long as the one before, the last one is all."""

FEWEST = 50
"""Samples of the shortest horizon, at least: fewer do not tell a supply's numbers apart."""

SHORT_STEPS, LONG_STEPS = 10, 20
"""Steps of a fit over a part of the time, and over all of it."""

SEED = 1
"""Of the sequence: the same starts each time."""

TRIED, STARTS, MOST_ROUNDS, FOLLOWED = 1024, 24, 6, 1.2
"""So many places are tried over the shortest horizon in a round, and from the best of them it is fitted; so many rounds
at most, until one place leaves so many times the noise or less: over few samples chance moves it by 5 %, and what is
left beyond that the longer horizons take."""

AGAIN = 2
"""So often the rounds that are left are tried where the first ones do not lead to the noise over all of the time."""

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
        parts, supply = self.parts(), self._supply
        if parts is None:
            return None
        behind = self._by_observers(parts, starts, ~supply)[0]
        if behind.objective > FAR**2 * behind.problem.counted:
            # what it lacks, the supply's numbers would make up for
            return np.where(supply, starts[0], behind.unit)
        return self.supply_before([np.where(supply, start, behind.unit) for start in starts])

    def supply_before(self, starts: Sequence[np.ndarray]) -> np.ndarray:
        """A place where the supply's numbers have been found, what lies behind it staying as it is.

        Args:
            starts: places in the unit cube, which differ in the supply's numbers. # (n,) each
        """
        supply = self._supply
        spread = np.tile(starts[0], (MOST_ROUNDS * TRIED, 1))
        spread[:, supply] = spread_evenly(MOST_ROUNDS * TRIED, int(supply.sum()))
        return self._over_growing_horizons(starts, np.split(spread, MOST_ROUNDS), supply)

    def parts(self) -> tuple[Experiment, ...] | None:
        """The experiments with the chain cut at the recorded supply pressure; None as above."""
        parts = tuple(e.with_recorded_supply() for e in self.experiments)
        uncut = all(part is e for part, e in zip(parts, self.experiments, strict=True))
        if uncut or not self._supply.any() or self.parameters.rig.variants["supply"] != "pump":
            return None
        return parts

    @property
    def _supply(self) -> np.ndarray:
        """Which parameters only act on what lies before the recorded supply pressure. # (n,) truth values."""
        joints = self.parameters.rig.joints
        behind = [counts(path, ("supply.pressure",), joints) for path in self.parameters.paths]
        return ~np.array(behind, dtype=bool)

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
        self, own: Sequence[np.ndarray], rounds: Sequence[np.ndarray], moving: np.ndarray
    ) -> np.ndarray:
        """Where the numbers that move end, from short horizons to all of the time. # (n,).

        The shortest one is fitted from the starts themselves, and from others in rounds as long as none of them follows
        it to the noise: of the places of a round those that leave least. Where they do not lead to the noise over all
        of the time, which the shortest one could not tell, the rounds that are left are tried too.
        """
        left = list(rounds)
        places = self._led_over_horizons(own, left, moving)
        for _ in range(AGAIN):
            if not left or places[0].objective <= FOLLOWED**2 * places[0].problem.counted:
                break
            places += self._led_over_horizons([], left, moving)
            places.sort(key=_objective)
        return places[0].unit

    def _led_over_horizons(
        self, own: Sequence[np.ndarray], rounds: list[np.ndarray], moving: np.ndarray
    ) -> list[Place]:
        """The best place over all of the time, from starts and from rounds, which are used up."""
        whole = max(float(e.time[-1] - e.time[0]) for e in self.experiments)
        samples = min(e.time.size for e in self.experiments)
        most = min(int(math.log2(max(samples / FEWEST, 1.0))), len(HORIZONS) - 1)
        places: list[Place] = []
        for halvings in range(most, -1, -1):
            keep = HORIZONS[len(HORIZONS) - 1 - halvings]
            parts = tuple(e.until(whole / 2**halvings) if halvings else e for e in self.experiments)
            steps, share = (SHORT_STEPS, 1e-3) if halvings else (LONG_STEPS, 1e-4)
            if halvings == most:
                if own:
                    places = self._descended(parts, own, moving, None, steps, share=share)
                while rounds and not (
                    places and places[0].objective <= FOLLOWED**2 * places[0].problem.counted
                ):
                    tried = self._descended(parts, list(rounds.pop(0)), moving, None, 0)
                    units = [place.unit for place in tried[:STARTS]]
                    places += self._descended(parts, units, moving, None, steps, share=share)
                    places.sort(key=_objective)
            else:
                units = [place.unit for place in places]
                places = sorted(
                    self._descended(parts, units, moving, None, steps, share=share), key=_objective
                )
            places = places[:keep]
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


def _objective(place: Place) -> float:
    return place.objective


def spread_evenly(count: int, size: int) -> np.ndarray:
    """Points of a unit cube that fill it evenly: the first ones of a scrambled Sobol sequence. # (count, size)."""
    points = qmc.Sobol(size, rng=np.random.default_rng(SEED)).random(2 ** math.ceil(math.log2(count)))
    return np.asarray(points[:count])
