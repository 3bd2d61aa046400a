"""Equation (4.4): voltage to coil current."""

import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics.amplifier import coil_currents

AMPLIFIER = {
    "amplifier.min_current": 0.13,
    "amplifier.max_current_a": 1.1,
    "amplifier.max_current_b": 0.7,
}


@pytest.mark.parametrize(
    ("voltage", "expected"),
    [
        (0.0, (0.13, 0.13)),
        (3.7, (3.7 * (1.1 - 0.13) / 10 + 0.13, 0.13)),
        (-6.1, (0.13, 6.1 * (0.7 - 0.13) / 10 + 0.13)),
        (10.0, (1.1, 0.13)),
        (13.0, (1.1, 0.13)),
        (-25.0, (0.13, 0.7)),
    ],
)
def test_currents_are_equation_4_4_between_and_at_its_limits(bench_joint, voltage, expected):
    assert_allclose(coil_currents(voltage, 5.0, bench_joint(AMPLIFIER)), expected, rtol=1e-14)


def test_without_an_amplifier_the_voltage_goes_on_split_by_its_sign(slide_joint):
    assert coil_currents(3.3, 0.0, slide_joint()) == (3.3, 0.0)
    assert coil_currents(-2.1, 0.0, slide_joint()) == (0.0, 2.1)
