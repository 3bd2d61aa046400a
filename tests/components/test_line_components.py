"""Hoses and accumulators beside closed forms."""

import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.cylinder import pressure_rates
from hydrolek_drake.physics.lines.accumulator import gas_capacity
from hydrolek_drake.physics.lines.hose import behind_hose
from hydrolek_drake.physics.supply import rate_of_change
from hydrolek_drake.physics.valve import chamber_flows
from hydrolek_drake.physics.valves.openings import openings


@pytest.mark.parametrize(("resistance", "loss"), [(2e9, 0.0), (0.0, 2e13), (2e9, 2e13)])
@pytest.mark.parametrize("drop", [8e6, -3e6])
def test_an_edge_and_its_hose_share_the_pressure_drop(resistance, loss, drop):
    edge = 2.2e-11
    flow = behind_hose(edge, drop, resistance, loss) * drop
    root = edge * edge * abs(drop)  # Q^2 over the drop of the edge alone
    across = resistance * flow + (loss + 1.0 / root) * flow * abs(flow)
    assert_allclose(across, drop, rtol=1e-9)
    assert behind_hose(edge, drop, 0.0, 0.0) == edge


def test_a_hose_widens_beside_the_oil(with_component):
    rig = with_component("hose")
    joint, stiff = rig.records()[0], rig.with_values({"hose.expansion_a": 0.0, "hose.expansion_b": 0.0})
    *_, soft_a, soft_b = pressure_rates(7e6, 3e6, 0.0, 0.0, 0.07, 0.0, joint)
    *_, hard_a, hard_b = pressure_rates(7e6, 3e6, 0.0, 0.0, 0.07, 0.0, stiff.records()[0])
    assert_allclose(1 / soft_a - 1 / hard_a, 2e-12, rtol=1e-9)
    assert_allclose(1 / soft_b - 1 / hard_b, 2e-12, rtol=1e-9)


def test_hoses_slow_the_flow_through_an_open_valve(with_component):
    rig = with_component("hose")
    none = {f"hose.{name}_{side}": 0.0 for name in ("resistance", "loss") for side in "ab"}
    opened = openings(0.35e-3, rig.records()[0])
    narrow, wide = (
        chamber_flows(opened, 16e6, 7e6, 3e6, 0.0, r.records()[0]) for r in (rig, rig.with_values(none))
    )
    assert 0.5 * wide[0] < narrow[0] < 0.99 * wide[0]
    assert 0.5 * wide[1] > narrow[1] > 0.99 * wide[1]


@pytest.mark.parametrize("exponent", [1.0, 1.2, 1.4])
def test_the_gas_takes_what_its_polytropic_law_says(with_component, exponent):
    joint = with_component("accumulator").with_values({"accumulator.exponent": exponent}).records()[0]
    volume = lambda p: 0.7e-3 * ((100e5 + 1e5) / (p + 1e5)) ** (1 / exponent)  # noqa: E731
    for p in (110e5, 160e5, 240e5):
        assert_allclose(gas_capacity(p, joint), (volume(p - 100) - volume(p + 100)) / 200, rtol=1e-6)
    assert gas_capacity(99e5, joint) == 0.0


def test_a_pump_that_stands_still_is_replaced_by_the_accumulator_for_so_long(with_component):
    """Drawn from a charged accumulator, the pressure falls as gas and oil together give volume."""
    rig = with_component("accumulator").with_values({"supply.displacement": 1e-15})
    joint = rig.records()[0]
    p0, drawn, h = joint["supply"]["pressure"] - 1e5, 5e-5, 1e-3
    above, seconds = p0 - joint["supply"]["pressure"], 2.0
    for _ in range(round(seconds / h)):
        rate, _ = rate_of_change(above, 0.0, drawn, joint)
        above += h * rate
    p1 = joint["supply"]["pressure"] + above
    gas = lambda p: 0.7e-3 * ((100e5 + 1e5) / (p + 1e5)) ** (1 / 1.4)  # noqa: E731
    oil = 0.5e-3 / 1e9 * (p0 - p1)
    assert_allclose(gas(p1) - gas(p0) + oil, drawn * seconds, rtol=1e-3)


def test_an_accumulator_needs_a_pump(with_component):
    """On a constant pressure it would change nothing, and a rig must not promise it."""
    with pytest.raises(InputError, match="accumulator"):
        with_component("accumulator_without_pump")
