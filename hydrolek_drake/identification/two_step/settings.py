"""What is searched in each step and where it may lie: `two_step.yaml`, and its parameters on a rig."""

from dataclasses import replace
from functools import cache
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.yaml_files import package_yaml

MASSES = ("inertia", "gravity_cos", "gravity_sin")
"""What the CAD model says of a load; all grow with the links' masses."""

NO_GRAVITY = 1e-6
"""Gravity that would accelerate the load by less [rad/s^2] is none: a joint with a vertical axis."""


@cache
def two_step_data() -> dict[str, Any]:
    """Content of `two_step.yaml`."""
    return package_yaml(__package__, "two_step.yaml")


def only_joint(rig: Rig) -> str:
    """The joint of a rig that the two steps can identify.

    Raises:
        InputError: several joints, or one that is not moved by solenoid, valve and chambers, or that slides.
    """
    if len(rig.joints) != 1:
        raise InputError(
            f"rig {rig.name} has {len(rig.joints)} joints; the two steps identify one: take a rig such as "
            "hydrolek_right_j2, or name one with keep: [JOINT]"
        )
    (joint,) = rig.joints
    for stage, wanted in (("amplifier", "proportional"), ("solenoid", "spool_pair")):
        if rig.variant(joint, stage) != wanted:
            raise InputError(
                f"rig {rig.name}: {joint}.{stage} is '{rig.variant(joint, stage)}'; the sixteen hydraulic "
                f"parameters of Table 4.1 are those of a '{wanted}'"
            )
    if rig.variant(joint, "load") == "sliding":
        raise InputError(f"rig {rig.name}: {joint} slides; the two steps are of turning joints")
    return joint


def with_ranges(rig: Rig, ranges: dict[str, tuple[float, float, str]]) -> Rig:
    """The rig with ranges for some parameters: full path -> lower, upper end (SI), and scale.

    A parameter that followed another no longer does.
    """
    entries = dict(rig.entries)
    for path, (low, high, scale) in ranges.items():
        entries[path] = replace(
            entries[path],
            value=rig.value(path),
            range=(low, high),
            scale=scale,
            same_as=None,
        )
    return replace(rig, entries=entries)


def mechanical_ranges(rig: Rig, joint: str) -> dict[str, tuple[float, float, str]]:
    """Inertia, gravity and damping of the load; gravity that is none is left out."""
    step = two_step_data()["step_one"]
    factor = float(step["known_within"]["value"])
    ranges: dict[str, tuple[float, float, str]] = {}
    inertia = rig.value(f"joints.{joint}.load.inertia")
    for name in MASSES:
        path = f"joints.{joint}.load.{name}"
        value = rig.value(path)
        if abs(value) > NO_GRAVITY * inertia:
            low, high = sorted((value / factor, value * factor))
            ranges[path] = (low, high, "log" if low > 0.0 else "linear")
    low, high = map(float, step["damping"]["range"])
    ranges[f"joints.{joint}.load.damping"] = (low, high, "log")
    return ranges


def hydraulic_ranges(rig: Rig, joint: str) -> dict[str, tuple[float, float, str]]:
    """The parameters of Table 4.1 on this rig, in the table's order."""
    data = two_step_data()
    factors = data["factor_without_range"]
    ranges: dict[str, tuple[float, float, str]] = {}
    for row in data["table_4_1"].values():
        short = str(row["path"])
        path = f"joints.{joint}.{short}"
        entry = rig.entries[path]
        if entry.range is not None:
            ranges[path] = (*entry.range, entry.scale)
        else:
            factor = float(factors.get(short, factors["any other"])["value"])
            ranges[path] = (rig.value(path) / factor, rig.value(path) * factor, "log")
    return ranges


def all_ranges(rig: Rig, joint: str) -> dict[str, tuple[float, float, str]]:
    """Mechanical and hydraulic parameters, and all others with a range: what the polish searches."""
    others = {
        path: (*entry.range, entry.scale) for path, entry in rig.free_parameters().items() if entry.range
    }
    return {**mechanical_ranges(rig, joint), **hydraulic_ranges(rig, joint), **others}
