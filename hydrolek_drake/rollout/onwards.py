"""A machine stepped onwards from where it is, for whoever gives its commands bit by bit: the same compiled rollout.

Steps of the integration end where a call ends and where a delayed command arrives, as they end in a rollout at the
times that are asked for; so calls from row to row of a rollout give its numbers.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics import command
from hydrolek_drake.physics.bodies.serial_arm import scratch
from hydrolek_drake.physics.records import as_usual
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.kernel import SIGNALS, pulled
from hydrolek_drake.rollout.rest import rest_state
from hydrolek_drake.rollout.rollout import PreparedJoint
from hydrolek_drake.rollout.together.arms import moving_with
from hydrolek_drake.rollout.together.joint_rows import PLAY, STATE, put_state, room, state_at
from hydrolek_drake.rollout.together.kernel import integrate_together
from hydrolek_drake.rollout.together.together import JointsTogether, RunTogether, put_begun


class _Commands:
    """What has been commanded, as long as it may still have to arrive."""

    def __init__(self, delay: float) -> None:
        self._delay = delay
        self._times: list[float] = []
        self._values: list[np.ndarray] = []

    def add(self, time: float, volts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Times and values of commands that count from a time [s] on, with one given then [V]. # (m,), (m, n)."""
        if not self._values or not np.array_equal(self._values[-1], volts):
            self._times.append(time)
            self._values.append(volts.copy())
        while len(self._times) > 1 and self._times[1] + self._delay <= time:
            del self._times[0], self._values[0]
        return np.array(self._times), np.array(self._values)


class JointOnwards:
    """One joint by itself, stepped onwards.

    Attributes:
        joints: its name.
        time: where it is [s].
        signals: of it there, as `kernel.SIGNALS`. # (1, 9)
    """

    def __init__(self, rig: Rig, joint: str, time: float, position: float | None = None) -> None:
        """Put it at rest.

        Args:
            rig: the machine.
            joint: its name.
            time: when it is switched on [s].
            position: where it rests [rad or m]; None for the rig's own.

        Raises:
            InputError: the rig cannot be rolled out.
        """
        self.joints = (joint,)
        self.time = time
        record = rig.records()[rig.joints.index(joint)][None]
        self._machine = PreparedJoint(
            record,
            longest_step=rig.value("integration.longest_step"),
            spool_steps=round(rig.value("integration.spool_steps")),
        )
        self._commands = _Commands(float(command.transport_delay(record[0])))
        try:
            self._state = rest_state(record, position)
        except ZeroDivisionError:
            raise InputError(f"rig {rig.name}: {joint} cannot rest: a lever or an area is zero") from None
        neutral = record["command"]["neutral"]
        self._go(np.array([time]), np.array([time]), neutral)

    def advance(self, volts: np.ndarray, until: float, pull: tuple[float, np.ndarray] | None = None) -> None:
        """Hold a command [V], # (1,), from now until a time [s].

        Args:
            volts: the command.
            until: [s].
            pull: as in an observer: time constant [s], and `kernel.PULLED` as measured now, NaN where there is no
                value, # (1, 3), towards which the state is pulled before it moves on; None for a free rollout.

        Raises:
            InputError: the joint leaves all bounds.
        """
        times, values = self._commands.add(self.time, volts)
        whole = (
            None if pull is None else (pull[0], np.vstack([pull[1], pull[1]]))
        )  # the last row pulls nothing
        self._go(np.array([self.time, until]), times, values[:, 0], whole)
        self.time = until

    def states(self) -> np.ndarray:
        """Where it is, as `kernel.integrate` takes it up again. # (1, 18)."""
        return self._state[None].copy()

    def _go(
        self,
        times: np.ndarray,
        command_times: np.ndarray,
        command_values: np.ndarray,
        pull: tuple[float, np.ndarray] | None = None,
    ) -> None:
        done = self._machine.roll_out(command_times, command_values, times, state=self._state, pull=pull)
        if done.diverged is not None:
            raise InputError(f"{self.joints[0]}: {done.diverged}")
        self._state = done.state
        told = asdict(done.signals)
        self.signals = np.array([[told[name][-1] for name in SIGNALS]])


