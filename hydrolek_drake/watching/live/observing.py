"""The observer: the fitted model, stepped by the rollout's own loop and pulled to what was measured.

At every sample the model tells what will be measured; the innovation is by how much it is not, e = y - y^. The state
then goes towards the measurement by a share K of it (`kernel.pulled`; an observer whose gain acts on position and
pressures, Luenberger, IEEE Transactions on Military Electronics 8, 1964). K is the gain of a Kalman filter for an
error that walks at random (Kalman, Journal of Basic Engineering 82, 1960): with the error's variance P over that of a
reading,

    K = P / (P + 1),    P' = K + q,    q = k^2 / (1 - k),    k = 1 - exp(-h / T),

so that from a beginning of which nothing is known K falls from 1 to k, a pull with the time constant T. Where samples
were lost and the command is another one behind them, it is not known when it changed: the joint may be off by its speed
for a volt times the change, times the time that is missing. P grows by the square of that until the command has passed
dead time, spool and oil; the observer follows the readings until then, and its innovations say nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics import command
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.kernel import PULLED, SIGNALS
from hydrolek_drake.rollout.onwards import JointOnwards, JointsOnwards, onwards
from hydrolek_drake.watching.live.settings import LAG_S, PULL_S, UNSURE

_TOLD = [SIGNALS.index(name) for name in PULLED]
_LOST = 1.5
"""An interval of so many usual ones has lost a sample."""

_NOTHING_KNOWN = 1e9
"""Variance at the beginning over that of a reading."""

_MOST_GAIN = 1.0 - 1e-12


@dataclass(frozen=True)
class Response:
    """How joints follow their commands, as far as lost samples ask for it.

    Attributes:
        interval: usual one between samples [s].
        speed: a joint's speed for a volt, over the standard deviation of its reading [1/(V s)]. # (joints,)
    """

    interval: float
    speed: np.ndarray


class Observer:
    """All joints of a machine.

    Attributes:
        joints: that are observed, in the order of the rows.
        time: of the sample at which it stands [s]; None before it has begun.
        modelled: what it expected there of `kernel.PULLED`; NaN at the first sample. # (joints, 3)
        unsure_until: until when innovations say nothing: it has begun, or samples were lost when a command changed
            [s]. # (joints,)
    """

    def __init__(
        self, rig: Rig, joints: Sequence[str], response: Response | None = None, pull_time: float = PULL_S
    ) -> None:
        """Prepare.

        Args:
            rig: with the values of the fitted model.
            joints: that are observed.
            response: how they follow their commands; None if no samples get lost.
            pull_time: time constant of the pull, T [s].
        """
        self._rig, self.joints, self._pull_time = rig, tuple(joints), pull_time
        self._response = response
        self._neutral = np.array([rig.value(f"joints.{joint}.command.neutral") for joint in self.joints])
        records: Any = rig.records()
        delays = [float(command.transport_delay(records[rig.joints.index(joint)])) for joint in self.joints]
        self._follows = np.array(delays) + LAG_S
        self.restart()

    def restart(self) -> None:
        """Forget the state: the next sample begins anew."""
        count = len(self.joints)
        self.time: float | None = None
        self.modelled = np.full((count, len(PULLED)), np.nan)
        self.unsure_until = np.full(count, -np.inf)
        self._machines: list[_Driven] = []
        self._volts = self._neutral.copy()
        self._measured = self.modelled.copy()
        self._variance = np.full(count, _NOTHING_KNOWN)
        self._added = np.zeros(count)

    def step(self, time: float, values: np.ndarray) -> np.ndarray | None:
        """Take a sample.

        Args:
            time: later than that of the sample before [s].
            values: `samples.COLUMNS`. # (joints, 4)

        Returns:
            Innovations of `kernel.PULLED`, NaN where nothing was measured, # (joints, 3); None where the observer has
            only begun, at rest where the joints are, or waits for positions to begin with.

        Raises:
            InputError: the model leaves all bounds; begin anew.
        """
        measured = values[:, 1:]
        told = None
        if self.time is None:
            if not np.isfinite(measured[:, 0]).all():
                self._keep(values)
                return None
            starts = dict(zip(self.joints, measured[:, 0].tolist(), strict=True))
            self._machines = [self._driven(m) for m in onwards(self._rig, self.joints, time, starts)]
            self.unsure_until = time + self._follows  # what was commanded before is not known either
            self._added = np.full(len(self.joints), _NOTHING_KNOWN)
        else:
            told = self._advance(time, measured)
            self._doubt(time - self.time, time, values[:, 0])
        self.time = time
        self._measured = measured
        self._keep(values)
        return told

    @property
    def sure(self) -> np.ndarray:
        """Joints whose innovations say something now. # (joints,)."""
        return np.asarray(self.unsure_until <= (-np.inf if self.time is None else self.time))

    def states(self) -> dict[str, np.ndarray]:
        """Joint -> state where it stands, before the pull of the sample there, of joints that move alone. # (17,)."""
        return {
            each.machine.joints[0]: each.machine.states()[0]
            for each in self._machines
            if isinstance(each.machine, JointOnwards)
        }

    @property
    def volts(self) -> np.ndarray:
        """Commands that are held [V]. # (joints,)."""
        return self._volts.copy()

    def _advance(self, time: float, measured: np.ndarray) -> np.ndarray:
        assert self.time is not None
        times = self._pull_times(time - self.time)
        for each in self._machines:
            pulled = np.where(each.known[:, None], self._measured[each.rows], np.nan)
            volts = np.where(each.known, self._volts[each.rows], each.neutral)
            each.advance(volts, time, times[each.rows], pulled)
            self.modelled[each.rows[each.known]] = each.machine.signals[each.known][:, _TOLD]
        if not np.isfinite(self.modelled[:, 0]).all():
            raise InputError("the observer has no value")
        return np.asarray(measured - self.modelled)

    def _pull_times(self, step: float) -> np.ndarray:
        """Time constants for which the pull over a step [s] has each joint's gain; variances go on. # (joints,)."""
        usual = 1.0 - np.exp(-step / self._pull_time)
        known = np.isfinite(self._measured[:, 0])
        gain = np.minimum(self._variance / (self._variance + 1.0), _MOST_GAIN)
        self._variance = np.where(known, gain, self._variance) + usual**2 / (1.0 - usual) + self._added
        return np.asarray(-step / np.log1p(-gain))

    def _doubt(self, step: float, time: float, volts: np.ndarray) -> None:
        """Notice commands that changed while samples were lost."""
        self._added = np.where(self.unsure_until > time, self._added, 0.0)
        response = self._response
        if response is None or step < _LOST * response.interval:
            return
        change = np.abs(np.nan_to_num(volts - self._volts))
        off = response.speed * change * (step - response.interval)
        doubtful = off > UNSURE
        self.unsure_until = np.where(doubtful, time + self._follows, self.unsure_until)
        self._added = np.where(doubtful, np.maximum(self._added, off**2), self._added)

    def _driven(self, machine: JointOnwards | JointsOnwards) -> "_Driven":
        known = np.array([joint in self.joints for joint in machine.joints])
        rows = [self.joints.index(joint) if joint in self.joints else 0 for joint in machine.joints]
        neutral = [self._rig.value(f"joints.{joint}.command.neutral") for joint in machine.joints]
        return _Driven(machine, np.array(rows), known, np.array(neutral))

    def _keep(self, values: np.ndarray) -> None:
        """Commands are held where a sample has none."""
        self._volts = np.where(np.isfinite(values[:, 0]), values[:, 0], self._volts)


@dataclass(frozen=True)
class _Driven:
    """Joints that are stepped together, where their commands stand, and what those get that have none."""

    machine: JointOnwards | JointsOnwards
    rows: np.ndarray
    known: np.ndarray
    neutral: np.ndarray

    def advance(self, volts: np.ndarray, until: float, times: np.ndarray, pulled: np.ndarray) -> None:
        """Step them; arguments in their own order."""
        if isinstance(self.machine, JointOnwards):
            self.machine.advance(volts, until, (float(times[0]), pulled))
        else:
            self.machine.advance(volts, until, (times, pulled))
