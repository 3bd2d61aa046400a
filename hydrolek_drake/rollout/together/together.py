"""Joints of a machine that move together, driven through commands: what the Diagram does, compiled."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.compiled import read_only
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.bodies.serial_arm import moments_along, scratch
from hydrolek_drake.physics.law import LAW, law_of
from hydrolek_drake.physics.records import as_usual
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.kernel import SIGNALS
from hydrolek_drake.rollout.rest import rest_state
from hydrolek_drake.rollout.rollout import (
    DIVIDED_BY_ZERO,
    Signals,
    check_driven,
    missing_number,
    why_diverged,
)
from hydrolek_drake.rollout.together.arms import arm_links, carriers_of, payloads
from hydrolek_drake.rollout.together.joint_rows import DRIVE, PLAY, RATES, SPOOL, STATE, room
from hydrolek_drake.rollout.together.kernel import TOLD, integrate_together


@dataclass(frozen=True)
class Together:
    """What joints did; SI units.

    Attributes:
        time: [s]. # (k,)
        joints: their names, in the order of the columns.
        signals: those of a rollout, and `drawn`, the flow from the supply [m^3/s]. # each (k, joints)
        diverged: None, or when it diverged; rows from then on are NaN.
    """

    time: np.ndarray
    joints: tuple[str, ...]
    signals: dict[str, np.ndarray]
    diverged: str | None

    def signals_of(self, joint: str, rows: np.ndarray | slice = slice(None)) -> Signals:
        """What one of the joints did, as its own rollout tells it.

        Args:
            joint: its name.
            rows: times that are wanted; all of them if not given.
        """
        column = self.joints.index(joint)
        return Signals(self.time[rows], **{name: self.signals[name][rows, column] for name in SIGNALS})


@dataclass(frozen=True)
class RunTogether:
    """A machine whose joints move together, and what it is driven with: a rollout that has not been made yet.

    Attributes:
        joints: their names.
        links: of the arms that they turn, rows of `serial_arm.link`, or none. # (joints, 36)
        records: of the joints. # (joints,)
        carriers: see `arms.carriers_of`. # (joints,)
        laws: of each joint, rows of `law.LAW`.
        begun: states at rest, see `rollout.kernel.integrate`; None where there is none. # (joints, 18)
        command_times: when commands change [s]. # (m,)
        command_values: held from then on [V]. # (m, joints)
        times: when signals are wanted [s]. # (k,)
        longest_step: of the integration [s].
        spool_steps: steps of the spool within one step.
        diverged: why it cannot even begin, or None.
        recorded: what drives joints in place of a part of them: spacing of the samples [s], and `probes.PROBES` of each
            joint, # (joints, samples, 15); None for nothing.
    """

    joints: tuple[str, ...]
    links: np.ndarray
    records: np.ndarray
    carriers: np.ndarray
    laws: tuple[np.ndarray, ...]
    begun: np.ndarray | None
    command_times: np.ndarray
    command_values: np.ndarray
    times: np.ndarray
    longest_step: float
    spool_steps: int
    diverged: str | None = None
    recorded: tuple[float, np.ndarray] | None = None

    def outcome(self) -> Together:
        """What the joints do, rolled out by themselves."""
        told, n = self.nothing(), len(self.records)
        if self.begun is None:
            return self.told(told, 0)
        rows, vectors, matrices = room(n)
        put_begun(rows, self.begun)
        done = integrate_together(
            as_usual(self.records),
            as_usual(self.carriers),
            rows,
            vectors,
            matrices,
            self.command_times,
            self.command_values,
            self.times,
            self.longest_step,
            self.spool_steps,
            np.concatenate(self.laws) if any(map(len, self.laws)) else None,
            np.concatenate([[0], np.cumsum([len(law) for law in self.laws])]),
            self.links,
            scratch(len(self.links)),
            *(self.recorded or (1.0, None)),
            0.0,
            told,
        )
        return self.told(told, done)

    def nothing(self) -> np.ndarray:
        """Room for what is told. # (k, joints, 10)."""
        return np.full((len(self.times), len(self.records), len(TOLD)), np.nan)

    def told(self, told: np.ndarray, done: int) -> Together:
        """The result of so many rows that were written before a divergence; `told` is kept."""
        diverged = self.diverged
        if diverged is None and done < len(self.times):
            at = float(self.times[done])
            reasons = [why_diverged(self.records[i : i + 1], at) for i in range(len(self.records))]
            diverged = DIVIDED_BY_ZERO if DIVIDED_BY_ZERO in reasons else reasons[0]
            if diverged == DIVIDED_BY_ZERO:
                told[:] = np.nan
        signals = dict(zip(TOLD, np.moveaxis(told, 2, 0), strict=True))
        return Together(self.times, self.joints, signals, diverged)


