"""Commands that got lost on their way: windows in which the machine did what it does without any.

Such windows follow no law, so they are found in each recording (`windows`). Where they begin and how long they
last is fitted together with the nominal parameters.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from hydrolek_drake.diagnosis.fitting.projection import Across
from hydrolek_drake.diagnosis.intervals.curvature import intervals_of
from hydrolek_drake.diagnosis.laws.inputs import Input
from hydrolek_drake.diagnosis.laws.law import FoundLaw, Law
from hydrolek_drake.diagnosis.laws.terms import Span, Term
from hydrolek_drake.diagnosis.lost_commands.fit import fitted_windows
from hydrolek_drake.diagnosis.lost_commands.problem import LostProblem
from hydrolek_drake.diagnosis.lost_commands.windows import (
    LONGEST_S,
    NONE,
    Windows,
    found_in,
    in_order,
    recording_of,
    too_much,
)
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.rollout.rollout import Signals

ROUNDS = 3
"""So often more windows are looked for, beside those that were fitted."""

FINER = 2.0
"""Integration step of the fits over the rig's own, at most."""

LOST = Input("command", "command", "time for which a command is lost", "s", LONGEST_S, one_sided=True)
"""What is told of them: how long one lasts."""


@dataclass(frozen=True)
class LostCommands(FoundLaw):
    """Commands that got lost, fitted.

    Attributes:
        windows: recording (`windows.recording_of`) -> when.
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
    most: float = math.inf,
) -> LostCommands | None:
    """Windows in which commands were lost, fitted, or None if they do not explain what a model leaves.

    Args:
        bench: training data of one joint.
        left: the model that leaves it.
        held_out: data in which windows are found and nothing else is fitted.
        span: what laws are told in.
        step: of the integration while windows are looked for [s].
        most: over the noise, that they may leave of the training data; else none are looked for in the held-out data.
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
    for _ in range(ROUNDS):
        records = parameters.records(unit)
        found = found_in(bench, bench.training, windows, records, step, neutral, at, fit.off_prior)
        if not any(len(lost) for lost in found.values()):
            break
        windows = {name: in_order(lost, found[name]) for name, lost in windows.items()}
        problem = LostProblem(parameters, bench.training, finer, windows, neutral)
        fit, windows = fitted_windows(bench, problem, unit, found)
        if any(too_much(windows[recording_of(e)], e) for e in bench.training):
            return None
        unit = fit.unit[: len(parameters)]
        at = Across(fit)
    if finer > bench.fine:  # oil that rings does so with the rig's own step
        finer = bench.fine
        problem = LostProblem(parameters, bench.training, finer, windows, neutral)
        fit, windows = fitted_windows(bench, problem, unit, None)
        unit = fit.unit[: len(parameters)]
    if fit.over_noise > most or not any(len(lost) for lost in windows.values()):
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
        law=Law(LOST, (Term(("command",)),), 0.0),
        values=np.array([float(np.median(lasted))]),
        parameters=parameters.values(unit),
        fit=fit,
        held_out_over_noise=float(np.sqrt(ahead @ ahead / max(counted, 1))),
        difference=difference,
        span=span,
        ahead=tuple(every[recording_of(e)].ravel() for e in held_out),
        joint=first.joint,
        intervals=intervals_of(parameters, fit),
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
        if not len(found[own]):
            break
        together = in_order(windows[own], found[own])
        problem = LostProblem(parameters, [experiment], step, {own: together}, neutral)
        _, fitted = fitted_windows(bench, problem, unit, found, alone=True)
        if too_much(fitted[own], experiment):
            break
        windows = fitted
    return windows[own]
