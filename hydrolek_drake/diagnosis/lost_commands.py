"""Commands that got lost on their way: windows in which the machine did what it does without any.

Such windows follow no law, so they are found in each recording. While a command is lost a joint misses a piece of its
way, and the rest of an open-loop recording is off by that; what a short window would do is simulated at every place of
the recording, and those are picked one after the other that explain most, as in orthogonal matching pursuit (Pati,
Rezaiifar, Krishnaprasad, 27th Asilomar Conference on Signals, Systems and Computers, 1993). Where they begin and how
long they last is then fitted together with the nominal parameters.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from scipy.optimize import nnls

from hydrolek_drake.diagnosis.law_problem import FoundLaw, Law
from hydrolek_drake.diagnosis.laws import Input, Span, Term
from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.workbench import SPREAD, Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit, fit_from
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.rollout.rollout import Signals

WINDOW_S = 0.1
"""Length of the windows that are tried, side by side."""

LONGEST_S = 5.0 * WINDOW_S
"""A command that is lost for longer is a recording of two pieces."""

SHORTEST_S = 0.1 * WINDOW_S
"""What is lost for less is about one sample of a controller, and moves nothing."""

MOST_SHARE = 0.1
"""So much of a recording may be lost at most: a line that loses more is not in use."""

GAIN = 25.0
"""Fall of the squared residuals, over what is left of each value on average, that a window must promise: five standard
deviations, since hundreds are tried."""

ROUNDS = 3
"""So often more windows are looked for, beside those that were fitted."""

STEPS = 15
"""Trust-region steps of a fit."""

FINER = 2.0
"""Integration step of the fits over the rig's own, at most."""

LOST = Input("command", "command", "time for which a command is lost", "s", LONGEST_S, one_sided=True)
"""What is told of them: how long one lasts."""

Windows = np.ndarray
"""Begin and end of each [s], increasing. # (k, 2)"""

NONE: Windows = np.zeros((0, 2))


@dataclass(frozen=True)
class LostCommands(FoundLaw):
    """Commands that got lost, fitted.

    Attributes:
        windows: name of a recording -> when.
        neutral: command that acts meanwhile [V].
    """

    windows: Mapping[str, Windows] = field(default_factory=dict)
    neutral: float = 0.0

    of_the_machine: ClassVar[bool] = False

    @property
    def condition(self) -> str:
        """When it acts."""
        return "while commands are lost"

    @property
    def acts(self) -> tuple[tuple[float, float], ...]:
        """When commands were lost in the first training recording [s]."""
        return tuple((begin, end) for begin, end in next(iter(self.windows.values())).tolist())

    def more(self) -> dict[str, Any]:
        """When commands were lost in each recording [s]."""
        return {"windows_s": {name: lost.tolist() for name, lost in self.windows.items()}}

    def equation(self) -> str:
        """What was lost, and when."""
        lasted = np.concatenate([np.diff(lost, axis=1).ravel() for lost in self.windows.values()])
        when = "; ".join(
            f"in {name} at {', '.join(f'{begin:.2f}' for begin in lost[:, 0])} s"
            for name, lost in self.windows.items()
            if len(lost)
        )
        return f"a command that is lost for {lasted.min():.3g} to {lasted.max():.3g} s at a time ({when})"

    def signals(
        self, experiment: Experiment, records: np.ndarray, step: float, values: np.ndarray
    ) -> Signals:
        """What the machine does under the commands that arrived."""
        arrived = experiment.without_command(self.windows[experiment.name], self.neutral)
        return arrived.simulate(records, step).signals


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
            begun: name of a recording -> windows about which those of the fit lie.
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
        """Name of a recording -> windows, at a place in the unit cube."""
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

    def residuals(self, unit: np.ndarray) -> np.ndarray:
        """Measured minus model over noise, of all experiments."""
        return self.left(self.parameters.records(unit[: self._nominal]), self.windows(unit))

    def left(self, records: np.ndarray, windows: Mapping[str, Windows]) -> np.ndarray:
        """Measured minus model over noise, of all experiments, with some windows."""
        self.evaluations += 1
        return self.bounded(
            [
                e.residuals(
                    e.without_command(windows.get(e.name, NONE), self.neutral)
                    .simulate(records, self.longest_step)
                    .signals
                )
                for e in self.experiments
            ]
        )

    def _keep(self, unit: np.ndarray, base: np.ndarray) -> None:
        """Nothing is kept: windows are no part of a joint's record."""


