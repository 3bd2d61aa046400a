"""Units in which an angle is left out: Pint takes 1 for a radian, so that 1450 1/min would be 24 rad/s."""

import math

import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.units import si_factor
from hydrolek_drake.wizard.questions import read_answers


@pytest.mark.parametrize(
    ("unit", "si"),
    [("1/min", "rad/s"), ("Hz", "rad/s"), ("cm^3", "m^3/rad"), ("mm/rev", "m"), ("cm^3/rev", "m^3")],
)
def test_a_unit_without_its_angle_or_with_one_too_many_is_refused(unit, si):
    with pytest.raises(InputError, match="angle"):
        si_factor(unit, si)


@pytest.mark.parametrize(
    ("unit", "si", "factor"),
    [
        ("rpm", "rad/s", math.pi / 30.0),
        ("deg/s", "rad/s", math.pi / 180.0),
        ("deg_per_s", "rad/s", math.pi / 180.0),
        ("cm^3/rev", "m^3/rad", 1e-6 / (2.0 * math.pi)),
        ("mrad", "rad", 1e-3),
        ("kg cm^2", "kg m^2", 1e-4),
        ("N m", "N m/rad", 1.0),
        ("1/min", "1/s", 1.0 / 60.0),
    ],
)
def test_units_that_say_it_are_converted(unit, si, factor):
    assert si_factor(unit, si) == pytest.approx(factor)


def test_a_data_sheet_s_frequencies_are_cycles_and_a_lead_is_a_way_a_turn():
    answers = read_answers({"--bandwidth": "0.03 kHz", "--lead": "5 mm/rev", "--pump-speed": "1450 rpm"})
    assert answers["bandwidth"] == pytest.approx(2.0 * math.pi * 30.0)
    assert answers["lead"] == pytest.approx(5e-3)
    assert answers["pump_speed"] == pytest.approx(1450.0 * math.pi / 30.0)
    for option, text in (("--pump-speed", "1450 1/min"), ("--displacement", "10 cm^3")):
        with pytest.raises(InputError, match="angle"):
            read_answers({option: text})


def test_a_setting_without_its_angle_is_refused():
    with pytest.raises(InputError, match="rpm"):
        load_rig("hopsan_link", {"supply.speed": "24 Hz"})
