"""Commands that got lost as an addition to a structure: windows in which the machine has none.

Such windows follow no law of the machine. Each recording has its own, so that their begins and ends are nuisance
parameters of the recording, fitted with the machine's. Steps of the integration end where commands change, so that
residuals are smooth functions of both.
"""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from hydrolek_drake.diagnosis.settings import DROPOUTS, GAINS
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.inputs import Input
from hydrolek_drake.diagnosis.structures.term_forms import Span
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.parameter_set import Free, ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.rollout.run import Run

Windows = np.ndarray
"""Begin and end of each [s], increasing. # (k, 2)"""

NONE: Windows = np.zeros((0, 2))


@dataclass(frozen=True, eq=False)
class LostWindows:
    """Windows in which commands of a joint were lost, in recordings.

    Attributes:
        joint: whose commands.
        input: what is added to the command where it is asked for as an unknown input.
        neutral: command that acts meanwhile [V].
        seen: recording (`recording_of`) -> windows about which the fitted ones lie.
        span: what laws of the joint are told in.
        share: of what was left above the noise that they promise to take.
    """

    joint: str
    input: Input
    neutral: float
    seen: Mapping[str, Windows]
    span: Span
    share: float

    cost: ClassVar[float] = GAINS.law
    """In effects, as of terms of laws."""

    sudden: ClassVar[bool] = False
    step_share: ClassVar[float] = 1.0
    moments: ClassVar[tuple[Free, ...]] = ()
    beneath: ClassVar[float] = 0.0
    stage: ClassVar[str] = "command"
    id: ClassVar[str] = "unlisted.command"
    label: ClassVar[str] = "unlisted.command: lost commands"

    @property
    def path(self) -> str:
        """What stands for it where an effect has its path in a rig."""
        return f"joints.{self.joint}.lost"

    @property
    def size_path(self) -> str:
        """What tells it from other additions."""
        return f"{self.path}.all"

    @cached_property
    def free(self) -> tuple[Free, ...]:
        """Middle and half length of each window with the ranges of the search [s]."""
        found = []
        for which, windows in enumerate(self.seen.values()):
            for number, (begin, end) in enumerate(windows.tolist()):
                middle = 0.5 * (begin + end)
                name = f"{self.path}.{which}.{number}"
                found.append(Free(f"{name}.middle", middle - DROPOUTS.moves_s, middle + DROPOUTS.moves_s))
                found.append(Free(f"{name}.half", 0.0, 0.5 * DROPOUTS.longest_s))
        return tuple(found)

    @property
    def searched(self) -> tuple[Free, ...]:
        """Those along which it is tried elsewhere too: when windows are."""
        return self.free[::2]

    def begun(self) -> dict[str, float]:
        """Full path -> value of windows as they were seen."""
        values: dict[str, float] = {}
        for which, windows in enumerate(self.seen.values()):
            for number, (begin, end) in enumerate(windows.tolist()):
                name = f"{self.path}.{which}.{number}"
                values |= {f"{name}.middle": 0.5 * (begin + end), f"{name}.half": 0.5 * (end - begin)}
        return values

    def windows(self, values: Mapping[str, float]) -> dict[str, Windows]:
        """Recording -> windows, from full paths and values."""
        found = {}
        for which, (recording, windows) in enumerate(self.seen.items()):
            names = [f"{self.path}.{which}.{number}" for number in range(len(windows))]
            middles = np.array([values[f"{name}.middle"] for name in names])
            halves = np.array([values[f"{name}.half"] for name in names])
            found[recording] = np.stack([middles - halves, middles + halves], axis=1).reshape(-1, 2)
        return found

    def says_something(self, values: Mapping[str, float]) -> bool:
        """Whether there are any."""
        return any(len(windows) for windows in self.seen.values())

    def is_special_case_of(self, other: object) -> bool:
        """Whether another addition contains this one: none does."""
        return False

    def widened(self, values: Mapping[str, float]) -> "LostWindows":
        """The same about where the windows lie now, if one lies at the end of where it may."""
        ends = [abs(values[free.path] - 0.5 * (free.lower + free.upper)) for free in self.free[::2]]
        if max(ends, default=0.0) < 0.99 * DROPOUTS.moves_s:
            return self
        return replace(self, seen=self.windows(values))

    def without(self, recording: str, number: int) -> "LostWindows":
        """The same without one of its windows."""
        return replace(self, seen={**self.seen, recording: np.delete(self.seen[recording], number, axis=0)})


