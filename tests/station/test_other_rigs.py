"""Rigs of other machines run in the Diagram too, and as in the rollout."""

import numpy as np
import pytest
import yaml

from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import rest_state, roll_out
from hydrolek_drake.station.simulation import command_source, initial_context, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import StepSizes

CASES = {"emps_published": (0.0, 1.5, 0.02), "festo_tp511": (0.05, 2.0, 0.05), "patu_lift": (0.2, 5.0, 0.3)}


@pytest.mark.parametrize("name", CASES)
def test_diagram_and_rollout_agree(name):
    start, volts, hold = CASES[name]
    rig = load_rig(name)
    times = np.arange(0.0, 2.0, 0.01)
    neutral = rig.value("command.neutral")
    command = np.where(np.floor(times / hold) % 2 == 0, neutral, volts)
    records = rig.records()
    outcome = roll_out(records, times, command, times, state=rest_state(records, start), longest_step=1e-4)
    assert outcome.diverged is None
    station = make_station(
        rig, sizes=StepSizes(step=0.25e-3), command=command_source(times, command[:, None])
    )
    signals = run(station, 2.0, context=initial_context(station, np.array([start]))).signals
    moved = np.ptp(outcome.signals.position)
    assert moved > 0.0
    np.testing.assert_allclose(
        signals["position"][: len(times), 0], outcome.signals.position, rtol=0.0, atol=0.01 * moved
    )


def test_a_users_machine_is_one_file(tmp_path):
    """Two joints of different kinds on one supply, from one YAML file."""
    tree = {
        "schema": 1,
        "name": "mine",
        "based_on": "joint_bench",
        "joints": {
            "boom": {
                "like": "joint",
                "load": {"initial_position": {"value": 10, "unit": "deg", "source": "test"}},
            },
            "stick": {
                "like": "joint",
                "load": {"inertia": {"value": 12, "unit": "kg m^2", "source": "test"}},
            },
        },
        "keep": ["boom", "stick"],
        "effects": {
            "supply.pressure_droop": {
                "resistance_Pa_s_per_m3": {"value": 1e11, "unit": "Pa s/m^3", "source": "test"}
            }
        },
    }
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(tree))
    rig = load_rig(path)
    assert rig.joints == ("boom", "stick")
    times = np.array([0.0, 0.1, 2.0])
    alone, together = (
        run(
            make_station(
                rig, command=command_source(times, np.array([[0.0, 0.0], [4.0, other], [4.0, other]]))
            ),
            1.0,
        ).signals
        for other in (0.0, 4.0)
    )
    # Both draw from one pump: its pressure falls further and the boom is slower when the stick moves as well.
    assert together["supply_pressure"].min() < alone["supply_pressure"].min()
    assert together["position"][-1, 0] < alone["position"][-1, 0] - np.radians(0.1)
