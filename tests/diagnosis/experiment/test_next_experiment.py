"""The next experiment is proposed from simulation, whatever was recorded so far and however it began."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.diagnosis.evidence.judged import Conclusion, Judged
from hydrolek_drake.diagnosis.evidence.proposal import propose
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.weighing import weighted_by
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import load_rig

RIVALS = ("valve.null_leakage", "cylinder.cross_port_leakage")


@pytest.fixture(scope="module")
def alike(fitted):
    """A joint whose start is a mean of readings, its angle alone recorded, and two models of it that are alike."""
    rig = load_rig("hydrolek_right_j2")
    generator = np.random.default_rng(1)
    time = np.arange(0.0, 12.0, 0.01)
    command = np.repeat(generator.uniform(-3.0, 3.0, 24), 50)
    command[:50] = 0.0
    reading = np.radians(25.0 + 0.05 * generator.standard_normal(time.size))
    signals = {"right_j2.command": command, "right_j2.angle": reading}
    (experiment,) = experiments_of(rig, Recording("made", time, signals, Path("made.csv")))
    played = experiment.simulate(rig.records()).signals.reading
    signals["right_j2.angle"] = played + np.radians(0.05) * generator.standard_normal(time.size)
    training = experiments_of(rig, Recording("made", time, signals, Path("made.csv")))
    candidates = candidates_of(rig, "right_j2", natural_scales(rig, "right_j2", training))
    with ThreadPoolExecutor(2) as pool:
        bench = Workbench(rig, free_parameters(rig), training, pool, 2)
        nominal = fitted(bench, rounds=4)
        bench.training = tuple(weighted_by(bench, nominal, training))
        chosen = [next(c for c in candidates if c.id == id_) for id_ in RIVALS]
        fits = [fitted(bench, (c,), {**nominal.values, **c.starts[0]}, 1) for c in chosen]
        yield bench, fits


def test_a_proposal_separates_models_where_the_start_is_uncertain(alike) -> None:
    bench, fits = alike
    assert bench.training[0].start_response is not None
    judged = Judged(fits[0], np.zeros(1), 1)
    told = propose(bench, Conclusion("ambiguous", judged, {}, (RIVALS,)), fits)
    assert told is not None
    assert told.separation > 0.0
    assert told.time.shape == told.command.shape
    assert np.abs(told.command).max() <= np.abs(bench.training[0].command).max()
    # leaks differ most in the pressures, which were not recorded
    assert "both chamber pressures recorded" in told.sentence


def test_nothing_is_proposed_where_nothing_is_alike(alike) -> None:
    bench, fits = alike
    judged = Judged(fits[0], np.zeros(1), 1)
    assert propose(bench, Conclusion("missing_physics", judged, {}, ()), fits) is None
    assert propose(bench, Conclusion("ambiguous", judged, {}, (RIVALS,)), fits[:1]) is None
    assert propose(bench, Conclusion("unlisted_physics", judged, {}, (RIVALS,)), fits) is None
