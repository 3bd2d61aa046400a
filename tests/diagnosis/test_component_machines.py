"""A leaking piston is named on machines with other components than those that the diagnosis grew on.

Recorded by the rollout itself at a finer step, so that this says nothing of how well the components are modelled.
"""

import json

import numpy as np
import pytest
from component_machines import machine_text

from hydrolek_drake.cli.app import run
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out

LEAK = 3e-12  # m^3/(s Pa)


def _recorded(rig, path, seed):
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, 30.0, 0.01)
    volts = np.repeat(rng.uniform(-1.5, 1.5, times.size // 40 + 1), 40)[: times.size]
    volts *= np.where(np.arange(times.size) // 40 % 2 == 0, 1.0, -1.0)
    signals = roll_out(rig.records(), times, volts, times, longest_step=2e-4).signals
    columns = {
        "time_s": times,
        "joint.command_V": volts,
        "joint.angle_deg": np.degrees(signals.reading) + rng.normal(scale=0.05, size=times.size),
        "joint.pressure_a_Pa": signals.pressure_a + rng.normal(scale=2e4, size=times.size),
        "joint.pressure_b_Pa": signals.pressure_b + rng.normal(scale=2e4, size=times.size),
    }
    np.savetxt(
        path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments=""
    )
    return path


@pytest.mark.parametrize("name", ["counterbalance", "pump_controlled"])
@pytest.mark.thorough
def test_a_leaking_piston_is_named_and_nothing_else(tmp_path, name):
    file = tmp_path / f"{name}.yaml"
    file.write_text(machine_text(name))
    rig = load_rig(file)
    leaking = rig.with_values(
        {"joints.joint.effects.cylinder.cross_port_leakage.conductance_m3_per_s_Pa": LEAK}
    )
    train, holdout = (_recorded(leaking, tmp_path / f"{part}.csv", part) for part in (1, 2))
    arguments = [
        str(file),
        str(train),
        "--holdout",
        str(holdout),
        "--no-confirm",
        "--out",
        str(tmp_path / "out"),
    ]
    assert run(["diagnose", *arguments]) == 0
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["verdict"] == "missing_physics"
    (named,) = report["effects"]
    assert named["id"] == "cylinder.cross_port_leakage"
    assert named["parameters"]["conductance_m3_per_s_Pa"]["value"] == pytest.approx(LEAK, rel=0.02)
