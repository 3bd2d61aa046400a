"""Flow that saturates as the opening grows."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics import valve
from hydrolek_drake.physics.valves.openings import Openings
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out

RATIO = 0.8


def test_ports_and_edges_are_orifices_in_series(bench):
    """What flows through both: Q = k s sqrt(dp_edge) = k / sqrt(ratio) sqrt(dp_port), the drops adding up."""
    ratio, p_supply, p_a, p_b = RATIO, 16e6, 9e6, 2e6
    joint = bench.with_values({"effects.valve.port_restriction.ratio": ratio}).records()[0]
    tank = bench.value("supply.tank_pressure")
    for share in (0.1, 0.5, 1.0):
        opened = Openings(share, 0.0, 0.0, share)
        plain = valve.edge_conductances(opened, p_supply, p_a, p_b, 0.0, bench.records()[0])
        choked = valve.edge_conductances(opened, p_supply, p_a, p_b, 0.0, joint)
        for edge, drop in ((0, p_supply - p_a), (3, p_b - tank)):
            flow = choked[edge] * drop
            full = plain[edge] * np.sqrt(drop) / share  # k
            in_edge, in_port = (flow / (full * share)) ** 2, ratio * (flow / full) ** 2
            assert_allclose(in_edge + in_port, drop, rtol=1e-9)
        assert choked[1] == plain[1] == choked[2] == plain[2] == 0.0


@pytest.mark.parametrize("volts", [1.0, 2.0, 3.0, 4.0, 5.0])
def test_a_rod_without_friction_loses_the_same_share_of_its_speed(volts) -> None:
    """Its pressures are those at every speed, so that the flow is the opening's: 1 / sqrt(1 + ratio s^2)."""

    def speed(ratio):
        rig = load_rig("festo_tp511", {"cylinder.viscous_friction": "0.001 N s/m"})
        records = rig.with_values({"effects.valve.port_restriction.ratio": ratio}).records()
        times = np.array([0.0, 0.4, 0.6])
        outcome = roll_out(records, np.zeros(1), np.array([volts]), times, longest_step=5e-4)
        return np.diff(outcome.signals.position)[1] / 0.2

    share = volts / load_rig("festo_tp511", {}).value("joints.cylinder.solenoid.rated_voltage")
    assert_allclose(speed(RATIO) / speed(0.0), 1.0 / np.sqrt(1.0 + RATIO * share**2), rtol=3e-4)
