"""Checks across a rig's parameters."""

from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs.checks import linkages, valves
from hydrolek_drake.rigs.checks.checked import Checked


def check(rig: Checked) -> None:
    """Refuse a rig whose parameters contradict each other.

    Raises:
        InputError: an impossible triangle, an empty travel, a valve that never opens.
    """
    for joint in rig.joints:
        where = f"joints.{joint}"
        lower, upper = (rig.value(f"{where}.load.{name}") for name in ("lower_stop", "upper_stop"))
        if not lower < upper:
            raise InputError(
                f"{rig.path}: {where}.load: lower_stop {lower:g} must lie below upper_stop {upper:g}"
            )
        _check_signs(rig, where)
        linkages.check(rig, where, lower, upper)
        valves.check(rig, where)
        _check_sensor(rig, where)
    _check_supply(rig)


def _check_supply(rig: Checked) -> None:
    """Effects on the pump, which all joints share, stand at the first joint alone; an accumulator needs a pump."""
    if rig.variants["accumulator"] == "gas" and rig.variants["supply"] != "pump":
        raise InputError(
            f"{rig.path}: accumulator: a supply with variant {rig.variants['supply']} keeps its pressure whatever is "
            "drawn; an accumulator needs variant: pump"
        )
    first = rig.joints[0]
    for joint in rig.joints[1:]:
        for effect in EFFECTS.values():
            path = f"joints.{joint}.effects.{effect.id}.{effect.size}"
            common = rig.value(f"joints.{first}.effects.{effect.id}.{effect.size}")
            if rig.owner(effect, joint) != joint and rig.value(path) not in (effect.neutral_size, common):
                raise InputError(
                    f"{rig.path}: {path}: all joints share one pump; set it at the first joint, "
                    f"joints.{first}.effects.{effect.id}.{effect.size}"
                )


def _check_signs(rig: Checked, where: str) -> None:
    names = ["command.polarity"]
    if rig.variants[f"{where}.linkage"] != "lever_table":
        names.append("linkage.direction")
    if rig.variants[f"{where}.linkage"] == "four_bar":
        names.append("linkage.assembly")
    for name in names:
        sign = rig.value(f"{where}.{name}")
        if abs(sign) != 1.0:
            raise InputError(f"{rig.path}: {where}.{name}: {sign:g} is not a direction; use 1 or -1")


def _check_sensor(rig: Checked, where: str) -> None:
    lower, upper = (rig.value(f"{where}.sensor.{name}") for name in ("travel_lower", "travel_upper"))
    if not lower < upper:
        raise InputError(
            f"{rig.path}: {where}.sensor: travel_lower {lower:g} must lie below travel_upper {upper:g}"
        )
    if (
        rig.variants[f"{where}.sensor"] == "potentiometer"
        and rig.value(f"{where}.sensor.volts_per_degree") == 0.0
    ):
        raise InputError(
            f"{rig.path}: {where}.sensor.volts_per_degree: 0 V/deg tells no angle; use a scaling such as 0.1"
        )
