"""The observer: the fitted model, stepped by the rollout's own loop and pulled to what was measured.

At every sample the model tells what will be measured; the innovation is by how much it is not, e = y - y^. The state
then goes towards the measurement by the share 1 - exp(-h / T) of it over the interval h, with the pull time T
(`kernel.pulled`; a Luenberger observer whose gain acts on position and pressures, Luenberger, IEEE Transactions on
Military Electronics 8, 1964).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.kernel import PULLED, SIGNALS
from hydrolek_drake.rollout.onwards import JointOnwards, JointsOnwards, onwards
from hydrolek_drake.watching.live.settings import PULL_S

_TOLD = [SIGNALS.index(name) for name in PULLED]


class Observer:
    """All joints of a machine.

    Attributes:
        joints: that are observed, in the order of the rows.
        time: of the sample at which it stands [s]; None before it has begun.
        modelled: what it expected there of `kernel.PULLED`; NaN at the first sample. # (joints, 3)
    """

    def __init__(self, rig: Rig, joints: Sequence[str], pull_time: float = PULL_S) -> None:
        """Prepare.

        Args:
            rig: with the values of the fitted model.
            joints: that are observed.
            pull_time: time constant of the pull [s].
        """
        self._rig, self.joints, self._pull_time = rig, tuple(joints), pull_time
        self._neutral = np.array([rig.value(f"joints.{joint}.command.neutral") for joint in self.joints])
        self.restart()

    def restart(self) -> None:
        """Forget the state: the next sample begins anew."""
        self.time: float | None = None
        self.modelled = np.full((len(self.joints), len(PULLED)), np.nan)
        self._machines: list[_Driven] = []
        self._volts = self._neutral.copy()
        self._measured = self.modelled.copy()

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
        else:
            told = self._advance(time, measured)
        self.time = time
        self._measured = measured
        self._keep(values)
        return told

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
        for each in self._machines:
            pulled = np.where(each.known[:, None], self._measured[each.rows], np.nan)
            volts = np.where(each.known, self._volts[each.rows], each.neutral)
            each.machine.advance(volts, time, (self._pull_time, pulled))
            self.modelled[each.rows[each.known]] = each.machine.signals[each.known][:, _TOLD]
        if not np.isfinite(self.modelled[:, 0]).all():
            raise InputError("the observer has no value")
        return np.asarray(measured - self.modelled)

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
