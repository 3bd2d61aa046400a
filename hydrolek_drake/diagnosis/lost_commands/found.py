"""What is told of commands that got lost on their way: windows in which the machine did what it does without any."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.diagnosis.evidence.nuisance import with_stands
from hydrolek_drake.diagnosis.intervals.curvature import intervals_of
from hydrolek_drake.diagnosis.laws.inputs import Input
from hydrolek_drake.diagnosis.laws.law import FoundLaw, Law
from hydrolek_drake.diagnosis.laws.terms import Term
from hydrolek_drake.diagnosis.lost_commands.search import lost_in
from hydrolek_drake.diagnosis.lost_commands.windows import LostWindows, Windows, arrivals, recording_of
from hydrolek_drake.diagnosis.settings import DROPOUTS, Settings
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.rollout.rollout import Signals

LOST = Input(
    "command", "command", "time for which a command is lost", "s", DROPOUTS.longest_s, one_sided=True
)
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


def lost_of(
    bench: Workbench, judged: Judged, held_out: Sequence[Experiment], settings: Settings, cores: int
) -> LostCommands:
    """What is told of the commands that a structure has lost.

    Args:
        bench: data and problems.
        judged: a structure with lost commands.
        held_out: data that it was held against.
        settings: of the search.
        cores: that roll out at the same time.
    """
    h = judged.hypothesis
    lost = lost_in(h)
    assert lost is not None
    every = lost.windows(h.values)
    for effects, unit in with_stands(bench, judged, held_out, settings, cores).stands.values():
        ahead = next(c for c in effects if isinstance(c, LostWindows))
        every |= ahead.windows(bench.parameters(effects).values(unit))
    parameters = bench.parameters(h.effects)
    records = parameters.records(h.fit.unit)
    first = next(e for e in bench.training if e.joint == lost.joint)
    [arrived] = arrivals(h.effects, h.values, [first])
    with_lost, plain = (e.simulate(records, bench.fine).signals.reading for e in (arrived, first))
    lasted = np.concatenate([np.diff(windows, axis=1).ravel() for windows in every.values()])
    return LostCommands(
        law=Law(LOST, (Term(("command",)),), 0.0),
        values=np.array([float(np.median(lasted))]),
        parameters={path: value for path, value in h.values.items() if ".lost." not in path},
        fit=h.fit,
        held_out_over_noise=judged.over_noise,
        difference=with_lost - plain,
        span=lost.span,
        ahead=tuple(every[recording_of(e)].ravel() for e in held_out if e.joint == lost.joint),
        joint=lost.joint,
        intervals={p: known for p, known in intervals_of(parameters, h.fit).items() if ".lost." not in p},
        windows=every,
        called=names_of([*bench.training, *held_out]),
        neutral=lost.neutral,
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
