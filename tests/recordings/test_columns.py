import math

import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.columns import QUANTITIES, check_mapping, column_name, parse_column


@pytest.mark.parametrize(
    ("name", "key", "factor", "unit"),
    [
        ("time_s", "time", 1.0, "s"),
        ("time_ms", "time", 1e-3, "s"),
        ("time_min", "time", 60.0, "s"),
        ("right_j2.command_V", "right_j2.command", 1.0, "V"),
        ("joint.command_mA", "joint.command", 1e-3, "A"),
        ("valve.command_percent", "valve.command", 0.01, "1"),
        ("joint.angle_deg", "joint.angle", math.pi / 180, "rad"),
        ("joint.pressure_a_Pa", "joint.pressure_a", 1.0, "Pa"),
        ("cylinder.pressure_a_MPa", "cylinder.pressure_a", 1e6, "Pa"),
        ("cylinder.pressure_b_bar", "cylinder.pressure_b", 1e5, "Pa"),
        ("supply.pressure_bar", "supply.pressure", 1e5, "Pa"),
        ("x.rate_deg_per_s", "x.rate", math.pi / 180, "rad/s"),
        ("x.rate_rpm", "x.rate", 2 * math.pi / 60, "rad/s"),
        ("axis.velocity_mm_per_s", "axis.velocity", 1e-3, "m/s"),
        ("right_j2.pot_mV", "right_j2.pot", 1e-3, "V"),
        ("axis.position_mm", "axis.position", 1e-3, "m"),
        ("axis.force_kN", "axis.force", 1e3, "N"),
        ("j.effort_Nm", "j.effort", 1.0, "N m"),
        ("j.reference_deg", "j.reference", math.pi / 180, "rad"),
        ("j.reference_mm", "j.reference", 1e-3, "m"),
        ("valve.current_mA", "valve.current", 1e-3, "A"),
    ],
)
def test_name_gives_key_and_factor(name, key, factor, unit):
    understood = parse_column(name)
    assert (understood.key, understood.unit) == (key, unit)
    assert understood.factor == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize(
    "name",
    [
        "",
        "time",
        "time_of_day",
        "command_V",
        "U1_V",
        "joint.temperature_degC",
        "a.b.angle_deg",
        "/t/j.angle_rad",
    ],
)
def test_other_names_are_no_signals(name):
    assert parse_column(name) is None


@pytest.mark.parametrize(
    "name",
    [
        "joint.angle",  # no unit
        "joint.pressure_a",  # no unit, and not a pressure in years
        "joint.angle_mm",
        "joint.angle_percent",  # dimensionless like an angle, yet none
        "joint.rate_Hz",  # 1/s like an angular rate, yet none
        "joint.angle_furlong",
        "joint.position_deg",
        "joint.pressure_barg",
        "joint.command_deg",
        "joint.current_",
    ],
)
def test_wrong_units_are_refused_with_an_example(name):
    with pytest.raises(InputError, match=r"write for example joint") as refusal:
        parse_column(name)
    assert name in str(refusal.value)


@pytest.mark.parametrize(
    ("quantity", "unit"), [(q, unit) for q, units in QUANTITIES.items() for unit in units]
)
def test_written_name_reads_back(quantity, unit):
    assert parse_column(column_name(f"joint.{quantity}", unit)) == (f"joint.{quantity}", 1.0, unit)


def test_mapping_targets_are_checked_even_for_absent_columns():
    check_mapping({"a": "time_s", "b": "j.angle_deg", "c": "ignore"})
    with pytest.raises(InputError, match=r"'c' is mapped to 'angle'"):
        check_mapping({"c": "angle"})
    with pytest.raises(InputError, match=r"'c' is mapped to column 'j.angle_mm'"):
        check_mapping({"c": "j.angle_mm"})
