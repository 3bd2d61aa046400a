"""Joints of a rig under recorded commands: those that share the pump or an arm together, every other one on its own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.recorded_inputs import Inputs
from hydrolek_drake.rollout.rest import rest_state_at_reading
from hydrolek_drake.rollout.rollout import Signals, roll_out
from hydrolek_drake.rollout.together.arms import moving_with
from hydrolek_drake.rollout.together.together import JointsTogether


@dataclass(frozen=True)
class Driven:
    """A joint and its command.

    Attributes:
        joint: its name.
        times: of the command [s], increasing. # (m,)
        volts: each held until the next. # (m,)
        start: reading where it rests at first [rad or m]; None for where the rig says.
    """

    joint: str
    times: np.ndarray
    volts: np.ndarray
    start: float | None


@dataclass(frozen=True)
class Moved:
    """What the model of a joint did.

    Attributes:
        signals: rows after a divergence are NaN.
        diverged: None, or where and how it diverged.
    """

    signals: Signals
    diverged: str | None


def moved(
    rig: Rig,
    driven: Sequence[Driven],
    times: np.ndarray,
    elsewhere: Mapping[str, float],
    recorded: Mapping[str, Inputs] | None = None,
) -> dict[str, Moved]:
    """What driven joints do, from rest in balance.

    Several hydraulic joints draw from one pump and load each other through their arm, whose joints without a command
    give way on their oil: all of them are rolled out at once.

    Args:
        rig: the machine.
        driven: joints with their commands.
        times: when signals are wanted [s]; the first is when the machine is switched on. # (k,)
        elsewhere: joint without a command -> reading where it rests, if that is known [rad or m].
        recorded: joint -> what was recorded in place of a part of it, from the first of `times` on.
    """
    hydraulic = [one for one in driven if rig.is_hydraulic(one.joint)]
    given = recorded or {}
    together = _together(rig, hydraulic, times, elsewhere, given) if len(hydraulic) > 1 else {}
    return {
        one.joint: together[one.joint] if one.joint in together else _alone(rig, one, times, given)
        for one in driven
    }


def _alone(rig: Rig, one: Driven, times: np.ndarray, recorded: Mapping[str, Inputs]) -> Moved:
    record = rig.records()[rig.joints.index(one.joint)][None]
    done = roll_out(
        record,
        one.times,
        one.volts,
        times,
        state=None if one.start is None else rest_state_at_reading(record, one.start),
        longest_step=rig.value("integration.longest_step"),
        spool_steps=int(rig.value("integration.spool_steps")),
        probes=recorded.get(one.joint),
    )
    return Moved(done.signals, done.diverged)


def _together(
    rig: Rig,
    driven: Sequence[Driven],
    times: np.ndarray,
    elsewhere: Mapping[str, float],
    recorded: Mapping[str, Inputs],
) -> dict[str, Moved]:
    records = rig.records()
    moving = JointsTogether(rig, moving_with(rig, [one.joint for one in driven]))
    starts = {**elsewhere, **{one.joint: one.start for one in driven if one.start is not None}}
    places = [rig.joints.index(joint) for joint in moving.joints]
    command_times = np.unique(np.concatenate([one.times for one in driven]))
    volts = np.tile(records["command"]["neutral"][places], (command_times.size, 1))
    for one in driven:
        column = moving.joints.index(one.joint)
        held = np.searchsorted(one.times, command_times, side="right") - 1
        volts[held >= 0, column] = one.volts[held[held >= 0]]
    positions = records["load"]["initial_position"][places].copy()
    for column, (joint, place) in enumerate(zip(moving.joints, places, strict=True)):
        if joint in starts:
            positions[column] = rest_state_at_reading(records[place : place + 1], starts[joint])[4]
    done = moving.roll_out(records, command_times, volts, times, positions, recorded=recorded or None)
    return {one.joint: Moved(done.signals_of(one.joint), done.diverged) for one in driven}
