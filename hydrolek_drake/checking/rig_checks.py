"""What is implausible about a rig by itself: values, and what does not fit together."""

import math
from functools import cache

import numpy as np

from hydrolek_drake.checking.complaint import Complaint
from hydrolek_drake.checking.steps import step_that_agrees
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.one_point import inlet_conductance, stroke_and_lever
from hydrolek_drake.yaml_files import package_yaml

PER_TURN = 2.0 * math.pi
"""A displacement that stands per radian but was meant per turn is so much too large."""

MORE_THAN_ALL = 2.0
"""A pump that gives so many times what the wide open valve takes at its full pressure was not chosen for it."""

ENDLESS_RAD, ENDLESS_M = 600.0, 1e5
"""A stop so far away stands for none: nobody's is 100 turns off, nor a slide's so many meters, also where it was stated
in mm."""

ROUNDING = 1e-6
"""A value that a fit left at an end of its range is beyond it by no more than so much of the range."""

_OF_OIL = ("supply", "fluid")
"""Sections that an electric machine has for form's sake."""


@cache
def _plausible() -> dict[str, tuple[float, float]]:
    return {
        path: (float(a), float(b)) for path, (a, b) in package_yaml(__package__, "plausible.yaml").items()
    }


def implausible(rig: Rig) -> list[Complaint]:
    """Values far beyond what machines have, the unit with which each would be plausible beside it."""
    found = []
    electric = all(not rig.is_hydraulic(joint) for joint in rig.joints)
    for path, entry in rig.entries.items():
        stage, _, name = path.removeprefix("joints.").rpartition(".")
        limits = _plausible().get(f"{stage.rpartition('.')[2]}.{name}")
        if electric and stage.rpartition(".")[2] in _OF_OIL:
            continue
        if limits is None or entry.same_as is not None or entry.source.startswith("neutral:"):
            continue
        value = rig.value(path)
        if math.isnan(value) or limits[0] <= value <= limits[1]:
            continue
        endless = ENDLESS_RAD if entry.unit in ("rad", "deg") else ENDLESS_M
        if name in ("lower_stop", "upper_stop") and abs(value) >= endless:
            continue
        unit = rig.entries[path].unit
        scale = _that_mends(value, limits)
        mend = f"{{value: {value * scale:.4g}, unit: {unit}, ...}}" if scale else ""
        found.append(
            Complaint(
                path,
                f"{value:.4g} {unit} is far from what machines have ({limits[0]:g} to {limits[1]:g} {unit}); "
                "is the unit right?",
                f"{name}: {mend}" if mend else "",
            )
        )
    return found


def _that_mends(value: float, limits: tuple[float, float]) -> float:
    """The power of a thousand, or of ten, that brings a value between limits; 0 if none does."""
    for power in (3, 1, 2, 6):
        for scale in (10.0**-power, 10.0**power):
            if limits[0] <= value * scale <= limits[1]:
                return scale
    return 0.0


def _outside_their_ranges(rig: Rig) -> list[Complaint]:
    """Values that a fit could not begin at: it begins at the nearest end of the range."""
    found = []
    for path, entry in rig.entries.items():
        if entry.range is None or entry.same_as is not None or ".effects." in path:
            continue
        value, (low, high) = rig.value(path), entry.range
        room = ROUNDING * (high - low)
        if value < low - room or value > high + room:
            found.append(
                Complaint(
                    path,
                    f"{value:.4g} lies outside its range of {low:.4g} to {high:.4g} {entry.unit}, in which alone a fit "
                    "looks",
                    f"{path.rpartition('.')[2]}: {{value: {value:.4g}, range: [{min(value, low):.4g}, "
                    f"{max(value, high):.4g}], unit: {entry.unit}, ...}}",
                )
            )
    return found


def at_a_glance(rig: Rig) -> list[Complaint]:
    """What a rig's numbers alone tell: those far from what machines have, else those outside their own ranges."""
    return implausible(rig) or _outside_their_ranges(rig)