class LostProblem(Problem):
    """Residuals of a structure some of whose commands were lost."""

    def runs(self, unit: np.ndarray) -> list[Run]:
        """As of `Problem`, with commands that were lost."""
        records = self.parameters.records(unit)
        lost = self.parameters.lost if isinstance(self.parameters, WithWindows) else ()
        arrived = arrivals(lost, self.parameters.values(unit), self.experiments)
        return [e.run(records, self.longest_step, pull_time=self.pull_time) for e in arrived]


def arrivals(
    additions: Sequence[Addition], values: Mapping[str, float], experiments: Sequence[Experiment]
) -> list[Experiment]:
    """The same experiments with the commands that arrived.

    Args:
        additions: of a structure; what is no `LostWindows` changes nothing here.
        values: full path -> value.
        experiments: recordings.
    """
    now = list(experiments)
    for lost in additions:
        if isinstance(lost, LostWindows):
            windows = lost.windows(values)
            now = [
                e.without_command(windows.get(recording_of(e), NONE), lost.neutral)
                if e.joint == lost.joint
                else e
                for e in now
            ]
    return now


def recording_of(experiment: Experiment) -> str:
    """What tells a recording from others, which may have its name or its commands; blocks of it are the same one."""
    digest = hashlib.blake2b(experiment.command.tobytes(), digest_size=8)
    digest.update(experiment.channels[0].measured.tobytes())
    return digest.hexdigest()


def in_order(some: Windows, more: Windows) -> Windows:
    """All of them by their begins. # (k, 2)."""
    both = np.concatenate([some, more])
    return both[np.argsort(both[:, 0])]


def joined(windows: Windows) -> Windows:
    """The same time in windows that do not touch, in their order; those too short to be resolved are left out."""
    apart: list[list[float]] = []
    for begin, end in windows[np.argsort(windows[:, 0])].tolist():
        if end - begin < DROPOUTS.shortest_s:
            continue
        if apart and begin < apart[-1][1] + DROPOUTS.sample_s:
            apart[-1][1] = max(apart[-1][1], end)
        else:
            apart.append([begin, end])
    return np.array(apart).reshape(-1, 2)


def too_much(windows: Windows, experiment: Experiment) -> bool:
    """Whether more of a recording would be lost than `DROPOUTS.most_share`."""
    return bool(np.diff(windows, axis=1).sum() > DROPOUTS.most_share * np.ptp(experiment.time))


class WithWindows(ParameterSet):
    """Joint records as a function of searched parameters, beside those of windows in which commands were lost."""

    def __init__(self, of_rig: ParameterSet, lost: Sequence[LostWindows]) -> None:
        """Put the windows' parameters behind those of the machine.

        Args:
            of_rig: the machine's parameters.
            lost: windows.
        """
        self.rig, self._of_rig, self.lost = of_rig.rig, of_rig, tuple(lost)
        self.free = (*of_rig.free, *(free for each in lost for free in each.free))
        self._seen = {path: value for each in lost for path, value in each.begun().items()}

    @property
    def arrivals(self) -> np.ndarray:
        """Which of them say when commands arrive. # (n,) truth values."""
        own = self._of_rig.arrivals
        return np.concatenate([own, np.ones(len(self.free) - own.size, dtype=bool)])

    def records(self, unit: np.ndarray) -> np.ndarray:
        """Records of all joints, shape (n joints,), for a place in the unit cube."""
        return self._of_rig.records(unit[: len(self._of_rig)])

    def unit(self, values: Mapping[str, float] | None = None) -> np.ndarray:
        """Place of the given values, or of the rig's own and of windows as they were seen."""
        of_rig = self._of_rig.unit(values)
        given = {**self._seen, **(values or {})}
        own = [free.to_unit(given[free.path]) for free in self.free[of_rig.size :]]
        return np.concatenate([of_rig, np.clip(np.array(own), 0.0, 1.0)])


def lost_in(additions: Sequence[object]) -> LostWindows | None:
    """Lost commands among the additions of a structure, if it has any."""
    return next((c for c in additions if isinstance(c, LostWindows)), None)