class JointsOnwards:
    """Joints that draw from one pump or move one arm, stepped onwards; see `JointsTogether`.

    Attributes:
        joints: that move, in the rig's order.
        time: where they are [s].
        signals: of each there, as `kernel.SIGNALS`. # (joints, 9)
    """

    def __init__(
        self, rig: Rig, joints: Sequence[str], time: float, positions: np.ndarray | None = None
    ) -> None:
        """Put them at rest.

        Args:
            rig: the machine.
            joints: that move; all are hydraulic.
            time: when it is switched on [s].
            positions: where they rest, in the rig's order [rad or m]; None for the rig's own. # (joints,)

        Raises:
            InputError: the rig cannot be rolled out.
        """
        moving = JointsTogether(rig, joints)
        self.joints = moving.joints
        self.time = self._begin = time
        records = rig.records()
        own = records[[rig.joints.index(joint) for joint in self.joints]]
        start = own["load"]["initial_position"] if positions is None else positions
        self._commands = _Commands(max(float(command.transport_delay(joint)) for joint in own))
        self._run: RunTogether = moving.run(
            records, np.array([time]), own["command"]["neutral"][None].copy(), np.array([time]), start
        )
        if self._run.begun is None:
            raise InputError(f"rig {rig.name}: {self._run.diverged}")
        self._rows, self._vectors, self._matrices = room(len(self.joints))
        put_begun(self._rows, self._run.begun)
        self._go(self._run.times, self._run.command_times, self._run.command_values)

    def advance(
        self, volts: np.ndarray, until: float, pull: tuple[float | np.ndarray, np.ndarray] | None = None
    ) -> None:
        """Hold commands [V], # (joints,), from now until a time [s].

        Args:
            volts: the commands.
            until: [s].
            pull: as of `JointOnwards.advance`: a time constant for all or one for each joint, # (joints,), and what was
                measured # (joints, 3).

        Raises:
            InputError: a joint leaves all bounds.
        """
        times, values = self._commands.add(self.time, volts)
        if pull is not None:
            spans = (until - self.time) / np.broadcast_to(pull[0], len(self.joints))
            pull_all(as_usual(self._run.records), self._rows, np.array(spans), self.signals, pull[1])
        self._go(np.array([self.time, until]), times, values)
        self.time = until

    def _go(self, times: np.ndarray, command_times: np.ndarray, command_values: np.ndarray) -> None:
        run = self._run
        told = np.full((len(times), len(self.joints), len(SIGNALS) + 1), np.nan)
        done = integrate_together(
            as_usual(run.records),
            as_usual(run.carriers),
            self._rows,
            self._vectors,
            self._matrices,
            command_times,
            command_values,
            times,
            run.longest_step,
            run.spool_steps,
            np.concatenate(run.laws) if any(map(len, run.laws)) else None,
            np.concatenate([[0], np.cumsum([len(law) for law in run.laws])]),
            run.links,
            scratch(len(run.links)),
            1.0,
            None,
            times[0] - self._begin,
            told,
        )
        if done < len(times):
            raise InputError(f"{', '.join(self.joints)}: left all bounds at {times[done]:.3f} s")
        self.signals = told[-1, :, : len(SIGNALS)]


def onwards(
    rig: Rig, joints: Sequence[str], time: float, positions: dict[str, float]
) -> list[JointOnwards | JointsOnwards]:
    """Joints of a rig at rest: those that share the pump or an arm together, every other one on its own.

    Args:
        rig: the machine.
        joints: that are commanded.
        time: when it is switched on [s].
        positions: where joints rest that do not where the rig has them [rad or m].

    Raises:
        InputError: the rig cannot be rolled out.
    """
    hydraulic = [joint for joint in joints if rig.is_hydraulic(joint)]
    alone = [joint for joint in joints if joint not in hydraulic or len(hydraulic) == 1]
    found: list[JointOnwards | JointsOnwards] = [
        JointOnwards(rig, joint, time, positions.get(joint)) for joint in alone
    ]
    if len(hydraulic) > 1:
        moving = moving_with(rig, hydraulic)
        own = [
            positions.get(joint, rig.value(f"joints.{joint}.load.initial_position"))
            for joint in rig.joints
            if joint in moving
        ]
        found.append(JointsOnwards(rig, moving, time, np.array(own)))
    return found


@njit(cache=True)
def pull_all(
    joints: np.ndarray, rows: np.ndarray, spans: np.ndarray, told: np.ndarray, measured: np.ndarray
) -> None:
    """Pull joints that move together to what was measured, as `kernel.integrate` does with one before it moves on.

    Args:
        joints: their records, shape (n,).
        rows: of `joint_rows.room`, with `STATE` and `PLAY`.
        spans: how far the next move goes, in time constants of each joint's pull, shape (n,).
        told: their signals now, before the pull, shape (n, at least 1), the reading first.
        measured: `kernel.PULLED` of them, NaN where there is no value, shape (n, 3).
    """
    for i in range(len(rows)):
        share = 1.0 - math.exp(-spans[i])
        s, by = pulled(state_at(rows, i, STATE), share, told[i, 0], measured[i], joints[i])
        put_state(rows, i, STATE, s)
        rows[i, PLAY] += by
