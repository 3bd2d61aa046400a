"""Commands that got lost on their way: windows in which the machine did what it does without any.

Such windows follow no law, so they are found in each recording (`lost_windows`). Where they begin and how long they
last is fitted together with the nominal parameters.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.law_problem import FoundLaw, Law
from hydrolek_drake.diagnosis.laws import Span, Term
from hydrolek_drake.diagnosis.lost_problem import LostProblem
from hydrolek_drake.diagnosis.lost_windows import (
    GAIN,
    LONGEST_S,
    NONE,
    WINDOW_S,
    Windows,
    found_in,
    in_order,
    joined,
    recording_of,
    too_much,
)
from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit, fit_from
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.rollout.rollout import Signals

ROUNDS = 3
"""So often more windows are looked for, beside those that were fitted."""

STEPS = 60
"""Trust-region steps of a fit at most: a nominal model without the windows has bent its numbers far, and before they
are back a window of no meaning may do some good."""

FINER = 2.0
"""Integration step of the fits over the rig's own, at most."""

REACH_S, APART_S = 1.5 * WINDOW_S, 0.1 * WINDOW_S
"""A window that was fitted is tried elsewhere so far to either side, so far apart ..."""

LENGTHS_S = tuple(WINDOW_S * share for share in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0))
"""... and with its own and these lengths: least squares that begin beside a window of a few milliseconds end there."""

LOST = Input("command", "command", "time for which a command is lost", "s", LONGEST_S, one_sided=True)
"""What is told of them: how long one lasts."""


@dataclass(frozen=True)
class LostCommands(FoundLaw):
    """Commands that got lost, fitted.

    Attributes:
        windows: recording (`lost_windows.recording_of`) -> when.
        called: recording -> its name.
        neutral: command that acts meanwhile [V].
    """

    windows: Mapping[str, Windows] = field(default_factory=dict)
    called: Mapping[str, str] = field(default_factory=dict)
    neutral: float = 0.0

    of_the_machine: ClassVar[bool] = False
    remark: ClassVar[str] = (
        "This is the recordings' own: the fitted rig runs as if every command had arrived."
    )

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
        return {"windows_s": {self.called[which]: lost.tolist() for which, lost in self.windows.items()}}

    def equation(self) -> str:
        """What was lost, and when."""
        lasted = np.concatenate([np.diff(lost, axis=1).ravel() for lost in self.windows.values()])
        when = "; ".join(
            f"in {self.called[which]} at {', '.join(f'{begin:.2f}' for begin in lost[:, 0])} s"
            for which, lost in self.windows.items()
            if len(lost)
        )
        return f"a command that is lost for {lasted.min():.3g} to {lasted.max():.3g} s at a time ({when})"

    def signals(
        self, experiment: Experiment, records: np.ndarray, step: float, values: np.ndarray
    ) -> Signals:
        """What the machine does under the commands that arrived."""
        arrived = experiment.without_command(self.windows[recording_of(experiment)], self.neutral)
        return arrived.simulate(records, step).signals


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
    unit, windows, fit = (
        parameters.unit(left.values),
        {recording_of(e): NONE for e in bench.training},
        left.fit,
    )
    at = Across(fit)
    for number in range(ROUNDS):
        records = parameters.records(unit)
        found = found_in(bench, bench.training, windows, records, step, neutral, at, fit.off_prior)
        if number == 0 and found.promised < needed:
            return None
        if not any(len(lost) for lost in found.windows.values()):
            break
        windows = {name: in_order(lost, found.windows[name]) for name, lost in windows.items()}
        problem = LostProblem(parameters, bench.training, finer, windows, neutral)
        fit, windows = _fitted(bench, problem, unit)
        if any(too_much(windows[recording_of(e)], e) for e in bench.training):
            return None
        unit = fit.unit[: len(parameters)]
        at = Across(fit)
    if not any(len(lost) for lost in windows.values()):
        return None
    every = dict(windows)
    for experiment in held_out:
        if recording_of(experiment) not in every:  # blocks of a recording that is fitted too have its windows
            every[recording_of(experiment)] = _in_held_out(
                bench, parameters, experiment, unit, finer, neutral
            )
    records = parameters.records(unit)
    ahead = LostProblem(parameters, held_out, finer, every, neutral).left(records, every)
    counted = sum(experiment.counted for experiment in held_out)
    first = bench.training[0]
    difference = (
        first.without_command(windows[recording_of(first)], neutral).simulate(records, finer).signals.reading
        - first.simulate(records, finer).signals.reading
    )
    lasted = np.concatenate([np.diff(lost, axis=1).ravel() for lost in windows.values()])
    return LostCommands(
        law=Law(LOST, (Term(("command",)),), 0.0, left.fit.objective - fit.objective, (1.0,)),
        values=np.array([float(np.median(lasted))]),
        parameters=parameters.values(unit),
        fit=fit,
        held_out_over_noise=float(np.sqrt(ahead @ ahead / max(counted, 1))),
        difference=difference,
        span=span,
        ahead=tuple(every[recording_of(e)].ravel() for e in held_out),
        joint=first.joint,
        windows=every,
        called=names_of([*bench.training, *held_out]),
        neutral=neutral,
    )