def check_rig(rig: Rig) -> list[Complaint]:
    """All that is implausible about a rig; nothing if it looks right."""
    rig = rig.by_itself()
    found = implausible(rig)
    if found:  # what follows would only repeat it
        return found
    for joint in rig.joints:
        found += _pump_and_valve(rig, joint)
        found += _stroke_and_stops(rig, joint)
    if len(rig.joints) == 1:
        found += _step(rig, rig.joints[0])
    told = {complaint.about for complaint in found}
    return found + [each for each in _outside_their_ranges(rig) if each.about not in told]


def _pump_and_valve(rig: Rig, joint: str) -> list[Complaint]:
    if rig.variants["supply"] != "pump" or rig.variant(joint, "valve") in ("none", "pump_controlled"):
        return []
    record = rig.records()[rig.joints.index(joint)]
    pressure = rig.value("supply.pressure")
    takes = inlet_conductance(pressure, 0.0, 0.0, record) * pressure
    gives = rig.value("supply.displacement") * rig.value("supply.speed")
    if len(rig.joints) > 1 or not takes > 0.0 or gives <= MORE_THAN_ALL * takes:
        return []
    litres = 6.0e4
    per_turn = gives / PER_TURN <= MORE_THAN_ALL * takes
    line = ""
    if per_turn:
        line = f"displacement: {{value: {1e6 * rig.value('supply.displacement'):.4g}, unit: cm^3/rev, ...}}"
    return [
        Complaint(
            "supply.displacement",
            f"the pump gives {litres * gives:.3g} l/min, {gives / takes:.2g} times what the wide open valve takes from "
            "its full pressure" + (": is the displacement meant per turn?" if per_turn else ""),
            line,
            wrong=False,
        )
    ]


def _stroke_and_stops(rig: Rig, joint: str) -> list[Complaint]:
    """Between its stops the joint should use the stroke that the cylinder has."""
    where = f"joints.{joint}"
    if rig.variant(joint, "cylinder") != "cylinder":
        return []
    record = rig.records()[rig.joints.index(joint)]
    lower, upper = (rig.value(f"{where}.load.{name}") for name in ("lower_stop", "upper_stop"))
    if not (math.isfinite(lower) and math.isfinite(upper)):
        return []
    places = [stroke_and_lever(q, record) for q in np.linspace(lower, upper, 17).tolist()]
    strokes, levers = [s for s, _ in places], [v for _, v in places]
    stroke = rig.value(f"{where}.cylinder.stroke")
    found = []
    dead = rig.value(f"{where}.cylinder.dead_volume_b") / rig.value(f"{where}.cylinder.area_b")
    if max(strokes) > stroke + dead:
        found.append(
            Complaint(
                f"{where}.load",
                f"at its stops the joint asks for {max(strokes):.4g} m of stroke, the cylinder has {stroke:.4g} m",
                f"cylinder: {{stroke: {{value: {max(strokes):.4g}, unit: m, ...}}}}",
            )
        )
    behind = rig.value(f"{where}.cylinder.dead_volume_a") / rig.value(f"{where}.cylinder.area_a")
    if min(strokes) < -behind:
        found.append(
            Complaint(
                f"{where}.linkage",
                f"between its stops the joint asks for strokes down to {min(strokes):.4g} m, {-min(strokes):.4g} m "
                "behind the piston's end",
                "",
            )
        )
    if min(levers) < 0.0 < max(levers):
        found.append(
            Complaint(
                f"{where}.linkage",
                "the lever changes its sign between the stops: the cylinder passes its dead centre",
                "",
                wrong=False,
            )
        )
    return found


def _step(rig: Rig, joint: str) -> list[Complaint]:
    stated = rig.value("integration.longest_step")
    needed = step_that_agrees(rig, joint)
    if needed == stated:
        return []
    return [
        Complaint(
            "integration.longest_step",
            f"{1e3 * stated:g} ms is too long for this machine: with finer steps the motion is different",
            f"longest_step: {{value: {1e3 * needed:g}, unit: ms, ...}}" if needed else "",
        )
    ]
