"""Held-out data may ask for numbers that the training data do not tell: that alone is no missing physics."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.evidence.judged import Judged, conclude
from hydrolek_drake.diagnosis.evidence.reported import left_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.parameter_set import free_parameters

GENTLE_V, HARD_V = 3.0, 9.0
"""Commands that leave the edges half closed, and such that open them."""

CUSHION = "joints.joint.effects.cylinder.end_cushion"
BRAKED = {f"{CUSHION}.damping_N_s_per_m": 4e5, f"{CUSHION}.length_m": 0.06}
"""Gentle moves do not reach it."""


@pytest.mark.parametrize(("planted", "verdict"), [({}, "none"), (BRAKED, "unlisted_physics")])
def test_a_nominal_model_that_explains_all_data_lacks_nothing_though_it_failed_ahead(
    bench, recorded, fitted, planted, verdict
) -> None:
    own = {
        free.path: 1.1 * bench.value(free.path)
        for free in free_parameters(bench)
        if free.path.endswith("valve.max_area_a")
    }
    assert own
    machine = bench.with_values(own | planted)
    training = recorded(machine, bench, seed=1, largest_V=GENTLE_V)
    held_out = recorded(machine, bench, seed=2, largest_V=HARD_V)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool, 2)
        nominal = fitted(workbench, rounds=20)
        judged = [Judged(nominal, np.zeros(0), 0, probability=1.0)]
        told = left_of(workbench, judged, held_out)
    assert told[0].hypothesis.fit.over_noise < 1.06
    assert told[0].over_noise > 1.12
    assert conclude(told).verdict == verdict
