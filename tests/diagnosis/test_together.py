"""What joints that move together do to each other, told by a rollout of all: their own rollouts then move so too."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.diagnosis.together import felt_together
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.recorded import experiments_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rollout.together import JointsTogether

MOVING = ("right_j2", "right_j3")
TIME = np.arange(0.0, 8.0 + 0.005, 0.01)
NOISE_DEG = 0.05
ALLOWED_DEG = 0.02
"""What the rollout's own step may cost (hydrolek.yaml)."""
DROOP = "joints.right_j2.effects.supply.pressure_droop.resistance_Pa_s_per_m3"


def _recorded(machine, name: str = "made") -> tuple[list[Experiment], np.ndarray]:
    """Experiments of a noisy recording of both joints, and what they really read."""
    rng = np.random.default_rng(4)
    volts = np.repeat(rng.uniform(-3.0, 3.0, (17, 2)), 50, axis=0)[: TIME.size]
    volts[:50] = 0.0
    records = machine.records()
    starts = records["load"]["initial_position"]
    done = JointsTogether(machine, MOVING).roll_out(records, TIME, volts, TIME, starts, 2.5e-4)
    reading = done.signals["reading"]
    noisy = reading + np.radians(NOISE_DEG) * rng.standard_normal(reading.shape)
    signals = {f"{j}.command": volts[:, i] for i, j in enumerate(MOVING)}
    signals |= {f"{j}.angle": noisy[:, i] for i, j in enumerate(MOVING)}
    return experiments_of(machine, Recording(name, TIME, signals, Path(f"{name}.csv"))), reading


@pytest.fixture(scope="module")
def healthy(two_joints) -> tuple[list[Experiment], np.ndarray]:
    """A recording of the rig's own machine."""
    return _recorded(two_joints)


def _off_deg(experiments: list[Experiment], machine, reading: np.ndarray) -> list[float]:
    return [
        float(np.degrees(np.sqrt(np.mean((e.simulate(machine.records()).signals.reading - own) ** 2))))
        for e, own in zip(experiments, reading.T, strict=True)
    ]


@pytest.mark.parametrize("resistance", [0.0, 3e10])
def test_joints_alone_move_as_beside_each_other(two_joints, healthy, resistance):
    machine = two_joints.with_values({DROOP: resistance})
    experiments, reading = _recorded(machine) if resistance else healthy
    by_angles = _off_deg(experiments, machine, reading)
    together = felt_together(machine, experiments)
    by_all_at_once = _off_deg(together, machine, reading)
    # smoothed angles alone make a healthy joint look as if something were missing, a rollout of all does not
    assert min(by_angles) > 2.0 * ALLOWED_DEG
    assert max(by_all_at_once) < ALLOWED_DEG
    told = [np.degrees(np.sqrt(np.mean(e.others_error[0] ** 2))) for e in together]
    assert max(told) < ALLOWED_DEG


def test_recordings_are_told_apart_by_name_and_by_their_joints(two_joints, healthy):
    first, _ = healthy
    again = felt_together(two_joints, [*first, *first, *(replace(e, name="other") for e in first)])
    assert [e.name for e in again] == ["made"] * 4 + ["other"] * 2
    assert [e.joint for e in again] == [*MOVING] * 3
    for experiment in again[2:]:
        assert np.array_equal(experiment.others[1], again[MOVING.index(experiment.joint)].others[1])


def test_joints_that_move_alone_stay_as_they_are(two_joints, healthy):
    experiments = [replace(e, others=None) for e in healthy[0]]
    assert all(a is b for a, b in zip(felt_together(two_joints, experiments), experiments, strict=True))


def test_where_the_joints_leave_all_bounds_measured_angles_must_do(two_joints, healthy):
    experiments, _ = healthy
    wild = two_joints.with_values({"fluid.bulk_modulus": 1e16})
    again = felt_together(wild, experiments)
    assert all(a is b for a, b in zip(again, experiments, strict=True))


def test_the_beginning_of_an_experiment_keeps_the_beginning_of_its_error(two_joints, healthy):
    experiment = felt_together(two_joints, healthy[0])[0]
    early = experiment.until(2.0)
    assert early.others_error.shape == (1, early.time.size)
    assert np.array_equal(early.others_error[0], experiment.others_error[0, : early.time.size])