def lost_commands(
    bench: Workbench,
    left: Hypothesis,
    held_out: Sequence[Experiment],
    span: Span,
    step: float,
    needed: float,
) -> LostCommands | None:
    """Windows in which commands were lost, fitted, or None if they do not promise to explain what a model leaves.

    Args:
        bench: training data of one joint.
        left: the model that leaves it.
        held_out: data in which windows are found and nothing else is fitted.
        span: what laws are told in.
        step: of the integration while windows are looked for [s].
        needed: fall of the squared residuals that the windows must promise together.
    """
    parameters = bench.parameters(left.effects)
    neutral = float(
        parameters.records(parameters.unit(left.values))[bench.training[0].index]["command"]["neutral"]
    )
    finer = min(step, FINER * bench.fine)
    unit, windows, fit = parameters.unit(left.values), {e.name: NONE for e in bench.training}, left.fit
    at = Across(fit)
    for number in range(ROUNDS):
        records = parameters.records(unit)
        found = _found(bench, bench.training, windows, records, step, neutral, at, fit.off_prior)
        if number == 0 and found.promised < needed:
            return None
        if not any(len(lost) for lost in found.windows.values()):
            break
        windows = {name: _sorted(lost, found.windows[name]) for name, lost in windows.items()}
        problem = LostProblem(parameters, bench.training, finer, windows, neutral)
        fit, windows = _fitted(bench, problem, unit)
        if any(_too_much(windows[e.name], e) for e in bench.training):
            return None
        unit = fit.unit[: len(parameters)]
        at = Across(fit)
    if not any(len(lost) for lost in windows.values()):
        return None
    total, every = 0.0, dict(windows)
    for experiment in held_out:
        if experiment.name not in every:  # blocks of a recording that is fitted too have its windows
            every[experiment.name] = _in_held_out(bench, parameters, experiment, unit, finer, neutral)
        arrived = experiment.without_command(every[experiment.name], neutral)
        residual = Problem.bounded(
            [experiment.residuals(arrived.simulate(parameters.records(unit), finer).signals)]
        )
        total += float(residual @ residual)
    counted = sum(experiment.counted for experiment in held_out)
    first = bench.training[0]
    records = parameters.records(unit)
    difference = (
        first.without_command(windows[first.name], neutral).simulate(records, finer).signals.reading
        - first.simulate(records, finer).signals.reading
    )
    lasted = np.concatenate([np.diff(lost, axis=1).ravel() for lost in windows.values()])
    return LostCommands(
        law=Law(LOST, (Term(("command",)),), 0.0, left.fit.objective - fit.objective, (1.0,)),
        values=np.array([float(np.median(lasted))]),
        parameters=parameters.values(unit),
        fit=fit,
        held_out_over_noise=float(np.sqrt(total / max(counted, 1))),
        difference=difference,
        span=span,
        ahead=tuple(every[e.name].ravel() for e in held_out),
        joint=first.joint,
        windows=every,
        neutral=neutral,
    )


@dataclass(frozen=True)
class _Found:
    windows: dict[str, Windows]
    promised: float


def _found(
    bench: Workbench,
    experiments: Sequence[Experiment],
    beside: Mapping[str, Windows],
    records: np.ndarray,
    step: float,
    neutral: float,
    across: Across | None,
    off: np.ndarray,
) -> _Found:
    """Windows that explain most of what is left beside those that are known, and by how much residuals would fall."""

    def left_of(experiment: Experiment, windows: Windows) -> np.ndarray:
        arrived = experiment.without_command(windows, neutral)
        return experiment.residuals(arrived.simulate(records, step).signals)

    here = [left_of(e, beside[e.name]) for e in experiments]
    ends = np.cumsum([0, *(part.size for part in here)])
    size = ends[-1] + off.size
    tried = [(i, begin) for i, e in enumerate(experiments) for begin in _driven(e, beside[e.name], neutral)]

    def column(item: tuple[int, float]) -> np.ndarray:
        bench.alive()
        i, begin = item
        experiment = experiments[i]
        windows = _sorted(beside[experiment.name], np.array([[begin, begin + WINDOW_S]]))
        moved = np.zeros(size)
        moved[ends[i] : ends[i + 1]] = np.nan_to_num(left_of(experiment, windows) - here[i])
        return moved if across is None else across(moved)

    rest = np.concatenate([*here, off])
    rest = rest if across is None else across(rest)
    windows = {e.name: NONE for e in experiments}
    if not tried:
        return _Found(windows, 0.0)
    columns = np.stack(bench.side_by_side(column, tried), axis=1)
    chosen, amplitudes, promised = picked(columns, rest)
    for i, experiment in enumerate(experiments):
        own = [(tried[k][1], a) for k, a in zip(chosen, amplitudes, strict=True) if tried[k][0] == i]
        windows[experiment.name] = merged(sorted(own))
    return _Found(windows, promised)


