"""What looks wrong with a recording of a machine: signs, units, exchanged columns, clocks; and what it cannot tell."""

import math

import numpy as np

from hydrolek_drake.checking.beside_the_model import against_the_model
from hydrolek_drake.checking.clock import refuse_other_clock
from hydrolek_drake.checking.complaint import Complaint
from hydrolek_drake.checking.not_told import not_told
from hydrolek_drake.checking.slips import UNITS, column
from hydrolek_drake.recordings import Recording, require
from hydrolek_drake.replay.noise import noise_level
from hydrolek_drake.replay.readings import SUPPLY_KEY, driven_joints, measured_position, position_key
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.recorded_inputs import with_commands

PLAUSIBLE, LARGEST = (0.03, 5.0), 0.7
"""Shares of the supply pressure between which the largest pressure of a recording lies, and where it mostly does."""


def check_recording(rig: Rig, recording: Recording) -> list[Complaint]:
    """What is implausible about a recording, of each joint that is driven alone in it.

    Raises:
        InputError: as of `refuse_other_clock`.
    """
    refuse_other_clock(rig, recording)
    recording = with_commands(rig, recording)
    found: list[Complaint] = []
    for joint in driven_joints(rig, recording):
        found += _joint(rig, joint, recording)
    found += _pressures(rig, recording)
    return found


def _joint(rig: Rig, joint: str, recording: Recording) -> list[Complaint]:
    key = position_key(rig, joint)
    if rig.needs_command(joint):
        require(recording, [], units={f"{joint}.command": "V"})
    volts = np.asarray(recording.signal(f"{joint}.command"), dtype=float)
    position = np.asarray(measured_position(rig, joint, recording), dtype=float)
    found = _command(rig, joint, volts) if rig.needs_command(joint) else []
    if not np.isfinite(position).any() or not np.isfinite(volts).all():
        return found
    noise = noise_level(position)
    if np.nanmax(position) - np.nanmin(position) <= 6.0 * max(noise, np.finfo(float).tiny):
        return [*found, Complaint(key, "does not move: it is constant but for its noise", "")]
    unit = "m" if key.endswith("position") else "rad"
    slipped = _beyond_its_stops(rig, joint, key, position, unit)
    if found or slipped or len(rig.joints) > 1:
        return found + slipped
    return [
        *against_the_model(rig, joint, recording, volts, position, noise, unit),
        *not_told(rig, joint, recording, volts, position),
    ]


def _command(rig: Rig, joint: str, volts: np.ndarray) -> list[Complaint]:
    key, limit = f"{joint}.command", rig.value(f"joints.{joint}.command.limit")
    largest = float(np.nanmax(np.abs(volts - rig.value(f"joints.{joint}.command.neutral"))))
    if np.nanmax(volts) == np.nanmin(volts):
        return [Complaint(key, f"is constant at {volts[0]:g} V: nothing can be told", "")]
    if largest > 20.0 * limit:
        return [
            Complaint(
                key,
                f"reaches {largest:.4g} V, the limit is {limit:g} V: mV in a column of V?",
                column(key, "V", "mV"),
            )
        ]
    if largest < 1e-2 * limit:
        return [
            Complaint(
                key,
                f"reaches {largest:.2g} V, the limit is {limit:g} V: V in a column of mV?",
                column(key, "mV", "V"),
            )
        ]
    return []


def _beyond_its_stops(rig: Rig, joint: str, key: str, position: np.ndarray, unit: str) -> list[Complaint]:
    lower, upper = (rig.value(f"joints.{joint}.load.{name}") for name in ("lower_stop", "upper_stop"))
    way, moved = upper - lower, float(np.nanmax(position) - np.nanmin(position))
    if not math.isfinite(way) or moved <= 2.0 * way:
        return []
    slip = next(
        (
            (called, has)
            for factor, called, has in UNITS[unit]
            if factor > 1.0 and moved <= 2.0 * way * factor
        ),
        None,
    )
    called = f": {slip[0]}?" if slip else ""
    return [
        Complaint(
            key,
            f"moves over {moved:.4g} {unit}, its stops are {way:.4g} {unit} apart{called}",
            column(key, unit, slip[1]) if slip else "",
        )
    ]


def _pressures(rig: Rig, recording: Recording) -> list[Complaint]:
    """Pressures that are constant, or of another unit: the largest is near the supply's somewhere."""
    found = []
    supply = rig.value("supply.pressure")
    for joint in rig.joints:
        if not rig.is_hydraulic(joint):
            return []
    keys = [f"{joint}.{side}" for joint in rig.joints for side in ("pressure_a", "pressure_b")]
    for key in [k for k in (*keys, SUPPLY_KEY) if k in recording.signals]:
        values = np.asarray(recording.signal(key), dtype=float)
        if not np.isfinite(values).any():
            continue
        if np.nanmax(values) == np.nanmin(values):
            found.append(Complaint(key, f"is constant at {np.nanmax(values):.4g} Pa: no sensor there?", ""))
            continue
        ratio = max(float(np.nanmax(np.abs(values))), np.finfo(float).tiny) / supply
        slip = None
        if not PLAUSIBLE[0] < ratio < PLAUSIBLE[1]:
            off, called, has = min(UNITS["Pa"], key=lambda each: abs(math.log(ratio / each[0] / LARGEST)))
            slip = (called, has) if PLAUSIBLE[0] < ratio / off < PLAUSIBLE[1] else None
        if slip:
            read_as = slip[0].split(" column of ")[1]
            found.append(
                Complaint(
                    key,
                    f"reaches {np.nanmax(np.abs(values)):.3g} Pa where the supply has {supply:.3g} Pa: {slip[0]}?",
                    column(key, read_as, slip[1]),
                )
            )
    return found
