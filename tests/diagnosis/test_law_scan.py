"""What shakes a machine, told by rollouts that are pulled to the measurements."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis import law_scan
from hydrolek_drake.diagnosis.law_fit import fitted, glance
from hydrolek_drake.diagnosis.law_scan import Scan, shaking
from hydrolek_drake.diagnosis.unlisted import Asked
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

RIPPLE, RIPPLE_HZ = 2e6, 3.104
"""Of the supply pressure [Pa]."""

BENT = 0.15
"""By so much of its own value a parameter is off that was fitted without the ripple."""


@pytest.fixture
def asked_of(bench, recorded, monkeypatch):
    """(how it was recorded) -> training data and what a bent nominal model leaves, as the body of a with statement."""
    monkeypatch.setattr(law_scan, "HIGHEST_HZ", 4.0)  # a matter of time
    with ThreadPoolExecutor(2) as pool:

        def make(**how):
            training, held_out = (recorded(bench, bench, seed=seed, largest_V=7.0, **how) for seed in (1, 2))
            workbench = Workbench(bench, free_parameters(bench), training, pool)
            paths = [free.path for free in free_parameters(bench) if "max_area" in free.path]
            assert paths
            bent = {path: (1.0 - BENT) * bench.value(path) for path in paths}
            left = workbench.fit((), bent, workbench.fine, 1)
            scales = natural_scales(bench, "joint", training)
            return workbench, Asked.of(workbench, left, held_out, scales)

        yield make


def test_a_ripple_stands_out_though_the_nominal_model_went_astray(asked_of) -> None:
    workbench, asked = asked_of(unknown=("supply", RIPPLE), unknown_Hz=RIPPLE_HZ)
    supply = [given for given in asked.inputs if given.probe == "supply"]
    assert asked.left.fit.over_noise > 10.0  # mostly by its bent numbers
    [free, *_] = Scan(workbench, asked.left, supply, asked.span, asked.step).laws()
    [law] = {
        law.frequency: law for law in shaking(workbench, asked.left, supply, asked.span, asked.step)
    }.values()
    assert abs(free.frequency - RIPPLE_HZ) > 0.25 / 12.0 > abs(law.frequency - RIPPLE_HZ)
    begun = glance(workbench, asked.left, law, asked.span, asked.step)[1:]
    found = fitted(workbench, asked.left, law, asked.held_out, asked.span, begun, workbench.fine)
    assert found.values[2] == pytest.approx(RIPPLE_HZ, abs=0.01)
    assert np.hypot(*found.values[:2]) == pytest.approx(RIPPLE, rel=0.1)
    assert found.fit.over_noise < 1.1 and found.held_out_over_noise < 1.2


def test_a_bent_model_of_a_machine_that_nothing_shakes_is_told_nothing(asked_of) -> None:
    workbench, asked = asked_of()
    assert asked.left.fit.over_noise > 10.0
    assert shaking(workbench, asked.left, asked.inputs, asked.span, asked.step) == []
