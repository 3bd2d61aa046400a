"""Equations (4.7), (4.8): four edges, overlap and both directions."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics.valve import chamber_flows, flow_forces
from hydrolek_drake.physics.valves.openings import Openings, openings

P_S, P_T = 16e6, 0.2e6
UNEQUAL = {
    "valve.overlap_a": 0.05e-3,
    "valve.overlap_b": 0.08e-3,
    "valve.full_opening_a": 0.35e-3,
    "valve.full_opening_b": 0.40e-3,
    "valve.max_area_a": 0.6e-6,
    "valve.max_area_b": 0.5e-6,
}


def _open(towards_a, towards_b):
    return Openings(towards_a, towards_b, towards_b, towards_a)


def _orifice(area, drop):
    return 0.7 * area * (2 / 870) ** 0.5 * drop / (drop**2 + 0.2e6**2) ** 0.25


@pytest.mark.parametrize(
    ("x", "expected"),
    [
        (0.0, (0, 0)),
        (0.049e-3, (0, 0)),  # inside the dead-zone, both sides
        (-0.079e-3, (0, 0)),
        (0.11e-3, ((0.11 - 0.05) / 0.30, 0)),
        (-0.11e-3, (0, (0.11 - 0.08) / 0.32)),
        (0.35e-3, (1, 0)),
        (0.9e-3, (1, 0)),
        (-0.9e-3, (0, 1)),
    ],
)
def test_openings_are_zero_between_the_overlaps_and_limited_at_full_opening(bench_joint, x, expected):
    assert_allclose(openings(x, bench_joint(UNEQUAL)), _open(*expected), rtol=1e-12, atol=1e-12)


def test_a_shifted_null_moves_both_edges_and_leaves_their_slope(bench_joint):
    shift = 0.012e-3
    joint = bench_joint({**UNEQUAL, "effects.valve.asymmetric_overlap.shift_m": shift})
    assert_allclose(openings(0.11e-3, joint).pa, (0.11 - 0.062) / 0.30, rtol=1e-12)
    assert_allclose(openings(-0.11e-3, joint).pb, (0.11 - 0.068) / 0.32, rtol=1e-12)
    assert openings(0.061e-3, joint) == (0.0, 0.0, 0.0, 0.0)


def test_flows_towards_a_are_equations_4_7_and_4_8(bench_joint):
    p_a, p_b = 7.3e6, 3.1e6
    flow_a, flow_b, drawn, _, _ = chamber_flows(_open(0.4, 0.0), P_S, p_a, p_b, 0.0, bench_joint(UNEQUAL))
    assert_allclose(flow_a, _orifice(0.4 * 0.6e-6, P_S - p_a), rtol=1e-13)
    assert_allclose(flow_b, -_orifice(0.4 * 0.6e-6, p_b - P_T), rtol=1e-13)
    assert_allclose(drawn, flow_a, rtol=1e-13)


def test_flows_towards_b_are_the_same_with_the_chambers_exchanged(bench_joint):
    p_a, p_b = 7.3e6, 3.1e6
    flow_a, flow_b, drawn, _, _ = chamber_flows(_open(0.0, 0.7), P_S, p_a, p_b, 0.0, bench_joint(UNEQUAL))
    assert_allclose(flow_b, _orifice(0.7 * 0.5e-6, P_S - p_b), rtol=1e-13)
    assert_allclose(flow_a, -_orifice(0.7 * 0.5e-6, p_a - P_T), rtol=1e-13)
    assert_allclose(drawn, flow_b, rtol=1e-13)


def test_a_chamber_above_the_supply_flows_back(bench_joint):
    flow_a, _, drawn, _, _ = chamber_flows(_open(0.5, 0.0), P_S, 17.3e6, 1e6, 0.0, bench_joint(UNEQUAL))
    assert_allclose(flow_a, -_orifice(0.5 * 0.6e-6, 1.3e6), rtol=1e-13)
    assert drawn == flow_a


def test_a_closed_valve_passes_nothing(bench_joint):
    assert chamber_flows(_open(0.0, 0.0), P_S, 7.3e6, 3.1e6, 0.0, bench_joint(UNEQUAL)) == (
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    )


def test_symmetric_valve_is_symmetric(bench_joint):
    joint = bench_joint()
    towards_a = chamber_flows(_open(0.4, 0.0), P_S, 7.3e6, 3.1e6, 0.0, joint)
    towards_b = chamber_flows(_open(0.0, 0.4), P_S, 3.1e6, 7.3e6, 0.0, joint)
    assert_allclose(towards_a[:2], towards_b[1::-1], rtol=1e-14)


def test_leakage_over_the_lands_joins_each_edge_and_leakage_past_the_piston_moves_oil_across(bench_joint):
    land, past = 1.7e-13, 2.3e-12
    joint = bench_joint(
        {
            "effects.valve.null_leakage.conductance_m3_per_s_Pa": land,
            "effects.cylinder.cross_port_leakage.conductance_m3_per_s_Pa": past,
        }
    )
    p_a, p_b = 7.3e6, 3.1e6
    flow_a, flow_b, drawn, settle_a, settle_b = chamber_flows(_open(0.0, 0.0), P_S, p_a, p_b, 0.0, joint)
    assert_allclose(flow_a, land * (P_S - p_a) - land * (p_a - P_T) - past * (p_a - p_b), rtol=1e-12)
    assert_allclose(flow_b, land * (P_S - p_b) - land * (p_b - P_T) + past * (p_a - p_b), rtol=1e-12)
    assert_allclose(drawn, land * (2 * P_S - p_a - p_b), rtol=1e-12)
    assert_allclose((settle_a, settle_b), 2 * land + past, rtol=1e-12)


def test_compensated_valve_meters_in_whatever_the_load_while_its_compensator_has_pressure(crane_joint):
    full = 40e-3 / 60
    for p_a in (1e6, 5e6, 8.5e6):
        flow_a = chamber_flows(_open(0.3, 0.0), 9.3e6, p_a, 0.5e6, 0.0, crane_joint)[0]
        assert_allclose(flow_a, 0.3 * full, rtol=1e-9)


def test_compensated_valve_is_an_orifice_below_its_compensator_s_pressure_and_checks_back_flow(crane_joint):
    full = 40e-3 / 60
    flow_a = chamber_flows(_open(0.3, 0.0), 9.3e6, 9.3e6 - 0.35e6, 0.5e6, 0.0, crane_joint)[0]
    assert_allclose(flow_a, 0.3 * full * 0.5**0.5, rtol=1e-9)
    assert chamber_flows(_open(0.3, 0.0), 9.3e6, 9.9e6, 0.5e6, 0.0, crane_joint)[0] == 0.0


def test_compensated_valve_is_continuous_at_its_compensator_s_pressure(crane_joint):
    flows = [
        chamber_flows(_open(0.3, 0.0), 9.3e6, 9.3e6 - 0.7e6 + d, 0.5e6, 0.0, crane_joint)[0] for d in (-1, 1)
    ]
    assert_allclose(flows[0], flows[1], rtol=1e-5)


def test_compensated_valve_meters_out_by_its_flow_coefficient(crane_joint):
    drop = 2.3e6
    flow_b = chamber_flows(_open(0.3, 0.0), 9.3e6, 5e6, 0.1e6 + drop, 0.0, crane_joint)[1]
    assert_allclose(flow_b, -0.3 * 7.958e-7 * drop / (drop**2 + 0.02e6**2) ** 0.25, rtol=1e-12)
    assert_allclose(flow_b, -0.3 * 7.958e-7 * np.sqrt(drop), rtol=1e-4)


def test_what_a_way_back_conducts_more_flows_there_alone(bench_joint) -> None:
    joint = bench_joint(UNEQUAL)
    args = (_open(0.0, 0.4), P_S, 7.3e6, 3.1e6, 0.0, joint)
    plain, less = chamber_flows(*args), chamber_flows(*args, -0.25, 0.7)
    assert less[0] == pytest.approx(0.75 * plain[0], rel=1e-12)
    assert less[1:3] == pytest.approx(plain[1:3], rel=1e-12)
    assert chamber_flows(*args, -1.5, 0.0)[0] == 0.0


def test_flow_forces_are_0_43_of_opening_area_times_both_edges_pressure_drops(bench_joint):
    """Merritt 1967, section 5.6: F = 2 C_d C_v A dp cos(69 deg), 0.43 A dp for a sharp edge."""
    joint = bench_joint(
        {
            "valve.flow_force": 0.4,
            "valve.max_area_a": 0.7e-6,
            "valve.max_area_b": 0.5e-6,
            "supply.tank_pressure": 2e5,
        }
    )
    towards_a, towards_b = flow_forces(16e6, 9e6, 3e6, 0.03, joint)
    assert_allclose(towards_a, 0.43 * 0.7e-6 * (7e6 + 2.8e6), rtol=1e-13)
    assert_allclose(towards_b, 0.43 * 0.5e-6 * (13e6 + 8.8e6), rtol=1e-13)
    assert flow_forces(16e6, 9e6, 3e6, -0.5, joint) == (0.0, 0.0)  # oil opens no spool


EDGES = {
    "valve.full_opening": 1e-3,
    "valve.overlap_pa": 0.06e-3,
    "valve.overlap_at": 0.02e-3,
    "valve.overlap_pb": 0.09e-3,
    "valve.overlap_bt": -0.03e-3,
    "valve.area_gradient_pa": 18e-3,
    "valve.area_gradient_at": 15e-3,
    "valve.area_gradient_pb": 12e-3,
    "valve.area_gradient_bt": 9e-3,
    "valve.discharge": 0.67,
    "valve.edge_rounding": 0.0,
}


@pytest.mark.parametrize("x", [0.4e-3, -0.4e-3, 0.05e-3, -0.05e-3, 0.01e-3, 1.4e-3, -1.4e-3])
def test_each_of_four_edges_is_an_orifice_of_its_width_times_the_travel_beyond_its_overlap(link_joint, x):
    p_a, p_b, tank = 7.3e6, 3.1e6, 0.2e6
    joint = link_joint(EDGES)
    limited = min(max(x, -1e-3), 1e-3)

    def through(edge, sign, drop):
        area = EDGES[f"valve.area_gradient_{edge}"] * max(
            sign * limited - EDGES[f"valve.overlap_{edge}"], 0.0
        )
        transition = joint["fluid"]["laminar_transition"]
        return 0.67 * area * (2 / 870) ** 0.5 * drop / (drop**2 + transition**2) ** 0.25

    flow_a, flow_b, drawn, _, _ = chamber_flows(openings(x, joint), 12e6, p_a, p_b, 0.0, joint)
    in_a, in_b = through("pa", 1, 12e6 - p_a), through("pb", -1, 12e6 - p_b)
    assert_allclose(flow_a, in_a - through("at", -1, p_a - tank), rtol=1e-12, atol=1e-18)
    assert_allclose(flow_b, in_b - through("bt", 1, p_b - tank), rtol=1e-12, atol=1e-18)
    assert_allclose(drawn, in_a + in_b, rtol=1e-12, atol=1e-18)


@pytest.mark.parametrize("beyond_um", [-2.0, 0.5, 3.0, 40.0, 400.0])
def test_a_rounded_edge_opens_by_less_than_its_travel_and_by_nothing_while_closed(link_joint, beyond_um):
    x, radius = EDGES["valve.overlap_pa"] + 1e-6 * beyond_um, 3e-6
    sharp = openings(x, link_joint(EDGES)).pa
    rounded = openings(x, link_joint({**EDGES, "valve.edge_rounding": radius})).pa
    beyond = max(1e-6 * beyond_um, 0.0)
    travel = EDGES["valve.full_opening"] - EDGES["valve.overlap_pa"]
    assert_allclose(sharp, beyond / travel, rtol=1e-9, atol=1e-15)
    assert_allclose(rounded, (np.hypot(beyond, radius) - radius) / travel, rtol=1e-9, atol=1e-15)
    assert sharp - radius / travel - 1e-12 <= rounded <= sharp


def test_four_equal_edges_are_the_valve_with_one_area(link_joint, bench_joint):
    overlap, full, area = 0.06e-3, 0.35e-3, 0.67e-6
    same = {f"valve.overlap_{edge}": overlap for edge in ("pa", "at", "pb", "bt")}
    same |= {f"valve.area_gradient_{edge}": area / (full - overlap) for edge in ("pa", "at", "pb", "bt")}
    same |= {"valve.full_opening": full, "valve.discharge": 0.7, "valve.edge_rounding": 0.0}
    same |= {
        "fluid.laminar_transition": 0.2e6,
        "effects.valve.port_restriction.ratio": 0.8,
        "effects.valve.asymmetric_overlap.shift_m": 1e-5,
    }
    plain = bench_joint({key: value for key, value in same.items() if key.startswith("effects")})
    edges = link_joint(same)
    for x in np.linspace(-0.5e-3, 0.5e-3, 41):
        found = [chamber_flows(openings(x, j), P_S, 7.3e6, 3.1e6, 0.0, j) for j in (plain, edges)]
        assert_allclose(found[1], found[0], rtol=1e-12, atol=1e-20)
