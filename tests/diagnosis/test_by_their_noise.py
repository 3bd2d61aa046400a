"""A model that was found with signals that count alike is held against their noise, if it comes near it."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis.again import by_their_noise
from hydrolek_drake.diagnosis.attempt import Known
from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import LOOK
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

LEAK = {"effects.cylinder.cross_port_leakage.conductance_m3_per_s_Pa": 1.5e-12}


@pytest.fixture(scope="module")
def led(bench, recorded):
    """Effect that the other search found -> what becomes of the first one, which found nothing."""
    how = {"largest_V": 4.0, "pressure_noise_Pa": 2e4}
    training = recorded(bench.with_values(LEAK), bench, **how)
    held_out = recorded(bench.with_values(LEAK), bench, seed=7, **how)
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", training))

    with ThreadPoolExecutor(2) as pool:
        baseline = fit_baseline(Workbench(bench, free_parameters(bench), training, pool))

    def lead(name):
        with ThreadPoolExecutor(2) as pool:
            workbench = Workbench(bench, free_parameters(bench), training, pool)
            first, other = Search(), Search()
            for found in (first, other):
                found.keep(baseline)
                found.weighed_at = baseline.fit.over_noise
            effects = tuple(c for c in candidates if c.id == name)
            if effects:
                start = {**baseline.values, **effects[0].starts[0]}
                other.keep(workbench.fit(effects, start, workbench.fine, LOOK))
            known, alike = (Known(workbench, f, tuple(held_out), (), None, False) for f in (first, other))
            return by_their_noise(known, alike, candidates, lambda text: None)

    return lead


def test_what_explains_every_signal_is_named(led):
    own = led("cylinder.cross_port_leakage")
    assert own.conclusion.verdict == "missing_physics"
    best = own.conclusion.best.hypothesis
    assert [c.id for c in best.effects] == ["cylinder.cross_port_leakage"]
    assert best.values[best.effects[0].size_path] == pytest.approx(1.5e-12, rel=0.05)


@pytest.mark.parametrize("name", ["sensor.drift", ""])
def test_what_does_not_come_near_the_noise_leads_nowhere(led, name):
    assert led(name) is None