def picked(columns: np.ndarray, rest: np.ndarray) -> tuple[list[int], np.ndarray, float]:
    """Columns that explain most, one after the other, their multiples, and the fall of the squared residuals.

    Args:
        columns: change of the residuals by each window. # (values, k)
        rest: residuals. # (values,)
    """
    squares = np.maximum(np.sum(columns**2, axis=0), np.finfo(float).tiny)
    chosen: list[int] = []
    multiples, left = np.zeros(0), rest
    while len(chosen) < columns.shape[1]:
        along = -(columns.T @ left)
        gains = np.where(along > 0.0, along**2 / squares, 0.0)
        gains[chosen] = 0.0
        best = int(gains.argmax())
        if gains[best] < GAIN * max(float(left @ left) / left.size, 1.0):
            break
        chosen.append(best)
        multiples, _ = nnls(columns[:, chosen], -rest)
        left = rest + columns[:, chosen] @ multiples
    return chosen, multiples, float(rest @ rest - left @ left)


def merged(windows: Sequence[tuple[float, float]]) -> Windows:
    """Windows that touch are one, as long as all of them together by their multiples and about the same middle.

    Args:
        windows: begin [s] and multiple of each, increasing.
    """
    groups: list[list[tuple[float, float]]] = []
    for begin, multiple in windows:
        if groups and begin - groups[-1][-1][0] < 1.5 * WINDOW_S:
            groups[-1].append((begin, multiple))
        else:
            groups.append([(begin, multiple)])
    found = []
    for group in groups:
        begins, weights = np.array(group).T
        length = min(WINDOW_S * float(weights.sum()), LONGEST_S)
        if length < SHORTEST_S:
            continue
        middle = float(begins @ weights / weights.sum()) + 0.5 * WINDOW_S
        found.append((middle - 0.5 * length, middle + 0.5 * length))
    return np.array(found).reshape(-1, 2)


def _fitted(
    bench: Workbench, problem: LostProblem, nominal: np.ndarray, alone: bool = False
) -> tuple[Fit, dict[str, Windows]]:
    """The fit, from some nominal parameters on, and windows without which the data would not do.

    Args:
        bench: stops it, and counts.
        problem: with the windows about which they lie.
        nominal: parameters. # (n,)
        alone: leave these as they are.
    """
    while True:
        begun = problem.start(nominal)
        moving = np.arange(begun.size) >= nominal.size if alone else None
        fit = fit_from(
            problem, begun, most_steps=STEPS, tolerance=1e-4, stop=bench.interrupted, moving=moving
        )
        nominal, windows = fit.unit[: nominal.size], problem.windows(fit.unit)
        needed = {name: problem.needed(fit, windows, name) for name in windows}
        bench.evaluations += problem.evaluations
        kept = {name: lost[needed[name]] for name, lost in windows.items()}
        if all(each.all() for each in needed.values()):
            return fit, {name: joined(lost) for name, lost in kept.items()}
        problem = problem.about(kept)


def _in_held_out(
    bench: Workbench,
    parameters: ParameterSet,
    experiment: Experiment,
    unit: np.ndarray,
    step: float,
    neutral: float,
) -> Windows:
    """Windows in a recording to which nothing else is fitted."""
    windows = {experiment.name: NONE}
    for _ in range(ROUNDS):
        records = parameters.records(unit)
        found = _found(bench, [experiment], windows, records, step, neutral, None, np.zeros(0))
        if not len(found.windows[experiment.name]):
            break
        together = _sorted(windows[experiment.name], found.windows[experiment.name])
        problem = LostProblem(parameters, [experiment], step, {experiment.name: together}, neutral)
        _, fitted = _fitted(bench, problem, unit, alone=True)
        if _too_much(fitted[experiment.name], experiment):
            break
        windows = fitted
    return windows[experiment.name]


def _driven(experiment: Experiment, beside: Windows, neutral: float) -> list[float]:
    """Begins of windows in which there is a command to be lost, and which no known one meets."""
    begins = np.arange(experiment.time[0], experiment.time[-1] - WINDOW_S, WINDOW_S)
    times, command = experiment.command_times, experiment.command
    first = np.maximum(np.searchsorted(times, begins, side="right") - 1, 0)
    after = np.searchsorted(times, begins + WINDOW_S, side="left")
    driven = [bool(np.any(command[i:j] != neutral)) for i, j in zip(first, after, strict=True)]
    free = [not np.any((beside[:, 0] < b + WINDOW_S) & (beside[:, 1] > b)) for b in begins]
    return [float(b) for b, d, f in zip(begins, driven, free, strict=True) if d and f]


def _sorted(some: Windows, more: Windows) -> Windows:
    both = np.concatenate([some, more])
    return both[np.argsort(both[:, 0])]


def joined(windows: Windows) -> Windows:
    """The same time in windows that do not touch, in their order."""
    apart: list[list[float]] = []
    for begin, end in windows[np.argsort(windows[:, 0])].tolist():
        if apart and begin < apart[-1][1] + SHORTEST_S:
            apart[-1][1] = max(apart[-1][1], end)
        else:
            apart.append([begin, end])
    return np.array(apart).reshape(-1, 2)


def _too_much(windows: Windows, experiment: Experiment) -> bool:
    return bool(np.diff(windows, axis=1).sum() > MOST_SHARE * np.ptp(experiment.time))
