"""What joints that move together do to each other, told by a rollout of all: their own rollouts then move so too."""

from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.structures.weighing import felt_together
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.recorded import experiments_of

pytestmark = pytest.mark.xdist_group("joints together")

MOVING = ("right_j2", "right_j3")
ALLOWED_DEG = 0.02
"""What the rollout's own step may cost (hydrolek.yaml)."""
DROOP = "joints.right_j2.effects.supply.pressure_droop.resistance_Pa_s_per_m3"


@pytest.fixture(scope="module")
def healthy(two_joints, recorded_together) -> tuple[list[Experiment], np.ndarray]:
    """Experiments of the rig's own machine, and what it really read."""
    recording, reading = recorded_together(two_joints)
    return experiments_of(two_joints, recording), reading


def _off_deg(experiments: list[Experiment], machine, reading: np.ndarray) -> list[float]:
    return [
        float(np.degrees(np.sqrt(np.mean((e.simulate(machine.records()).signals.reading - own) ** 2))))
        for e, own in zip(experiments, reading.T, strict=True)
    ]


@pytest.mark.parametrize("resistance", [0.0, 3e10])
@pytest.mark.thorough
def test_joints_alone_move_as_beside_each_other(two_joints, recorded_together, resistance):
    machine = two_joints.with_values({DROOP: resistance})
    recording, reading = recorded_together(machine)
    experiments = experiments_of(machine, recording)
    by_angles = _off_deg(experiments, machine, reading)
    together = felt_together(machine, experiments)
    by_all_at_once = _off_deg(together, machine, reading)
    # smoothed angles alone make a healthy joint look as if something were missing, a rollout of all does not
    assert min(by_angles) > 2.0 * ALLOWED_DEG
    assert max(by_all_at_once) < ALLOWED_DEG
    told = [np.degrees(np.sqrt(np.mean(e.others_error[0] ** 2))) for e in together]
    assert max(told) < ALLOWED_DEG


@pytest.mark.thorough
def test_recordings_are_told_apart_by_name_and_by_their_joints(two_joints, healthy):
    first, _ = healthy
    again = felt_together(two_joints, [*first, *first, *(replace(e, name="other") for e in first)])
    assert [e.name for e in again] == ["made"] * 4 + ["other"] * 2
    assert [e.joint for e in again] == [*MOVING] * 3
    for experiment in again[2:]:
        assert np.array_equal(experiment.others[1], again[MOVING.index(experiment.joint)].others[1])


@pytest.mark.thorough
def test_joints_that_move_alone_stay_as_they_are(two_joints, healthy):
    experiments = [replace(e, others=None) for e in healthy[0]]
    assert all(a is b for a, b in zip(felt_together(two_joints, experiments), experiments, strict=True))


@pytest.mark.thorough
def test_where_the_joints_leave_all_bounds_measured_angles_must_do(two_joints, healthy):
    experiments, _ = healthy
    wild = two_joints.with_values({"supply.pressure": 1e16})
    again = felt_together(wild, experiments)
    assert all(a is b for a, b in zip(again, experiments, strict=True))


@pytest.mark.thorough
def test_the_beginning_of_an_experiment_keeps_the_beginning_of_its_error(two_joints, healthy):
    experiment = felt_together(two_joints, healthy[0])[0]
    early = experiment.until(2.0)
    assert early.others_error.shape == (1, early.time.size)
    assert np.array_equal(early.others_error[0], experiment.others_error[0, : early.time.size])
