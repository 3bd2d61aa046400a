"""What happened in a run, in numbers and in one sentence."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.replay.display import shown
from hydrolek_drake.runs.running import ScenarioRun
from hydrolek_drake.runs.signals import commanded_voltages

SETTLING = 1.0
"""Seconds that a joint is given to come to rest before its movement at rest is measured."""


@dataclass(frozen=True)
class JointSummary:
    """What one joint did.

    Attributes:
        joint: its name.
        unit: "rad" or "m".
        start: position at the beginning.
        end: position at the end.
        lowest: smallest position.
        highest: largest position.
        pressure: highest of both chambers [Pa], or None.
        at_stops: time at the end stops or beyond [s].
        rest_movement: largest movement after the joint's last command has had time to settle, or None if there is
            no such time or that command still drives the joint.
    """

    joint: str
    unit: str
    start: float
    end: float
    lowest: float
    highest: float
    pressure: float | None
    at_stops: float
    rest_movement: float | None

    @property
    def range(self) -> float:
        """How far the joint moved [rad or m]."""
        return self.highest - self.lowest


def summarize(done: ScenarioRun) -> tuple[JointSummary, ...]:
    """One summary for each joint of the rig."""
    rig, run = done.scenario.rig, done.run
    records, volts = rig.records(), commanded_voltages(done)
    steps = np.diff(run.time, append=run.time[-1])
    summaries = []
    for i, joint in enumerate(rig.joints):
        position, load = run.signals["position"][:, i], records[i]["load"]
        outside = (position <= load["lower_stop"]) | (position >= load["upper_stop"])
        pressure = None
        if "pressure_a" in run.signals:
            pressure = float(max(run.signals[f"pressure_{side}"][:, i].max() for side in "ab"))
        summaries.append(
            JointSummary(
                joint=joint,
                unit="m" if rig.variant(joint, "load") == "sliding" else "rad",
                start=float(position[0]),
                end=float(position[-1]),
                lowest=float(position.min()),
                highest=float(position.max()),
                pressure=pressure,
                at_stops=float(steps[outside].sum()),
                rest_movement=_rest_movement(run.time, position, volts[:, i], records[i]),
            )
        )
    return tuple(summaries)


def sentence(done: ScenarioRun, joints: tuple[JointSummary, ...]) -> str:
    """What was run and what stands out."""
    scenario, end = done.scenario, float(done.run.time[-1])
    what = "on operator's signals" if scenario.operator else "on voltages"
    if scenario.controlled is not None:
        what = f"under {' and '.join(dict.fromkeys(scenario.controlled.controllers.values()))}"
    parts = [f"{scenario.name}: rig {scenario.rig.name} ran for {end:.3g} s {what}"]
    if done.run.interrupted:
        parts[0] += f" and was interrupted (asked for: {scenario.duration:.3g} s)"
    if scenario.supply_lost_at is not None and scenario.supply_lost_at < end:
        parts.append(f"the supply was lost at {scenario.supply_lost_at:g} s")
    widest = max(joints, key=lambda joint: joint.range)
    if np.degrees(widest.range) < _STILL_DEG and widest.unit == "rad":
        parts.append("no joint moved")
    else:
        parts.append(f"{widest.joint} moved farthest, {shown(widest.range, widest.unit)}")
    missed = {joint: abs(wanted[-1] - _end_of(joints, joint)) for joint, wanted in done.set_points().items()}
    missed = {joint: error for joint, error in missed.items() if np.isfinite(error)}
    if missed:
        worst = max(missed, key=lambda joint: missed[joint])
        parts.append(
            f"at the end joints were at most {shown(missed[worst], 'rad')} off their set points ({worst})"
        )
    creeping = [joint for joint in joints if joint.rest_movement is not None]
    if creeping:
        most = max(creeping, key=lambda joint: joint.rest_movement or 0.0)
        parts.append(f"with their valves closed, joints moved at most {_at_least_seen(most)} ({most.joint})")
    pressed = [joint for joint in joints if joint.pressure is not None]
    if pressed:
        highest = max(pressed, key=lambda joint: joint.pressure or 0.0)
        parts.append(f"the highest pressure was {shown(highest.pressure or 0.0, 'Pa')} in {highest.joint}")
    return "; ".join(parts) + "."


def _end_of(joints: tuple[JointSummary, ...], name: str) -> float:
    return next(joint.end for joint in joints if joint.joint == name)


_STILL_DEG = 0.01  # half the resolution of the sensors
_UNSEEN = 1e-6  # rad or m


def _at_least_seen(joint: JointSummary) -> str:
    movement = joint.rest_movement or 0.0
    return shown(movement, joint.unit) if movement >= _UNSEEN else f"less than {shown(_UNSEEN, joint.unit)}"


def _rest_movement(
    time: np.ndarray, position: np.ndarray, volts: np.ndarray, record: np.void
) -> float | None:
    """Largest movement while the command stands at neutral, after the delay and `SETTLING`."""
    if volts[-1] != record["command"]["neutral"]:
        return None
    changes = np.flatnonzero(np.diff(volts)) + 1
    last = time[changes[-1]] + float(record["command"]["delay"]) if changes.size else time[0]
    rest = position[time >= last + SETTLING]
    return float(np.abs(rest - rest[0]).max()) if rest.size > 1 else None
