"""Clean stretches of the stream, each as a recording that can be asked which effect changed.

A window begins in the middle of a movement: not at rest, as recordings do, but where the observer is. Its state is that
of the healthy model, so that nothing counts for `UNSETTLED_S`; where the joint is, it knows to the innovations' scale.
A joint takes part if it was moved. Gaps, jumps and restarts end a window; the next one begins behind them.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from pathlib import Path

import numpy as np

from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.recordings import Recording, write_signals
from hydrolek_drake.replay.readings import position_key
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.kernel import PULLED
from hydrolek_drake.watching.live.settings import BEFORE_S, UNSETTLED_S, WINDOW_S

FOLDER = "windows"


@dataclass(frozen=True)
class Begin:
    """Where a joint is when a window begins.

    Attributes:
        state: as of `kernel.integrate`; its time since switching on begins with the window. # (17,)
        reading: what the observer expects to be measured [rad or m].
        error: standard deviation of that.
    """

    state: np.ndarray
    reading: float
    error: float


@dataclass(frozen=True)
class Window:
    """A clean stretch.

    Attributes:
        time: from its begin [s]. # (n,)
        values: `samples.COLUMNS` of each joint. # (n, joints, 4)
        begins: joint -> where it is.
        before: times of commands before it [s], all negative. # (m,)
        commands: these [V]. # (m, joints)
        ended: when it was complete [s since 1970, UTC].
    """

    time: np.ndarray
    values: np.ndarray
    begins: dict[str, Begin]
    before: np.ndarray
    commands: np.ndarray
    ended: float

    @property
    def name(self) -> str:
        """Of its file: when it ended."""
        return f"window_{datetime.fromtimestamp(self.ended, timezone.utc):%Y%m%dT%H%M%S}"

    def moved(self, joints: Sequence[str]) -> list[str]:
        """Joints whose commands changed, and that can be asked."""
        changed = np.ptp(self.values[:, :, 0], axis=0) > 0.0
        return [joint for joint, each in zip(joints, changed, strict=True) if each and joint in self.begins]

    def write(self, folder: Path, rig: Rig, joints: Sequence[str]) -> Path:
        """Write it as a recording of the joints that moved.

        Args:
            folder: of the watch; made if it is missing.
            rig: the machine.
            joints: in the order of the rows.
        """
        moved, signals, units = self.moved(joints), {}, {}
        for joint in moved:
            place = list(joints).index(joint)
            position = position_key(rig, joint)
            keys = (f"{joint}.command", position, *(f"{joint}.{name}" for name in PULLED[1:]))
            own = ("V", "m" if position.endswith(".position") else "rad", "Pa", "Pa")
            for column, (key, unit) in enumerate(zip(keys, own, strict=True)):
                values = self.values[:, place, column]
                if np.isfinite(values).any():
                    signals[key], units[key] = values, unit
        (folder / FOLDER).mkdir(parents=True, exist_ok=True)
        return write_signals(folder / FOLDER / f"{self.name}.csv", self.time, signals, units)

    def experiments(self, rig: Rig, recording: Recording, joints: Sequence[str]) -> list[Experiment]:
        """What is asked of it: each joint's movement, from where the observer was.

        Args:
            rig: the machine.
            recording: of the window, as `write` left it.
            joints: in the order of the rows.

        Raises:
            InputError: it cannot be asked.
        """
        found = []
        for experiment in experiments_of(rig, recording):
            begin = self.begins[experiment.joint]
            earlier = self.commands[:, list(joints).index(experiment.joint)]
            found.append(
                replace(
                    experiment,
                    command_times=np.concatenate([self.before, experiment.command_times]),
                    command=np.concatenate([earlier, experiment.command]),
                    state=begin.state,
                    start=begin.reading,
                    start_error=begin.error,
                    used=experiment.used & (experiment.time >= experiment.time[0] + UNSETTLED_S),
                )
            )
        return found


class Windows:
    """Gathers windows from the stream."""

    def __init__(self, joints: int) -> None:
        """Prepare for so many joints."""
        self._before: deque[tuple[float, np.ndarray]] = deque()
        self._joints = joints
        self.restart()

    def restart(self) -> None:
        """Forget what was begun."""
        self._begins: dict[str, Begin] | None = None
        self._rows: list[tuple[float, np.ndarray]] = []
        self._earlier: list[tuple[float, np.ndarray]] = []
        self._before.clear()

    @property
    def begun(self) -> bool:
        """Whether a window is being gathered."""
        return self._begins is not None

    @property
    def seconds(self) -> float:
        """How long it is so far."""
        return self._rows[-1][0] - self._rows[0][0] if self._rows else 0.0

    def begin(self, begins: dict[str, Begin]) -> None:
        """The next row begins a window."""
        self._begins, self._rows = begins, []
        self._earlier = list(self._before)

    def add(self, time: float, values: np.ndarray, volts: np.ndarray, now: float) -> Window | None:
        """Take a row; the window that is complete with it, if one is.

        Args:
            time: [s].
            values: `samples.COLUMNS`, # (joints, 4).
            volts: commands that are held now [V]. # (joints,)
            now: [s since 1970].
        """
        done = None
        if self._begins is not None:
            held = values.copy()
            held[:, 0] = volts
            self._rows.append((time, held))
            if self.seconds >= WINDOW_S:
                done = self._window(self._begins, now)
        self._before.append((time, volts))
        while self._before[0][0] < time - BEFORE_S:
            self._before.popleft()
        return done

    def _window(self, begins: dict[str, Begin], now: float) -> Window:
        time = np.array([each for each, _ in self._rows])
        values = np.array([row for _, row in self._rows])
        before = np.array([each for each, _ in self._earlier]) - time[0]
        commands = np.reshape([volts for _, volts in self._earlier], (-1, self._joints))
        self._begins, self._rows, self._earlier = None, [], []
        return Window(time - time[0], values, begins, before[before < 0.0], commands[before < 0.0], now)
