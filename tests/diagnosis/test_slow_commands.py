"""Laws of a command that takes time behind the computer, told from a longer delay and from slower valves."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis import law_scan, law_search
from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.law_fit import fitted, glance
from hydrolek_drake.diagnosis.law_inputs import Input, inputs_of
from hydrolek_drake.diagnosis.law_search import promising
from hydrolek_drake.diagnosis.laws import TERMS, Term, span_of
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
    ("probe", "path", "size"),
    [("ramp", "command.ramp", 1.0 / 250.0), ("coil_time", "amplifier.coil_time", 0.02)],
)
def test_a_ramp_and_slow_coils_are_told_from_each_other(bench, recorded, probe, path, size) -> None:
    machine = bench.with_values({path: size})
    training, held_out = (recorded(machine, bench, seed=seed) for seed in (1, 2))
    span = span_of([training[0].simulate(bench.records()).signals], bench.records()[0], 12.0, "rad")
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        scales = natural_scales(bench, "joint", training)
        inputs = inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad")
        early = [given for given in inputs if given.one_sided]
        laws = promising(workbench, nominal, early, span, 4.0 * workbench.fine)
        tried = [(glance(workbench, nominal, law, span, 2.0 * workbench.fine), law) for law in laws]
        (_, *at), law = min(tried, key=lambda each: each[0][0])
        found = fitted(workbench, nominal, law, held_out, span, at, workbench.fine)
    assert nominal.fit.over_noise > 1.5
    assert found.law.input.probe == probe
    assert found.held_out_over_noise < 1.1
    assert found.values == pytest.approx([size], rel=0.1)


def test_what_takes_a_time_depends_on_nothing() -> None:
    ramp = Input("command", "ramp", "time for each volt", "s/V", 0.03, one_sided=True)
    assert [term for term in TERMS if term.meant_for(ramp)] == [Term(TERMS[0].stages)]


def test_no_less_than_no_time_is_promised(bench, recorded) -> None:
    """A machine that is quicker than its model has no ramp."""
    slow = bench.with_values({"command.ramp": 1.0 / 250.0})
    training = recorded(bench, slow)
    span = span_of([training[0].simulate(slow.records()).signals], bench.records()[0], 12.0, "rad")
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(slow, free_parameters(slow), training, pool)
        nominal = fit_baseline(workbench)
        inputs = inputs_of(
            natural_scales(slow, "joint", training), slow.value("supply.pressure"), 10.0, "rad"
        )
        ramp = [given for given in inputs if given.probe == "ramp"]
        laws = promising(workbench, nominal, ramp, span, workbench.fine)
    assert nominal.fit.over_noise > 1.5
    assert [law.gain for law in laws if not law.periodic] == [0.0]
