"""Numbers as an engineer writes them."""

import math

import pytest

from hydrolek_drake.diagnosis.intervals.curvature import Interval
from hydrolek_drake.diagnosis.report.words import quantity, with_interval
from hydrolek_drake.replay.display import ratio, three_digits


@pytest.mark.parametrize(
    ("value", "told"),
    [(1262.4, "1260"), (63.54, "63.5"), (0.99612, "0.996"), (999.6, "1000"), (4.56e-9, "4.56e-09")],
)
def test_three_digits_and_no_exponent_where_none_is_needed(value: float, told: str) -> None:
    assert three_digits(value) == told


@pytest.mark.parametrize(
    ("value", "told"), [(1.0, "1.00"), (0.99612, "0.996"), (26.34, "26.3"), (99.96, "100"), (1262.4, "1260")]
)
def test_ratios_keep_their_zeros(value: float, told: str) -> None:
    assert ratio(value) == told


@pytest.mark.parametrize(
    ("value", "unit", "told"),
    [
        (3000.0, "N s/m", "3000 N s/m"),
        (1e9, "Pa", "1000 MPa"),
        (math.radians(0.5), "rad|m", "0.5 deg"),
        (0.0, "1", "0"),
    ],
)
def test_a_quantity_has_the_unit_that_people_use(value: float, unit: str, told: str) -> None:
    assert quantity(value, unit) == told


@pytest.mark.parametrize(
    ("value", "low", "high", "unit", "told"),
    [
        (1.5003e-13, 1.4982e-13, 1.5024e-13, "m^3/(s Pa)", ("1.5003e-13", "1.4982e-13", "1.5024e-13")),
        (7.5668e-13, 7.281e-13, 7.853e-13, "m^3/(s Pa)", ("7.57e-13", "7.28e-13", "7.85e-13")),
        (1201.26, 1197.4, 1205.1, "N", ("1201.3", "1197.4", "1205.1")),
        (15.6123e6, 15.601e6, 15.6236e6, "Pa", ("15.612", "15.601", "15.624")),
        (0.001, 0.0, 0.003, "1", ("0.0010", "0.0000", "0.0030")),
        (9.96e-5, 9.6e-5, 10.3e-5, "1", ("9.96e-05", "9.60e-05", "10.30e-05")),
        (-0.0136, -0.0149, -0.0123, "1", ("-0.0136", "-0.0149", "-0.0123")),
        (18432.0, 12000.0, 26000.0, "N", ("18400", "12000", "26000")),
        (1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, "1", ("0.333", "0.333", "0.333")),
        (1.23456789, 1.23456788, 1.2345679, "1", ("1.234568", "1.234568", "1.234568")),
        (0.0, 0.0, 0.0, "1", ("0", "0", "0")),
    ],
)
def test_an_interval_says_how_many_digits_are_told(value, low, high, unit, told) -> None:
    found = with_interval(Interval(value, low, high), unit)
    assert tuple(text.partition(" ")[0] for text in found) == told
    assert (
        all(text.endswith(unit.replace("Pa", "MPa") if unit == "Pa" else unit) for text in found[::2])
        or unit == "1"
    )