def names_of(experiments: Sequence[Experiment]) -> dict[str, str]:
    """Recording -> its name, with a number where several have it."""
    names: dict[str, str] = {}
    for experiment in experiments:
        if recording_of(experiment) not in names:
            alike = sum(name.partition(" (")[0] == experiment.name for name in names.values())
            names[recording_of(experiment)] = (
                experiment.name if not alike else f"{experiment.name} ({alike + 1})"
            )
    return names


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
    problem, moved = problem.about(_elsewhere(bench, problem, nominal, dict(problem.begun))), False
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
        if not all(each.all() for each in needed.values()):
            problem = problem.about(kept)
            continue
        kept = {name: joined(lost) for name, lost in kept.items()}
        elsewhere = kept if moved else _elsewhere(bench, problem, nominal, kept)
        if elsewhere is kept:
            return fit, kept
        problem, moved = problem.about(elsewhere), True


def _elsewhere(
    bench: Workbench, problem: LostProblem, nominal: np.ndarray, windows: dict[str, Windows]
) -> dict[str, Windows]:
    """The windows, one after the other, where they leave least with everything else as it is; the same if none moves.

    Args:
        bench: rollouts side by side.
        problem: with the recordings.
        nominal: parameters. # (n,)
        windows: fitted.
    """
    records = problem.parameters.records(nominal)
    step, latest = problem.longest_step, windows
    assert step is not None
    for experiment in problem.experiments:
        own = recording_of(experiment)
        alone = LostProblem(problem.parameters, [experiment], step, latest, problem.neutral)

        def left(lost: Windows, alone: LostProblem = alone, own: str = own) -> float:
            bench.alive()
            return float(np.sum(alone.left(records, {own: lost}) ** 2))

        for number in range(len(latest[own])):
            others, (begin, end) = np.delete(latest[own], number, axis=0), latest[own][number]
            places = [*tried_about(float(begin), float(end), others), latest[own][number]]
            least = bench.side_by_side(lambda place, o=others: left(in_order(o, place[None])), places)
            best = int(np.argmin(least))
            if least[best] < left(latest[own]) - GAIN * max(least[best] / max(experiment.counted, 1), 1.0):
                latest = {**latest, own: in_order(others, places[best][None])}
        bench.evaluations += alone.evaluations
    return latest


def tried_about(begin: float, end: float, others: Windows) -> list[np.ndarray]:
    """Windows about one that was fitted, which meet no other. # (2,) each.

    Args:
        begin: of the one that was fitted [s].
        end: of it [s].
        others: of the recording [s].
    """
    middles = 0.5 * (begin + end) + np.arange(-REACH_S, REACH_S + 0.5 * APART_S, APART_S)
    lengths = (end - begin, *LENGTHS_S)
    tried = [np.array([middle - 0.5 * each, middle + 0.5 * each]) for middle in middles for each in lengths]
    return [lost for lost in tried if not np.any((others[:, 0] < lost[1]) & (others[:, 1] > lost[0]))]


def _in_held_out(
    bench: Workbench,
    parameters: ParameterSet,
    experiment: Experiment,
    unit: np.ndarray,
    step: float,
    neutral: float,
) -> Windows:
    """Windows in a recording to which nothing else is fitted."""
    own = recording_of(experiment)
    windows = {own: NONE}
    for _ in range(ROUNDS):
        records = parameters.records(unit)
        found = found_in(bench, [experiment], windows, records, step, neutral, None, np.zeros(0))
        if not len(found.windows[own]):
            break
        together = in_order(windows[own], found.windows[own])
        problem = LostProblem(parameters, [experiment], step, {own: together}, neutral)
        _, fitted = _fitted(bench, problem, unit, alone=True)
        if too_much(fitted[own], experiment):
            break
        windows = fitted
    return windows[own]
