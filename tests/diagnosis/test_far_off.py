"""A model that explains the training data and is far off on held-out data is asked whether it can follow both."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis.effort import AT_NOISE, POLISH
from hydrolek_drake.diagnosis.evidence import _predicted
from hydrolek_drake.diagnosis.judged import SMALL
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.parameter_set import free_parameters

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

AREA = "joints.joint.valve.max_area_a"
SAYS_LITTLE_V = 1.0  # within the dead-zone


@pytest.mark.parametrize(("changed", "follows"), [(AREA, True), ("supply.pressure", False)])
def test_only_a_model_that_can_follow_both_is_believed(bench, recorded, changed: str, follows: bool) -> None:
    machine = bench.with_values({changed: 0.9 * bench.value(changed)})
    training = recorded(machine, bench, seed=3, largest_V=SAYS_LITTLE_V)
    held_out = recorded(machine, bench, seed=2)
    counted = held_out[0].counted
    with ThreadPoolExecutor(2) as pool:
        work = Workbench(bench, free_parameters(bench, [AREA]), training, pool)
        hypothesis = work.fit((), {}, work.fine, POLISH)
        assert hypothesis.fit.over_noise < AT_NOISE
        judged = _predicted(work, hypothesis, held_out, counted, work.fine)
    assert judged.over_noise > SMALL
    assert judged.chi_squared is not None
    if follows:
        assert judged.chi_squared == pytest.approx(counted, rel=0.1)
    else:
        assert judged.chi_squared > 4.0 * counted