def put_begun(rows: np.ndarray, begun: np.ndarray) -> None:
    """Write states at rest into rows of `room`, or of several machines with the lanes behind.

    Args:
        rows: # (joints, at least 69) or (joints, at least 69, lanes)
        begun: # (joints, 18) or (joints, 18, lanes)
    """
    rows[:, STATE : RATES - 2], rows[:, RATES - 2 : RATES] = begun[:, 2:11], begun[:, 16:18]
    rows[:, PLAY] = begun[:, 11]
    rows[:, DRIVE : DRIVE + 3], rows[:, DRIVE + 3 : SPOOL] = begun[:, 13:16], begun[:, :2]


class JointsTogether:
    """Joints of a machine that move together, ready to be driven again and again.

    Attributes:
        joints: that move, in the rig's order; the rest is held where the rig has it.
    """

    def __init__(self, rig: Rig, joints: Sequence[str]) -> None:
        """Prepare.

        Args:
            rig: the machine.
            joints: that move; all are hydraulic.

        Raises:
            InputError: one of them has long lines, whose waves are followed of joints that move alone.
        """
        lined = [j for j in joints if rig.variant(j, "hose") == "long_line"]
        if lined:
            raise InputError(
                f"rig {rig.name}: {lined[0]}.hose: long lines are followed of joints that move alone, and on the Drake "
                "diagram; where joints move together use variant: hose"
            )
        self._rig = rig
        self.joints = tuple(j for j in rig.joints if j in joints)
        self._places = [rig.joints.index(joint) for joint in self.joints]
        self._links = arm_links(rig, self.joints)
        self._longest_step = rig.value("integration.longest_step")
        self._spool_steps = round(rig.value("integration.spool_steps"))

    def roll_out(
        self,
        records: np.ndarray,
        command_times: np.ndarray,
        command_values: np.ndarray,
        times: np.ndarray,
        positions: np.ndarray,
        longest_step: float | None = None,
        recorded: Mapping[str, tuple[float, np.ndarray]] | None = None,
    ) -> Together:
        """Drive the joints from rest.

        Args:
            records: of all joints of the rig, which may have other values than it. # (rig's joints,)
            command_times: [s], increasing. # (m,)
            command_values: [V], each held until the next, neutral before the first has arrived. # (m, joints)
            times: when signals are wanted [s], increasing. # (k,)
            positions: where the joints rest at the first of these [rad or m]. # (joints,)
            longest_step: of the integration [s]; None for the rig's own.
            recorded: of each joint that a recording drives in place of a part of it, spacing [s] and samples as of
                `rollout.roll_out`, all of one recording; None for nothing.

        Raises:
            InputError: a joint is driven so, and nothing recorded is given.
        """
        return self.run(
            records, command_times, command_values, times, positions, longest_step, recorded
        ).outcome()

    def run(
        self,
        records: np.ndarray,
        command_times: np.ndarray,
        command_values: np.ndarray,
        times: np.ndarray,
        positions: np.ndarray,
        longest_step: float | None = None,
        recorded: Mapping[str, tuple[float, np.ndarray]] | None = None,
    ) -> "RunTogether":
        """The rollout that `roll_out` makes, to be made beside others (`lanes`); arguments as there."""
        own = np.ascontiguousarray(records[self._places])
        check_driven(own, recorded is not None)
        found = [law_of(own[i : i + 1]) for i in range(len(own))]
        changes = np.concatenate([[True], np.any(np.diff(command_values, axis=0) != 0.0, axis=1)])
        missing = (missing_number(own[i : i + 1]) for i in range(len(own)))
        diverged = next((said for said in missing if said is not None), None)
        carriers, begun = carriers_of(self._rig, self.joints, records), None
        if diverged is None:
            try:
                begun = np.array(
                    [
                        rest_state(own[i : i + 1], float(positions[i]), carried=carried)
                        for i, carried in enumerate(self._carried(carriers, positions))
                    ]
                )
            except ZeroDivisionError:
                diverged = DIVIDED_BY_ZERO
        return RunTogether(
            self.joints,
            self._links,
            own,
            carriers,
            tuple(np.zeros(0, LAW) if law is None else law for law in found),
            begun,
            read_only(command_times[changes]),
            read_only(command_values[changes]),
            read_only(times),
            longest_step or self._longest_step,
            self._spool_steps,
            diverged,
            self._recorded_rows(recorded) if recorded else None,
        )

    def _recorded_rows(self, recorded: Mapping[str, tuple[float, np.ndarray]]) -> tuple[float, np.ndarray]:
        """Spacing [s] and samples of all joints, zero for those that nothing drives. # (joints, samples, 15)."""
        spacing, some = next(iter(recorded.values()))
        rows = np.zeros((len(self.joints), *some.shape))
        for i, joint in enumerate(self.joints):
            if joint in recorded:
                rows[i] = recorded[joint][1]
        return spacing, rows

    def _carried(self, carriers: np.ndarray, positions: np.ndarray) -> list[float | None]:
        """Gravity's moment on each joint at rest [N m]; None where it carries no other joint."""
        if not len(self._links):
            return [None] * len(carriers)
        still = np.zeros((1, len(carriers)))
        hanging = payloads(carriers, still[:, 0])
        return moments_along(self._links, positions[None, :], still, still, hanging)[0].tolist()
