"""Checks of a rig's linkages."""

import math

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.cylinder import ELECTRIC
from hydrolek_drake.physics.linkages import four_bar, lever_table
from hydrolek_drake.rigs.checks.checked import Checked


def check(rig: Checked, where: str, lower: float, upper: float) -> None:
    """Refuse a linkage that cannot be put together between the load's stops.

    Raises:
        InputError: an impossible triangle or mechanism, a table without angles or a lever that changes its sign.
    """
    variant = rig.variants[f"{where}.linkage"]
    motor = rig.variants[f"{where}.cylinder"]
    if motor in ELECTRIC and variant != "direct":
        raise InputError(
            f"{rig.path}: {where}.linkage: a '{motor}' moves its axis directly, not by a '{variant}'; use "
            "variant: direct"
        )
    if variant == "four_bar":
        _check_four_bar(rig, where, lower, upper)
    elif variant == "lever_table":
        _check_table(rig, where, lower, upper)
    elif variant == "triangle":
        _check_triangle(rig, where, lower, upper)


def _check_four_bar(rig: Checked, where: str, lower: float, upper: float) -> None:
    link, ground, coupler, crank, angle, way = (
        rig.value(f"{where}.linkage.{name}")
        for name in ("link_arm", "ground", "coupler", "crank_arm", "link_angle", "direction")
    )
    first, last = sorted((way * max(lower, -math.pi) + angle, way * min(upper, math.pi) + angle))
    # the link's pin is nearest to the crank's axis at 0 and farthest at 180 deg from it
    between = [k * math.pi for k in range(math.ceil(first / math.pi), math.floor(last / math.pi) + 1)]
    for turned in (first, last, *between):
        if not four_bar.closes(link, ground, coupler, crank, turned):
            position = way * (turned - angle)
            raise InputError(
                f"{rig.path}: {where}.linkage: impossible mechanism, at {math.degrees(position):.1f} deg the "
                f"coupler of {coupler:g} m and the crank of {crank:g} m do not reach the link's pin; check lengths and "
                "link_angle"
            )


def _check_table(rig: Checked, where: str, lower: float, upper: float) -> None:
    first, last = (rig.value(f"{where}.linkage.{name}_position") for name in ("first", "last"))
    if not first < last:
        raise InputError(
            f"{rig.path}: {where}.linkage: first_position {first:g} must lie below last_position {last:g}"
        )
    for name, stop, outside in (
        ("lower_stop", lower, lower < first),
        ("upper_stop", upper, upper > last),
    ):
        if outside:
            raise InputError(
                f"{rig.path}: {where}.linkage: the table goes from {first:g} to {last:g} rad, {name} is at {stop:g}; "
                "give levers for all of the way"
            )
    levers = [rig.value(f"{where}.linkage.lever_{knot}") for knot in range(lever_table.KNOTS)]
    if not (min(levers) > 0.0 or max(levers) < 0.0):
        raise InputError(
            f"{rig.path}: {where}.linkage: levers from {min(levers):g} to {max(levers):g} m/rad change their sign; a "
            "cylinder in its dead centre moves nothing"
        )


def _check_triangle(rig: Checked, where: str, lower: float, upper: float) -> None:
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
