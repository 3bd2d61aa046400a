"""Recordings fitted with the nominal parameters and the windows in which commands were lost."""

from collections.abc import Mapping, Sequence

import numpy as np

from hydrolek_drake.diagnosis.lost_commands.windows import (
    GAIN,
    LONGEST_S,
    NONE,
    SHORTEST_S,
    WINDOW_S,
    Windows,
    recording_of,
)
from hydrolek_drake.diagnosis.structures.workbench import SPREAD
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.rollout.lanes import roll_out_lanes
from hydrolek_drake.rollout.run import Run


class LostProblem(Problem):
    """Residuals as a function of the nominal parameters and of when commands were lost."""

    def __init__(
        self,
        parameters: ParameterSet,
        experiments: Sequence[Experiment],
        step: float,
        begun: Mapping[str, Windows],
        neutral: float,
    ) -> None:
        """Prepare.

        Args:
            parameters: nominal ones.
            experiments: what must be followed.
            step: of the rollouts [s].
            begun: recording -> windows about which those of the fit lie.
            neutral: command that acts in them [V].
        """
        prior = np.where([".effects." in path for path in parameters.paths], np.inf, SPREAD)
        super().__init__(parameters, experiments, step, prior=prior)
        self.begun, self.neutral = begun, neutral
        self._nominal = len(parameters)
        own = 2 * sum(len(lost) for lost in begun.values())
        self._prior_mean = np.concatenate([self._prior_mean, np.full(own, 0.5)])
        self._prior_weight = np.concatenate([self._prior_weight, np.zeros(own)])

    def start(self, nominal: np.ndarray) -> np.ndarray:
        """Unit vector for nominal parameters and the windows about which the fit's lie."""
        lengths = np.concatenate([np.diff(lost, axis=1).ravel() for lost in self.begun.values()])
        own = np.stack([np.full(lengths.size, 0.5), np.minimum(lengths / LONGEST_S, 1.0)], axis=1)
        return np.concatenate([nominal, own.ravel()])

    def windows(self, unit: np.ndarray) -> dict[str, Windows]:
        """Recording -> windows, at a place in the unit cube."""
        own = unit[self._nominal :].reshape(-1, 2)
        found, at = {}, 0
        for name, lost in self.begun.items():
            part = own[at : at + len(lost)]
            at += len(lost)
            middle = lost.mean(axis=1) + (part[:, 0] - 0.5) * 2.0 * WINDOW_S
            half = 0.5 * LONGEST_S * part[:, 1]
            found[name] = np.stack([middle - half, middle + half], axis=1)
        return found

    def about(self, windows: Mapping[str, Windows]) -> "LostProblem":
        """The same with other windows about which those of the fit lie."""
        assert self.longest_step is not None
        return LostProblem(self.parameters, self.experiments, self.longest_step, windows, self.neutral)

    def needed(self, fit: Fit, windows: Mapping[str, Windows], name: str) -> np.ndarray:
        """Which of a recording's windows explain what chance does not, and last. # (k,) truth values.

        While a command is neutral, or too small to open a valve, nobody sees that it is lost.
        """
        records = self.parameters.records(fit.unit[: self._nominal])
        lost = windows[name]
        most = fit.chi_squared + GAIN * max(fit.chi_squared / max(fit.counted, 1), 1.0)
        kept = np.diff(lost, axis=1).ravel() >= SHORTEST_S
        for number in np.flatnonzero(kept).tolist():
            kept[number] = False
            without = self.left(records, {**windows, name: lost[kept]})
            kept[number] = float(without @ without) > most
        return kept

    def runs(self, unit: np.ndarray) -> list[Run]:
        """As of `Problem`, with commands that were lost."""
        return self._runs(self.parameters.records(unit[: self._nominal]), self.windows(unit))

    def left(self, records: np.ndarray, windows: Mapping[str, Windows]) -> np.ndarray:
        """Measured minus model over noise, of all experiments, with some windows."""
        self.evaluations += 1
        made = roll_out_lanes(self._runs(records, windows))
        return self.bounded([e.residuals(m.signals) for e, m in zip(self.experiments, made, strict=True)])

    def _runs(self, records: np.ndarray, windows: Mapping[str, Windows]) -> list[Run]:
        return [
            e.without_command(windows.get(recording_of(e), NONE), self.neutral).run(
                records, self.longest_step
            )
            for e in self.experiments
        ]

    def _to_the_next_step(self, unit: np.ndarray) -> np.ndarray:
        """As of `Problem`; windows begin and end with steps of the integration."""
        changes = super()._to_the_next_step(unit)
        own = self._longest_step * np.array([0.5 / WINDOW_S, 2.0 / LONGEST_S])
        changes[self._nominal :] = np.tile(own, (unit.size - self._nominal) // 2)
        return changes
