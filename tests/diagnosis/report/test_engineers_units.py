"""Sizes as gauges and data sheets have them."""

import math
from types import SimpleNamespace

import pytest

from hydrolek_drake.diagnosis.intervals.curvature import Interval
from hydrolek_drake.diagnosis.report.engineers_units import converted, in_engineers_units
from hydrolek_drake.diagnosis.report.words import unit_at
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.rigs import load_rig

LITRES_A_MINUTE = 60_000.0  # in a m^3/s


@pytest.mark.parametrize(
    ("value", "unit", "told"),
    [
        (15.2e6, "Pa", "152 bar"),
        (0.0884, "s", "88.4 ms"),
        (math.radians(3.0), "rad/min", "3 deg/min"),
        (6e10, "Pa s/m^3", "10 bar min/l"),
        (1200.0, "N", ""),
        (0.3, "1", ""),
        (0.02, "rad|m", ""),
    ],
)
def test_units_that_differ_are_converted_and_others_left_alone(value, unit, told) -> None:
    assert converted(Interval(value, value, value), unit) == told


def test_an_interval_is_converted_with_its_value() -> None:
    assert converted(Interval(15.2e6, 15.0e6, 15.4e6), "Pa") == "152.0 bar (150.0 to 154.0)"


def _size(effect_id: str, value: float) -> str:
    rig, effect = load_rig("joint_bench", {}), EFFECTS[effect_id]
    size = next(p for p in effect.parameters if p.name == effect.size)
    candidate = SimpleNamespace(effect=effect, joint="joint")
    return in_engineers_units(rig, candidate, size, Interval(value, value, value))


def test_a_leak_is_told_as_a_flow_at_the_supply_pressure_and_a_friction_as_a_pressure() -> None:
    rig = load_rig("joint_bench", {})
    pressure = rig.value("supply.pressure")
    flow, at = _size("cylinder.cross_port_leakage", 1.5e-12).split(" l/min at a pressure drop of ")
    assert float(flow) == pytest.approx(1.5e-12 * pressure * LITRES_A_MINUTE, rel=5e-3)
    assert at == f"{pressure / 1e5:g} bar"
    bar = _size("cylinder.coulomb_friction", 1200.0).removesuffix(" bar on side A")
    assert float(bar) == pytest.approx(1200.0 / rig.value("joints.joint.cylinder.area_a") / 1e5, rel=5e-3)
    assert _size("amplifier.gain_fade", 0.1) == "10 %"
    assert _size("command.delay", 0.05) == "50 ms"


@pytest.mark.parametrize(
    ("rig", "joint", "effect_id", "units"),
    [
        ("hopsan_link", "joint", "load.stribeck_friction", ["N m", "N m", "rad/s", "1"]),
        ("hopsan_link", "joint", "cylinder.stribeck_friction", ["N", "N", "m/s", "1"]),
        ("hopsan_link", "joint", "sensor.drift", ["rad/min"]),
        ("hydrolek_left_j4", "left_j4", "cylinder.coulomb_friction", ["N m"]),
        ("hydrolek_left_j4", "left_j4", "cylinder.end_cushion", ["N m s/rad", "rad"]),
        ("emps", "axis", "load.coulomb_friction", ["N"]),
        ("emps", "axis", "sensor.drift", ["m/min"]),
    ],
)
def test_what_acts_at_a_shaft_is_told_as_a_moment_and_at_a_rod_or_slide_as_a_force(
    rig, joint, effect_id, units
) -> None:
    effect = EFFECTS[effect_id]
    candidate = SimpleNamespace(effect=effect, joint=joint)
    assert [unit_at(load_rig(rig, {}), candidate, p.unit) for p in effect.parameters] == units
