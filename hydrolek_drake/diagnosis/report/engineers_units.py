"""Sizes of effects in the units of gauges and data sheets: l/min at a pressure drop, bar, mm, degrees, ms."""

from hydrolek_drake.diagnosis.intervals.curvature import Interval
from hydrolek_drake.diagnosis.report.words import unit_at, with_interval
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.replay.display import display_unit, shown
from hydrolek_drake.rigs import Rig
from hydrolek_drake.units import si_factor

_READ_AS = {
    "Pa": "bar",
    "Pa s/m^3": "bar min/l",
    "m^3/Pa": "cm^3/bar",
    "rad/min": "deg/min",
    "N m/rad": "N m/deg",
    "m/s": "mm/s",
    "rad/s": "deg/s",
    "s": "ms",
}
_CONDUCTANCE, _FLOW, _PRESSURE = "m^3/(s Pa)", "l/min", "bar"
_SHARE = "fraction"
_HYDRAULIC = ("cylinder", "vane", "hydraulic_motor")


def in_engineers_units(rig: Rig, candidate: Candidate, parameter: Parameter, known: Interval) -> str:
    """One parameter of an effect as an engineer reads it elsewhere, with its 95 % interval if that has a width.

    A conductance is told as the flow at the rig's supply pressure, a force at the rod also as the pressure on side A
    that balances it, a fraction in percent.

    Args:
        rig: that was diagnosed.
        candidate: the effect and its joint.
        parameter: of the effect.
        known: its value and interval, in SI.

    Returns:
        Empty where the unit of the sentence is the usual one.
    """
    unit = unit_at(rig, candidate, parameter.unit)
    if unit == _CONDUCTANCE:
        drop = rig.value("supply.pressure")
        at = f"at a pressure drop of {_bar(drop)}"
        return f"{_told(_times(known, drop * si_factor('m^3/s', _FLOW)), _FLOW)} {at}"
    if parameter.name.endswith(_SHARE):
        return _told(_times(known, si_factor("1", "%")), "%")
    if unit in ("N", "N m") and candidate.effect.stage == "cylinder":
        section = f"joints.{candidate.joint}.cylinder"
        if rig.variant(candidate.joint, "cylinder") not in _HYDRAULIC:
            return ""
        area = rig.value(f"{section}.area_a")
        return f"{_told(_times(known, si_factor('Pa', _PRESSURE) / area), _PRESSURE)} on side A"
    return converted(known, unit)


def converted(known: Interval, unit: str) -> str:
    """A value with its interval in the unit that engineers use; empty if that is the one in which it is told anyway.

    Args:
        known: in SI.
        unit: SI unit, alternatives behind a bar.
    """
    main = unit.partition("|")[0]
    usual = _READ_AS.get(main, "")
    if not usual or usual == display_unit(main):
        return ""
    return _told(_times(known, si_factor(main, usual)), usual)


def _told(known: Interval, unit: str) -> str:
    value, low, high = with_interval(known, unit)
    if known.low == known.high:
        return value
    return f"{value} ({low} to {high.partition(' ')[0]})"


def _times(known: Interval, factor: float) -> Interval:
    return Interval(known.value * factor, known.low * factor, known.high * factor)


def _bar(pressure: float) -> str:
    return f"{shown(pressure * si_factor('Pa', _PRESSURE), '1')} {_PRESSURE}"
