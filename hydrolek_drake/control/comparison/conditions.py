"""Machines on which controllers are judged: posture, load, dead-zone, and random deviations."""

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.yaml_files import package_yaml


@cache
def conditions_data() -> dict[str, Any]:
    """Content of `conditions.yaml`."""
    return package_yaml(__package__, "conditions.yaml")


@dataclass(frozen=True)
class Condition:
    """What differs from the nominal machine.

    Attributes:
        posture: "working" (the rig's own), "stretched" or "folded": where the other joints stand.
        load_kg: at the gripper.
        dead_zone: factor on the voltages at which the valve opens.
    """

    posture: str = "working"
    load_kg: float = 0.0
    dead_zone: float = 1.0

    def __str__(self) -> str:
        """As in tables."""
        parts = [self.posture, f"{self.load_kg:g} kg"]
        if self.dead_zone != 1.0:
            parts.append(f"dead-zone {100.0 * (self.dead_zone - 1.0):+.0f} %")
        return ", ".join(parts)


def judged_conditions() -> tuple[Condition, ...]:
    """The conditions of the issue: stretched and folded, 0 and 50 kg, and a larger dead-zone."""
    load = float(conditions_data()["load"]["value"])
    wide = float(conditions_data()["dead_zone"]["value"])
    plain = [Condition(posture, kg) for posture in ("stretched", "folded") for kg in (0.0, load)]
    return (Condition(), *plain, Condition(dead_zone=wide), Condition("stretched", load, wide))


def machine(joint: str, condition: Condition, generator: np.random.Generator | None = None) -> np.ndarray:
    """Parameter record of one HydroLek joint under a condition, shape (1,).

    The dead-zone's factor is one of voltage: spool and solenoid's force grow with its square, so the overlap
    does, and the distance from there to full opening stays.

    Args:
        joint: "right_j1" to "left_j5".
        condition: posture, load, dead-zone.
        generator: draws deviations of the parameters listed in `conditions.yaml`; None for none.

    Raises:
        InputError: no such joint or posture.
    """
    rig = load_rig(f"hydrolek_{joint}")
    rig = _posed(rig, joint, condition.posture)
    values: dict[str, float] = {
        f"joints.{joint}.effects.load.payload.mass_kg": condition.load_kg,
    }
    factor = condition.dead_zone**2
    for side in "ab":
        overlap = rig.value(f"valve.overlap_{side}")
        grown = (factor - 1.0) * overlap
        values[f"joints.{joint}.valve.overlap_{side}"] = overlap + grown
        values[f"joints.{joint}.valve.full_opening_{side}"] = rig.value(f"valve.full_opening_{side}") + grown
    if generator is not None:
        for path, spread in conditions_data()["deviations"].items():
            full = rig.full_path(path)
            if full in rig.entries and path not in values:
                drawn = float(np.exp(generator.uniform(-1.0, 1.0) * np.log1p(float(spread))))
                values[full] = values.get(full, rig.value(full)) * drawn
    return rig.with_values(values).records()


def _posed(rig: Rig, joint: str, posture: str) -> Rig:
    postures = conditions_data()["postures"]
    if posture == "working":
        return rig
    if posture not in postures:
        raise InputError(f"no posture '{posture}'; choose working, {', '.join(postures)}")
    arm = joint.partition("_")[0]
    held = dict(rig.held)
    for number, angle_deg in postures[posture].items():
        name = f"{arm}_{number}"
        if name in held:
            held[name] = float(np.radians(angle_deg))
    return replace(rig, held=held)


def span_deg(joint: str) -> tuple[float, float]:
    """Two set points, 30 deg apart about the middle of the joint's range, between which steps are judged."""
    rig = load_rig(f"hydrolek_{joint}")
    low, high = np.degrees([rig.value("load.lower_stop"), rig.value("load.upper_stop")])
    step = float(conditions_data()["step"]["value"])
    middle = 0.5 * (float(low) + float(high))
    return middle - 0.5 * step, middle + 0.5 * step
