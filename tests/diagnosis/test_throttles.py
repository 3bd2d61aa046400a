"""Laws of what flows back to the tank, told from a valve that is smaller both ways."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis import law_scan, law_search
from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.law_fit import fitted, glance
from hydrolek_drake.diagnosis.law_inputs import inputs_of
from hydrolek_drake.diagnosis.law_search import promising
from hydrolek_drake.diagnosis.laws import Term, law_records, span_of
from hydrolek_drake.diagnosis.unlisted import worth_trying
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")


@pytest.fixture(autouse=True)
def in_less_time(monkeypatch) -> None:
    """Sines are not what these tests are about."""
    monkeypatch.setattr(law_scan, "HIGHEST_HZ", 2.0)
    monkeypatch.setattr(law_search, "shaking", lambda *given: [])


@pytest.mark.parametrize(
    ("side", "share"),
    [pytest.param("back_a", -0.1, marks=pytest.mark.long("takes half a minute more")), ("back_b", -0.2)],
)
def test_a_throttle_in_the_way_back_is_told_from_a_smaller_valve(bench, recorded, side, share) -> None:
    """Of either side alone: what drives the rod one way is as it was. The fits decide, not what each law promised."""
    span = span_of(
        [recorded(bench, bench)[0].simulate(bench.records()).signals], bench.records()[0], 12.0, "rad"
    )
    throttle = law_records(side, span, (Term(()),), (share,))
    kept = {"pressure_noise_Pa": 2e4, "law": lambda _: throttle}
    training, held_out = (recorded(bench, bench, seed=seed, **kept) for seed in (1, 2))
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        scales = natural_scales(bench, "joint", training)
        inputs = inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad")
        valve = [given for given in inputs if given.stage == "valve"]
        laws = promising(workbench, nominal, valve, span, 4.0 * workbench.fine)
        laws.sort(key=lambda law: -law.gain)
        first = worth_trying(laws)[: 2 * len(valve)]
        tried = [(glance(workbench, nominal, law, span, 2.0 * workbench.fine), law) for law in first]
        (_, *at), law = min(tried, key=lambda each: each[0][0])
        found = fitted(workbench, nominal, law, held_out, span, at, workbench.fine)
    assert nominal.fit.over_noise > 2.0
    assert found.law.input.probe == side
    assert found.held_out_over_noise < 1.1
    assert found.values == pytest.approx([share], rel=0.05)
