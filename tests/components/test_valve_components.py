"""Tables of edges, flow maps, load holding, pump control, slow servo valves and pulsed coils, beside closed forms."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics.amplifier import pulsed_current
from hydrolek_drake.physics.fluid import orifice_conductance
from hydrolek_drake.physics.linkage import stroke_and_lever
from hydrolek_drake.physics.solenoid import advance
from hydrolek_drake.physics.valve import chamber_flows
from hydrolek_drake.physics.valves.load_holding import held_back, opened_share
from hydrolek_drake.physics.valves.opening_table import tabled
from hydrolek_drake.physics.valves.openings import openings
from hydrolek_drake.rollout import roll_out

P_S, P_T = 16e6, 0.2e6


def test_an_edge_opens_along_its_table_and_without_one_on_a_straight_line():
    travelled = np.linspace(0.0, 1.0, 41)
    found = [tabled(u, 0.05, 0.2, 0.5) for u in travelled]
    assert_allclose(found, np.interp(travelled, np.linspace(0, 1, 5), [0, 0.05, 0.2, 0.5, 1]), atol=1e-15)
    assert_allclose([tabled(u, 0.25, 0.5, 0.75) for u in travelled], travelled, atol=1e-15)


def test_each_edge_has_a_table_of_its_own(with_component):
    joint = with_component("notched_edges").records()[0]
    opened = openings(0.06e-3 + 0.5 * 0.29e-3, joint)  # half of the travel of P-A
    rounding = 0.005e-3
    beyond = (np.hypot(0.5 * 0.29e-3, rounding) - rounding) / 0.29e-3
    assert_allclose(opened.pa, np.interp(beyond, [0.25, 0.5], [0.05, 0.2]), rtol=1e-12)
    beyond = (np.hypot(0.06e-3 + 0.5 * 0.29e-3 - 0.05e-3, rounding) - rounding) / 0.30e-3
    assert_allclose(opened.bt, np.interp(beyond, [0.5, 0.75], [0.3, 0.6]), rtol=1e-12)
    assert (opened.at, opened.pb) == (0.0, 0.0)


@pytest.mark.parametrize(("percent", "flow_l_min"), [(20, 0.05), (40, 0.14), (60, 0.3), (100, 0.7)])
@pytest.mark.parametrize(("drop_bar", "factor"), [(5, 1.0), (35, 7**0.5), (100, 0.9 * 20**0.5)])
def test_a_flow_map_gives_what_was_measured(with_component, percent, flow_l_min, drop_bar, factor):
    rig = with_component("flow_map").with_values({"fluid.laminar_transition": 1.0})
    joint = rig.records()[0]
    x = 0.06e-3 + percent / 100 * (0.35e-3 - 0.06e-3)
    p_a = P_S - 1e5 * drop_bar
    flow_a, flow_b, drawn, _, _ = chamber_flows(
        openings(x, joint), P_S, p_a, P_T + 1e5 * drop_bar, 0.0, joint
    )
    assert_allclose([flow_a, -flow_b, drawn], np.full(3, flow_l_min * factor / 6e4), rtol=1e-6)


def test_between_its_columns_a_flow_map_is_straight_over_the_root_of_the_drop(with_component):
    joint = with_component("flow_map").with_values({"fluid.laminar_transition": 1.0}).records()[0]
    opened = openings(0.35e-3, joint)
    roots = np.sqrt(1e5 * np.array([1.0, 5.0, 20.0, 35.0, 60.0, 100.0, 150.0]))
    flows = [chamber_flows(opened, P_S, P_S - r * r, P_T, 0.0, joint)[2] for r in roots]
    known = 0.7 / 6e4 * np.array([0.0, 1.0, 7**0.5, 0.9 * 20**0.5])
    places = np.sqrt(1e5 * np.array([0.0, 5.0, 35.0, 100.0]))
    assert_allclose(flows[:-1], np.interp(roots[:-1], places, known), rtol=1e-6)
    slope = (known[3] - known[2]) / (places[3] - places[2])
    assert_allclose(flows[-1], known[3] + slope * (roots[-1] - places[3]), rtol=1e-6)


@pytest.mark.parametrize(
    ("name", "load", "pilot", "share"),
    [
        ("counterbalance", 12e6, 0.2e6, 0.0),
        ("counterbalance", 20e6, 0.0, 0.0),  # cracks
        ("counterbalance", 22e6, 0.0, 0.5),
        ("counterbalance", 10e6, 4e6, 0.5),
        ("counterbalance", 10e6, 9e6, 1.0),
        ("pilot_check", 10e6, 0.2e6, 0.0),
        ("pilot_check", 10e6, (10e6 - P_T + 0.2e6) / 4, 0.0),
        ("pilot_check", 10e6, (10e6 - P_T + 2.2e6) / 4, 0.5),
        ("pilot_check", 10e6, 9e6, 1.0),
    ],
)
def test_a_holding_valve_opens_by_load_and_pilot(with_component, name, load, pilot, share):
    assert_allclose(
        opened_share(load, P_T, pilot, with_component(name).records()[0]), share, rtol=1e-9, atol=1e-9
    )


def test_an_edge_and_its_open_holding_valve_share_the_pressure_drop(with_component):
    joint = with_component("counterbalance").with_values({"fluid.laminar_transition": 1.0}).records()[0]
    edge, load = orifice_conductance(0.6e-6, 10e6 - P_T, 0.7, joint), 10e6
    flow = held_back(edge, load, P_T, 9e6, 1.0, joint) * (load - P_T)
    drop = lambda area: 870 / 2 * (flow / (0.7 * area)) ** 2  # noqa: E731
    assert_allclose(drop(0.6e-6) + drop(2e-6), load - P_T, rtol=1e-6)
    assert held_back(edge, P_T, load, 0.0, 1.0, joint) == edge  # towards the actuator
    assert held_back(edge, load, P_T, 0.0, 0.0, joint) == edge  # a port without one


@pytest.mark.parametrize("name", ["counterbalance", "pilot_check"])
def test_a_load_sinks_through_a_leaking_spool_unless_it_is_held(with_component, name):
    leak = {"effects.valve.null_leakage.conductance_m3_per_s_Pa": 2e-13}
    times = np.arange(0.0, 10.0, 0.01)
    ends = {}
    for held in (1.0, 0.0):
        rig = with_component(name).with_values(
            {**leak, "holding.at_a": held, "holding.at_b": 1.0 - held, "supply.pressure": 0.5e6}
        )
        signals = roll_out(rig.records(), times, np.zeros(times.size), times, longest_step=8e-4).signals
        ends[held] = math.degrees(signals.position[-1] - signals.position[0])
    assert ends[0.0] < -1.0
    assert abs(ends[1.0]) < 0.1 * abs(ends[0.0])


def test_a_pump_moves_the_rod_by_its_flow_and_the_charge_line_takes_the_rest(with_component):
    rig = with_component("pump_controlled").with_values(
        {"valve.cross_leakage": 0.0, "valve.case_leakage": 0.0}
    )
    times = np.arange(0.0, 2.0, 0.01)
    signals = roll_out(rig.records(), times, np.full(times.size, 2.0), times, longest_step=4e-4).signals
    later = times > 1.0
    assert_allclose(
        signals.pressure_b[later], 1.5e6, atol=0.8e6
    )  # the lower side stays near the charge pressure
    joint = rig.records()[0]
    strokes = np.array([stroke_and_lever(q, joint)[0] for q in signals.position])
    speed = np.gradient(strokes, times)[later].mean()
    assert_allclose(speed, 0.2 * 6 / 6e4 / 800e-6, rtol=0.01)


def test_flows_of_a_pump_balance_with_its_charge_line_and_leakage(with_component):
    joint = with_component("pump_controlled").records()[0]
    a, b, drawn, _, _ = chamber_flows(openings(4e-3, joint), P_S, 9e6, 1.2e6, 0.0, joint)
    assert_allclose(a, 0.4 * 6 / 6e4 - 2e-13 * 7.8e6 - 1e-13 * (9e6 - P_T), rtol=1e-9)
    charged = 5e-11 * (1.5e6 - 1.2e6)
    assert_allclose(b, -0.4 * 6 / 6e4 + 2e-13 * 7.8e6 - 1e-13 * (1.2e6 - P_T) + charged, rtol=1e-9)
    assert drawn == 0.0


def test_a_pump_s_check_and_relief_valves_hold_its_sides_between_their_pressures(with_component):
    rig = with_component("pump_controlled").with_values(
        {"valve.relief_pressure": 20e6, "valve.relief_conductance": 1e-10, "valve.cross_leakage": 0.0}
    )
    joint = rig.records()[0]
    rest = openings(0.0, joint)
    low_a, low_b, *_ = chamber_flows(rest, P_S, 0.5e6, 0.9e6, 0.0, joint)  # both below the charge pressure
    assert_allclose(low_a, 5e-11 * (1.5e6 - 0.5e6) - 1e-13 * (0.5e6 - P_T), rtol=1e-9)
    assert_allclose(low_b, 5e-11 * (1.5e6 - 0.9e6) - 1e-13 * (0.9e6 - P_T), rtol=1e-9)
    high_a, high_b, *_ = chamber_flows(rest, P_S, 22e6, 1.5e6, 0.0, joint)
    assert_allclose(high_a, -1e-10 * 2e6 - 1e-13 * (22e6 - P_T), rtol=1e-9)
    assert_allclose(high_b, 1e-10 * 2e6 - 1e-13 * (1.5e6 - P_T), rtol=1e-9)


def test_a_pump_controlled_machine_starts_with_its_lower_side_at_the_charge_pressure(with_component):
    rig = with_component("pump_controlled").with_values(
        {"valve.cross_leakage": 0.0, "valve.case_leakage": 0.0}
    )
    times = np.arange(0.0, 0.5, 0.01)
    signals = roll_out(rig.records(), times, np.zeros(times.size), times, longest_step=4e-4).signals
    assert_allclose(signals.pressure_b[0], 1.5e6)
    assert abs(math.degrees(np.ptp(signals.position))) < 0.05


def test_a_slow_servo_valve_takes_its_time_for_a_large_step_and_not_for_a_small_one(with_component):
    rig = with_component("slow_servo")
    slow, quick = rig.records()[0], rig.with_values({"solenoid.slew_rate": 0.0}).records()[0]

    def reached(joint, volts, seconds, h=2e-4):
        x = v = fastest = 0.0
        for _ in range(round(seconds / h)):
            x, v = advance(x, v, max(volts, 0.0), max(-volts, 0.0), h, 1, joint)
            fastest = max(fastest, abs(v))
        return x, fastest

    x, fastest = reached(slow, -10.0, 0.1)
    assert fastest <= 3e-3 * (1 + 1e-12)
    assert_allclose(x, -3e-3 * 0.1, rtol=0.04)  # less what it takes to get up to speed
    assert_allclose(reached(slow, -10.0, 1.0)[0], -0.5e-3, rtol=1e-3)
    small = 0.1  # V: its loop never asks for more than the limit
    assert_allclose(reached(slow, small, 0.01)[0], reached(quick, small, 0.01)[0], rtol=1e-3)


@pytest.mark.parametrize("duty", [0.2, 0.5, 0.8])
def test_a_pulsed_coil_has_the_root_mean_square_of_its_current(with_component, duty):
    joint = with_component("pulse_width").records()[0]
    period, steps = 1 / 200, 2000
    current, squares = duty * 24 / 20, []
    for pulse in range(60):
        for n in range(steps):
            driven = 24 / 20 if n < duty * steps else 0.0
            current += (driven - current) * (period / steps) / 20e-3
            if pulse >= 50:
                squares.append(current * current)
    # the straight lines of the closed form against exponentials of a quarter of a time constant
    assert_allclose(pulsed_current(duty, joint), math.sqrt(np.mean(squares)), rtol=2e-3)
