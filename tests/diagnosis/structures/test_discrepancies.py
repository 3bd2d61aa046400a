"""Where no model comes near the noise of any signal, each signal counts by how far the model is off from it."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.diagnosis.structures.weighing import weighted_by
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.parameter_set import free_parameters

WORN = {
    "joints.joint.effects.cylinder.coulomb_friction.coulomb_N": 1500.0,
    "joints.joint.effects.cylinder.cross_port_leakage.conductance_m3_per_s_Pa": 4e-12,
}


def _left(experiment, workbench, hypothesis) -> dict[str, float]:
    """Root mean square of each signal's residuals."""
    problem = workbench.problem(hypothesis.effects, workbench.fine, [experiment])
    records = problem.parameters.records(problem.parameters.unit(hypothesis.values))
    residuals = experiment.residuals(experiment.simulate(records, workbench.fine).signals)
    own = residuals.reshape(len(experiment.channels), -1)
    return {c.key: float(np.sqrt(np.mean(r**2))) for c, r in zip(experiment.channels, own, strict=True)}


@pytest.mark.parametrize("signals_apart", [True, False])
def test_signals_far_from_their_noise_count_alike_only_if_asked(
    bench, recorded, fitted, signals_apart
) -> None:
    machine = bench.with_values(WORN)
    training = recorded(machine, bench, seed=1, pressure_noise_Pa=2e3)
    held_out = recorded(machine, bench, seed=2, pressure_noise_Pa=2e3)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool, signals_apart=signals_apart)
        nominal = fitted(workbench, rounds=4)
        workbench.training = tuple(weighted_by(workbench, nominal, workbench.training))
        left = _left(workbench.training[0], workbench, nominal)
        [ahead] = weighted_by(workbench, nominal, held_out)
    assert min(left.values()) > NOISE.far
    same = max(left.values()) / min(left.values()) < 1.02
    assert same is signals_apart
    told = {c.key: c.discrepancy for c in workbench.training[0].channels}
    assert {c.key: c.discrepancy for c in ahead.channels} == told  # held-out data do not weigh themselves


def test_a_model_near_the_noise_of_a_signal_leaves_all_weights_as_they_are(bench, recorded, fitted) -> None:
    training = recorded(bench, bench, seed=1, pressure_noise_Pa=3e4)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool, signals_apart=True)
        weighted = weighted_by(workbench, fitted(workbench, rounds=4), workbench.training)
    assert all(channel.discrepancy == 1.0 for channel in weighted[0].channels)
