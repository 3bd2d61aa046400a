"""The supply: constant pressure, or falling with the flow drawn; a pump with its relief valve and line."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from hydrolek_drake.physics.supply import (
    at_rest,
    rate_of_change,
    relieved,
    relieved_with_play,
    supply_pressure,
)


def test_supply_holds_its_pressure_whatever_is_drawn(bench_joint):
    assert supply_pressure(3.7e-5, bench_joint()) == 16e6


def test_supply_with_droop_loses_resistance_times_flow_but_not_below_the_tank(bench_joint):
    joint = bench_joint({"effects.supply.pressure_droop.resistance_Pa_s_per_m3": 6e10})
    assert_allclose(supply_pressure(3.7e-5, joint), 16e6 - 6e10 * 3.7e-5, rtol=1e-14)
    assert supply_pressure(1.0, joint) == 0.2e6


def test_the_flow_that_the_supply_feels_is_low_passed(bench_joint):
    rate, slope = rate_of_change(1.3e-5, 4.1e-5, bench_joint())
    assert_allclose(rate, (4.1e-5 - 1.3e-5) / 0.02, rtol=1e-14)
    assert slope == 0.0


PUMP = {
    "supply.pressure": 12e6,
    "supply.displacement": 3e-5,
    "supply.speed": 157.0,
    "supply.relief_slope": 1e8,
    "supply.line_volume": 1e-3,
    "fluid.bulk_modulus": 1e9,
}


def test_an_idle_pump_lets_all_off_at_the_setting_and_what_its_slope_adds(link_joint):
    joint = link_joint(PUMP)
    above = at_rest(joint)
    assert_allclose(supply_pressure(above, joint), 12e6 + 1e8 * 3e-5 * 157.0, rtol=1e-12)
    rate, slope = rate_of_change(above, 0.0, joint)
    assert_allclose(rate + slope * above, 0.0, atol=1e-9 * rate)


def test_a_pump_that_leaks_rests_where_it_gives_what_is_let_off(link_joint):
    leak = 5e-11
    joint = link_joint({**PUMP, "supply.pump_leakage": leak})
    above = at_rest(joint)
    assert_allclose(3e-5 * 157.0 - leak * (12e6 + above), above / 1e8, rtol=1e-12)
    weak = link_joint({**PUMP, "supply.pump_leakage": 1e-9})
    assert_allclose(supply_pressure(at_rest(weak), weak), 3e-5 * 157.0 / 1e-9, rtol=1e-12)


def test_a_line_fills_with_what_the_pump_gives_and_nobody_draws(link_joint):
    joint = link_joint({**PUMP, "effects.supply.pump_loss.fraction": 0.3})
    rate, _ = rate_of_change(-4e6, 1e-3, joint)
    assert_allclose(rate, 1e9 / 1e-3 * (0.7 * 3e-5 * 157.0 - 1e-3), rtol=1e-12)


def test_a_line_does_not_fall_below_the_tank(link_joint):
    joint = link_joint(PUMP)
    assert supply_pressure(-13e6, joint) == joint["supply"]["tank_pressure"]
    assert rate_of_change(-11.9e6, 1.0, joint)[0] == 0.0


@pytest.mark.parametrize("h", [1e-5, 5e-4, 5e-3])
@pytest.mark.parametrize("slope", [-20.0, -1e3, -1e4])
@pytest.mark.parametrize("rate", [-7e9, -3e8, 0.0, 2e8, 5e9])
@pytest.mark.parametrize("above", [-3e6, -4e5, 0.0, 2e5, 6e5])
def test_a_step_of_a_relieved_line_is_the_solution_of_its_equation(above, rate, slope, h):
    """Also where the valve opens or closes within the step."""
    scale = 1e6
    found = solve_ivp(
        lambda _, u: rate / scale + slope * np.maximum(u, 0.0),
        (0.0, h),
        [above / scale],
        method="LSODA",
        rtol=1e-10,
        atol=1e-11,
        max_step=h / 100,
    )
    assert_allclose(relieved(above, rate, slope, h), scale * found.y[0, -1], rtol=1e-6, atol=10.0)


def test_without_hysteresis_the_valve_stands_where_the_pressure_is(link_joint):
    joint = link_joint({**PUMP, "supply.relief_hysteresis": 0.0})
    found = relieved_with_play(-1e5, -1e5, 2e9, -1e4, 5e-4, joint)
    assert found == (relieved(-1e5, 2e9, -1e4, 5e-4),) * 2


@pytest.mark.parametrize("rate", [-2e9, -1e8, 1e8, 5e9])
@pytest.mark.parametrize("valve", [-3e5, 0.0, 1e5])
@pytest.mark.parametrize("within", [-1.0, -0.3, 0.0, 1.0])
def test_a_valve_that_sticks_follows_behind_half_of_its_hysteresis(link_joint, rate, valve, within):
    """Against many small steps of the play itself: b between u - H/2 and u + H/2, du/dt = rate - c max(b, 0)."""
    hysteresis, slope, h, parts = 4e5, -1e4, 5e-4, 100_000
    joint = link_joint({**PUMP, "supply.relief_hysteresis": hysteresis})
    above = valve + within * 0.5 * hysteresis
    found = relieved_with_play(above, valve, rate, slope, h, joint)
    u, b = above, valve
    for _ in range(parts):
        u += h / parts * (rate + slope * max(b, 0.0))
        b = min(max(b, u - 0.5 * hysteresis), u + 0.5 * hysteresis)
    assert_allclose(found, (u, b), atol=2e-3 * hysteresis)
