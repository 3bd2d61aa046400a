"""The supply: constant pressure, or falling with the flow drawn; a pump with its relief valve and line."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from hydrolek_drake.physics.relief_valve import (
    relieved,
    relieved_by_valve,
    relieved_with_lag,
    relieved_with_play,
)
from hydrolek_drake.physics.supply import at_rest, at_start, rate_of_change, supply_pressure


def test_supply_holds_its_pressure_whatever_is_drawn(bench_joint):
    assert supply_pressure(3.7e-5, bench_joint()) == 16e6


def test_supply_with_droop_loses_resistance_times_flow_but_not_below_the_tank(bench_joint):
    joint = bench_joint({"effects.supply.pressure_droop.resistance_Pa_s_per_m3": 6e10})
    assert_allclose(supply_pressure(3.7e-5, joint), 16e6 - 6e10 * 3.7e-5, rtol=1e-14)
    assert supply_pressure(1.0, joint) == 0.2e6


def test_the_flow_that_the_supply_feels_is_low_passed(bench_joint):
    rate, slope = rate_of_change(1.3e-5, 1.3e-5, 4.1e-5, bench_joint())
    assert_allclose(rate, (4.1e-5 - 1.3e-5) / 0.02, rtol=1e-14)
    assert slope == 0.0


PUMP = {
    "supply.pressure": 12e6,
    "supply.displacement": 3e-5,
    "supply.speed": 157.0,
    "supply.relief_slope": 1e8,
    "supply.line_volume": 1e-3,
    "supply.pump_leakage": 0.0,
    "supply.relief_time": 0.0,
    "supply.initial_pressure": 0.0,
    "fluid.bulk_modulus": 1e9,
}


def test_an_idle_pump_lets_all_off_at_the_setting_and_what_its_slope_adds(link_joint):
    joint = link_joint(PUMP)
    above = at_rest(joint)
    assert_allclose(supply_pressure(above, joint), 12e6 + 1e8 * 3e-5 * 157.0, rtol=1e-12)
    rate, slope = rate_of_change(above, above, 0.0, joint)
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
    rate, _ = rate_of_change(-4e6, 0.0, 1e-3, joint)
    assert_allclose(rate, 1e9 / 1e-3 * (0.7 * 3e-5 * 157.0 - 1e-3), rtol=1e-12)


def test_a_line_does_not_fall_below_the_tank(link_joint):
    joint = link_joint(PUMP)
    assert supply_pressure(-13e6, joint) == joint["supply"]["tank_pressure"]
    assert rate_of_change(-11.9e6, 0.0, 1.0, joint)[0] == 0.0


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


def test_a_valve_that_is_held_lets_off_as_an_orifice_does(link_joint):
    """Where the play holds it at b, b/R at its own pressure and with the root of the drop at another one."""
    joint = link_joint(PUMP)
    held, above, tank = 3e5, 1.5e5, joint["supply"]["tank_pressure"]
    rate, slope = rate_of_change(above, held, 0.0, joint)
    let_off = held / 1e8 * np.sqrt((12e6 + above - tank) / (12e6 + held - tank))
    assert_allclose(rate + slope * held, 1e9 / 1e-3 * (3e-5 * 157.0 - let_off), rtol=1e-12)
    rate, slope = rate_of_change(tank - 12e6, held, 1.0, joint)  # an empty line
    assert_allclose(rate + slope * held, 0.0, atol=1e-3)


LAG, SLOPE = 0.01, -5e3


def test_a_valve_with_a_lag_rings_as_its_linear_equation_does(link_joint):
    """Without hysteresis u'' + u'/T - slope/T u = 0 about the balance: w^2 = -slope/T - 1/(4 T^2), damping 1/(2 T)."""
    joint = link_joint({**PUMP, "supply.relief_time": LAG, "supply.relief_hysteresis": 0.0})
    balance, off, h, steps = 8e5, 1e5, 2.5e-4, 160
    u, b, found = balance + off, balance, []
    for _ in range(steps):
        u, b = relieved_with_lag(u, b, -SLOPE * balance, SLOPE, h, joint)
        found.append((u, b))
    time = h * np.arange(1, steps + 1)
    w, fading = np.sqrt(-SLOPE / LAG - 0.25 / LAG**2), 0.5 / LAG
    shrinks = np.exp(-fading * time)
    expected_u = balance + off * shrinks * (np.cos(w * time) + fading / w * np.sin(w * time))
    expected_b = balance + off * shrinks * np.sin(w * time) / (LAG * w)
    assert_allclose(found, np.stack([expected_u, expected_b], axis=1), atol=5e-3 * off)


def test_a_valve_with_a_short_lag_is_one_without(link_joint):
    sheet = {**PUMP, "supply.relief_hysteresis": 4e5}
    quick, at_once = link_joint({**sheet, "supply.relief_time": 1e-6}), link_joint(sheet)
    for rate in (5e9, -2e9):
        found = relieved_by_valve(1e5, 2e5, rate, -1e4, 5e-4, quick)
        assert_allclose(found, relieved_by_valve(1e5, 2e5, rate, -1e4, 5e-4, at_once), atol=2e4)


@pytest.mark.parametrize("hysteresis", [0.0, 4e5])
@pytest.mark.parametrize("valve", [0.0, 1e5, 6e5])
@pytest.mark.parametrize("within", [-1.7, -0.6, 0.4, 1.5])
@pytest.mark.parametrize("rate", [-1e9, 1e8, 2e9])
def test_a_step_with_a_lag_is_many_small_ones_of_its_equation(link_joint, rate, within, valve, hysteresis):
    """du/dt = rate + c b, T db/dt = the nearer edge of the play - b, b on its seat at zero: a step of 0.25 ms."""
    joint = link_joint({**PUMP, "supply.relief_time": LAG, "supply.relief_hysteresis": hysteresis})
    half, h, parts = 0.5 * hysteresis, 2.5e-4, 20_000
    above = valve + within * 2e5
    found = relieved_with_lag(above, valve, rate, SLOPE, h, joint)
    u, b = above, valve
    for _ in range(parts):
        drawn = min(max(b, u - half), u + half)
        u, b = u + h / parts * (rate + SLOPE * b), max(b + h / parts * (drawn - b) / LAG, 0.0)
    assert_allclose(found, (u, b), atol=0.02 * 4e5)


def test_a_line_starts_at_rest_or_as_the_rig_says(link_joint):
    rest = at_rest(link_joint(PUMP))
    assert at_start(link_joint(PUMP)) == (rest, rest)
    joint = link_joint({**PUMP, "supply.initial_pressure": 11.8e6, "supply.initial_relief": 0.25})
    assert_allclose(at_start(joint), (-2e5, 0.25 * rest), rtol=1e-12)


def test_a_relief_valve_that_rests_at_an_edge_of_its_play_stays_there(link_joint):
    """Rounding leaves it a hair's breadth on either side of it, with as little of a rate."""
    joint = link_joint({**PUMP, "supply.relief_hysteresis": 2.4e5, "supply.relief_time": 5e-3})
    rng = np.random.default_rng(4)
    eps = np.finfo(float).eps
    for _ in range(20_000):
        valve, slope = rng.uniform(2e5, 4e5), -rng.uniform(50.0, 5000.0)
        rate = -slope * valve * (1.0 + rng.integers(-3, 4) * eps)
        above = (valve + rng.choice([-1.2e5, 1.2e5])) * (1.0 + rng.integers(-3, 4) * eps)
        pressure, place = relieved_with_lag(above, valve, rate, slope, 2.5e-4, joint)
        assert abs(pressure - above) < 1e-6
        assert abs(place - valve) < 1e-6
