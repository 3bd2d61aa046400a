"""Diagram and compiled rollout are two executions of one physics."""

import sys
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.station.simulation import command_source, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import StepSizes, sizes_for

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
from two_executions import cases, differences  # of docs/evidence/agreement.md, here for a few seconds a case

REQUIRED_DEG = 0.02
STEP = 0.5e-3  # seconds


@pytest.mark.parametrize("joint", cases.JOINTS)
@pytest.mark.thorough(but=3)
def test_every_instrumented_joint_agrees_with_its_rollout(joint):
    [(_, largest)] = differences.compare(load_rig(joint), 4.0, STEP, 3)
    assert largest <= REQUIRED_DEG


ON_THE_ARMS = [e for e in sorted(EFFECTS) if EFFECTS[e].needs.get("supply") != ("pump",)]


@pytest.mark.parametrize(
    "values", [{}, {"supply.relief_hysteresis": 0.0, "effects.supply.pump_loss.fraction": 0.5}]
)
@pytest.mark.thorough
def test_a_pump_with_its_relief_valve_and_four_edges_agree_with_their_rollout(values):
    """A line that settles in a tenth of a millisecond, in both executions' steps."""
    rig = load_rig("hopsan_link").with_values(values)
    [(_, largest)] = differences.compare(rig, 3.0, sizes_for(rig).step, 5)
    assert largest <= REQUIRED_DEG


@pytest.mark.parametrize(("number", "effect"), list(enumerate(ON_THE_ARMS)))
@pytest.mark.thorough(but=2)
def test_every_effect_agrees_with_its_rollout(number, effect):
    joint = cases.JOINTS[number % len(cases.JOINTS)]
    rig = cases.with_effect(load_rig(joint), effect)
    assert effect in rig.effects_on(joint.removeprefix("hydrolek_"))
    [(_, largest)] = differences.compare(rig, 3.0, STEP, number)
    assert largest <= REQUIRED_DEG


@pytest.mark.parametrize(
    ("joint", "slow"),
    [
        ("hydrolek_right_j3", {"command.ramp": 0.03}),
        ("hydrolek_left_j2", {"amplifier.coil_time": 0.04}),
        ("emps", {"command.ramp": 0.05}),  # a motor takes the voltage itself
        ("hydrolek_right_j4", {"valve.flow_force": 0.05}),
    ],
)
def test_a_command_that_takes_time_agrees_with_its_rollout(joint, slow):
    rig = load_rig(joint)
    [(_, largest)] = differences.compare(rig.with_values(slow), 1.5, STEP, 4)
    assert largest <= REQUIRED_DEG
    times, volts = differences.random_voltage(1.5, np.random.default_rng(4))
    at_once, late = (
        roll_out(each.records(), times, volts, times, longest_step=STEP).signals.reading
        for each in (rig, rig.with_values(slow))
    )
    assert np.degrees(np.abs(late - at_once)).max() > 10.0 * REQUIRED_DEG


def test_the_difference_shrinks_with_the_step():
    rig = load_rig("hydrolek_right_j3")
    coarse, fine = (differences.compare(rig, 1.5, step, 5)[0][0] for step in (1e-3, 0.25e-3))
    assert fine < 0.5 * coarse


@pytest.mark.parametrize("plant", [cases.on_the_arms, cases.bodies])
@pytest.mark.thorough(but=1)
def test_cases_that_share_a_diagram_are_those_that_run_alone(plant):
    chosen = [("hydrolek_left_j2", "linkage.backlash"), ("hydrolek_right_j3", "base.compliance")]
    together = differences.compare(plant(chosen), 1.5, 1e-3, 2, 3)
    alone = [
        figures
        for case, seed in zip(chosen, (2, 3), strict=True)
        for figures in differences.compare(cases.single(case), 1.5, 1e-3, seed)
    ]
    assert min(rms for rms, _ in alone) > 0.0  # they did move
    np.testing.assert_allclose(together, alone, rtol=1e-3)


def test_forces_at_the_mounts_are_the_joint_moments_of_virtual_work():
    rig = load_rig("hydrolek")
    times = np.arange(0.0, 1.0, 0.01)
    volts = np.random.default_rng(2).uniform(-3.0, 3.0, (1, len(rig.joints))).repeat(len(times), axis=0)
    positions = []
    for mount_forces in (True, False):
        sizes = StepSizes(step=1e-3, mount_forces=mount_forces)
        station = make_station(rig, sizes=sizes, command=command_source(times, volts))
        positions.append(run(station, 1.0).signals["position"])
    assert np.ptp(positions[0], axis=0).max() > 0.1
    np.testing.assert_allclose(positions[0], positions[1], rtol=0.0, atol=1e-6)


@pytest.mark.thorough
def test_symplectic_euler_stays_near_runge_kutta():
    rig = load_rig("hydrolek_right_j2")
    times, volts = differences.random_voltage(4.0, np.random.default_rng(9))
    ends = []
    for integrator in ("runge_kutta2", "symplectic_euler"):
        station = make_station(
            rig,
            sizes=StepSizes(step=1e-3, integrator=integrator),
            command=command_source(times, volts[:, None]),
        )
        ends.append(run(station, 4.0).signals["position"][:, 0])
    # First order: half a step of the joint's largest speed, 40 deg/s (Table 6.1), stays in any phase of the motion.
    assert np.degrees(np.abs(ends[0] - ends[1])).max() < 40.0 * 2e-3


@pytest.mark.thorough
def test_an_arm_that_is_thrown_about_does_not_shake_its_wrist_apart():
    """Little damps a wrist whose valves are closed: an integrator that feeds its oil springs is 0.1 deg off, or 5."""
    rig = load_rig("hydrolek")
    moving = [rig.joints.index(joint) for joint in ("right_j2", "right_j3")]
    times = np.arange(0.0, 12.0, 0.01)
    levels = np.random.default_rng(1).uniform(-4.0, 4.0, (20, 2))
    volts = np.zeros((times.size, len(rig.joints)))
    volts[:, moving] = levels[(times / 0.6).astype(int)]
    volts[times < 0.5] = 0.0
    angles = []
    for sizes in (StepSizes(), StepSizes(step=2.5e-4)):
        station = make_station(rig, sizes=sizes, command=command_source(times, volts))
        angles.append(run(station, 12.0).signals["position"][:, moving])
    assert np.degrees(np.ptp(angles[1], axis=0)).min() > 30.0
    # what a recording's noise of 0.05 deg does not show
    assert np.degrees(np.sqrt(np.mean((angles[0] - angles[1]) ** 2, axis=0))).max() < 0.02
