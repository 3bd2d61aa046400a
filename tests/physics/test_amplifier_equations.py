"""Equation (4.4): voltage to coil current."""

import math

import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics.amplifier import Currents, coil_currents, following

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


def test_a_coil_s_current_rises_as_inductance_and_resistance_let_it(bench_joint):
    """i = i_driven + (i_0 - i_driven) exp(-t R/L), and its mean."""
    joint = bench_joint({**AMPLIFIER, "amplifier.coil_time": 0.03})
    before = Currents(0.2, 0.6)
    now, mean = following(before, 10.0, 0.0, 0.05, 0.01, joint)
    left = math.exp(-0.05 / 0.04)
    for side, driven in (("a", 1.1), ("b", 0.13)):
        began = getattr(before, side)
        assert_allclose(getattr(now, side), driven + (began - driven) * left, rtol=1e-13)
        assert_allclose(getattr(mean, side), driven + (began - driven) * 0.04 / 0.05 * (1 - left), rtol=1e-13)


def test_a_coil_in_many_steps_is_the_coil_in_one(bench_joint):
    joint = bench_joint({**AMPLIFIER, "amplifier.coil_time": 0.03})
    now, means = Currents(0.2, 0.6), []
    for _ in range(9):
        now, mean = following(now, -4.0, 0.0, 0.01, 0.0, joint)
        means.append(mean)
    ended, over_all = following(Currents(0.2, 0.6), -4.0, 0.0, 0.09, 0.0, joint)
    assert_allclose(now, ended, rtol=1e-13)
    assert_allclose((sum(m.a for m in means) / 9, sum(m.b for m in means) / 9), over_all, rtol=1e-13)


def test_a_coil_without_inductance_has_its_current_at_once(bench_joint):
    joint = bench_joint(AMPLIFIER)
    now, mean = following(Currents(0.2, 0.6), 3.7, 5.0, 1e-4, 0.0, joint)
    assert now == mean == coil_currents(3.7, 5.0, joint)
