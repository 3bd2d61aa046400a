"""Checks across a rig's parameters."""

import math
from pathlib import Path
from typing import Protocol

from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.effects.effect import Effect
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.valve import EDGES


class Checked(Protocol):
    """What of a rig is looked at here, see `rig.Rig`; a rig checks itself, so that it stands above this."""

    @property
    def path(self) -> Path:
        """The file it came from."""

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the moving joints."""

    @property
    def variants(self) -> dict[str, str]:
        """The chosen variant of each stage."""

    def value(self, path: str) -> float:
        """Value of a parameter in SI."""

    def owner(self, effect: Effect, joint: str) -> str:
        """The joint whose parameters of an effect act on `joint`."""


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
        _check_triangle(rig, where, lower, upper)
        _check_valve(rig, where)
        _check_sensor(rig, where)
    _check_supply(rig)


def _check_supply(rig: Checked) -> None:
    """Effects on the pump, which all joints share, stand at the first joint alone."""
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
    for name in ("linkage.direction", "command.polarity"):
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


def _check_triangle(rig: Checked, where: str, lower: float, upper: float) -> None:
    if rig.variants[f"{where}.linkage"] != "triangle":
        return
    a, b, offset, direction = (
        rig.value(f"{where}.linkage.{name}")
        for name in ("distance_parent", "distance_child", "angle_offset", "direction")
    )
    if a <= 0.0 or b <= 0.0:
        raise InputError(
            f"{rig.path}: {where}.linkage: impossible triangle, mounting distances {a:g} m and {b:g} m must be positive"
        )
    for name, position in (("lower_stop", lower), ("upper_stop", upper)):
        included = direction * position + offset
        if not 0.0 < included < math.pi:
            raise InputError(
                f"{rig.path}: {where}.linkage: impossible triangle, at {name} "
                f"({math.degrees(position):.1f} deg) the angle "
                f"between the mounts is {math.degrees(included):.1f} deg; it must stay between 0 and 180"
            )
    if rig.variants[f"{where}.cylinder"] == "cylinder":
        inner = direction * (lower if direction > 0 else upper) + offset
        shortest = math.sqrt(max(a * a + b * b - 2.0 * a * b * math.cos(inner), 0.0))
        zero = rig.value(f"{where}.linkage.zero_stroke_length")
        if rig.value(f"{where}.cylinder.stop_stiffness") > 0.0:
            return  # its own stop ends the stroke, before the load's do
        # a stop gives way, and may lie a little beyond zero stroke; but the piston does not pass the dead volume
        room = rig.value(f"{where}.cylinder.dead_volume_a") / rig.value(f"{where}.cylinder.area_a")
        if zero - shortest > room:
            raise InputError(
                f"{rig.path}: {where}.linkage.zero_stroke_length: {zero:g} m is longer by {zero - shortest:g} m than "
                f"the mounts come together ({shortest:g} m, at the stops); at most dead_volume_a over area_a, "
                f"{room:g} m, lies beyond zero stroke"
            )


def _check_valve(rig: Checked, where: str) -> None:
    if rig.variants[f"{where}.valve"] == "none":
        return
    if rig.variants[f"{where}.valve"] == "four_edges":
        full = rig.value(f"{where}.valve.full_opening")
        for edge in EDGES:
            if not (overlap := rig.value(f"{where}.valve.overlap_{edge}")) < full:
                raise InputError(
                    f"{rig.path}: {where}.valve: full_opening ({full:g} m) must be larger than "
                    f"overlap_{edge} ({overlap:g} m)"
                )
        return
    for side in ("a", "b"):
        overlap, full = (rig.value(f"{where}.valve.{name}_{side}") for name in ("overlap", "full_opening"))
        if not overlap < full:
            raise InputError(
                f"{rig.path}: {where}.valve: full_opening_{side} ({full:g} m) must be larger than "
                f"overlap_{side} ({overlap:g} m)"
            )
