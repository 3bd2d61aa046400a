"""What the integration leaves where a joint chatters shows the more the longer an observer remembers."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from hydrolek_drake.diagnosis.structures.weighing import weighted_by
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.parameter_set import free_parameters

STICKS = {
    "joints.joint.effects.cylinder.stribeck_friction.coulomb_N": 400.0,
    "joints.joint.effects.cylinder.stribeck_friction.stribeck_N": 2000.0,
    "joints.joint.effects.cylinder.stribeck_friction.stribeck_velocity_m_per_s": 0.01,
}


def test_the_error_of_the_integration_is_told_as_the_observer_sees_it(bench, recorded, fitted) -> None:
    machine = bench.with_values(STICKS)
    training = recorded(machine, machine, seed=1, pressure_noise_Pa=2e3)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(machine, free_parameters(machine), training, pool)
        model = fitted(workbench, rounds=0)
        errors = [
            np.sqrt(np.mean(np.square([c.model_error for c in e.channels if c.unit == "Pa"])))
            for observer in (0.03, 0.3, math.inf)
            for e in weighted_by(workbench, model, workbench.training, observer)
        ]
    assert 0.0 < errors[0] < errors[1] < errors[2]


def test_what_an_observer_leaves_does_not_tell_the_noise(bench, recorded, fitted) -> None:
    """It takes a share of the noise into its state: the noise stays as it was told, and free rollouts tell it."""
    training = recorded(bench, bench, seed=1)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        model = fitted(workbench, rounds=0)
        [free] = weighted_by(workbench, model, workbench.training)
        [same] = weighted_by(workbench, model, workbench.training, math.inf)
        [fast] = weighted_by(workbench, model, workbench.training, 0.03)
    for before, one, other, kept in zip(
        training[0].channels, free.channels, same.channels, fast.channels, strict=True
    ):
        assert one.noise == other.noise
        assert kept.noise == before.noise
        np.testing.assert_array_equal(one.model_error, other.model_error)
