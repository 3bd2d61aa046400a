"""The supply: constant pressure, or falling with the flow drawn."""

from numpy.testing import assert_allclose

from hydrolek_drake.physics.supply import flow_rate_of_change, supply_pressure


def test_supply_holds_its_pressure_whatever_is_drawn(bench_joint):
    assert supply_pressure(3.7e-5, bench_joint()) == 16e6


def test_supply_with_droop_loses_resistance_times_flow_but_not_below_the_tank(bench_joint):
    joint = bench_joint({"effects.supply.pressure_droop.resistance_Pa_s_per_m3": 6e10})
    assert_allclose(supply_pressure(3.7e-5, joint), 16e6 - 6e10 * 3.7e-5, rtol=1e-14)
    assert supply_pressure(1.0, joint) == 0.2e6


def test_the_flow_that_the_supply_feels_is_low_passed(bench_joint):
    assert_allclose(flow_rate_of_change(1.3e-5, 4.1e-5, bench_joint()), (4.1e-5 - 1.3e-5) / 0.02, rtol=1e-14)
