"""A law that explains the training data, which do not tell the numbers that the held-out recording asks for."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.attempt import PREDICTED, Known, predicting
from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.conclusion import EXPLAINED, conclude
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_by_both import known_by_both, law_by_both
from hydrolek_drake.diagnosis.law_fit import fitted
from hydrolek_drake.diagnosis.law_inputs import inputs_of
from hydrolek_drake.diagnosis.law_problem import Law
from hydrolek_drake.diagnosis.laws import BUILT, span_of
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

COIL_S = 0.02
SMALL_V, LARGE_V = 2.5, 9.0


@pytest.fixture(scope="module")
def machine(bench):
    """Slow coils, and numbers that are not the rig's."""
    rng = np.random.default_rng(7)
    own = {free.path: bench.value(free.path) * rng.uniform(0.9, 1.1) for free in free_parameters(bench)}
    return bench.with_values({**own, "amplifier.coil_time": COIL_S})


@pytest.fixture(scope="module")
def told(bench, machine, recorded):
    """(held-out machine, largest training volts) -> workbench, nominal model, law by training data, held-out data."""

    def tell(ahead, largest_V=SMALL_V):
        training = recorded(machine, bench, seed=1, largest_V=largest_V)
        held_out = recorded(ahead, bench, seed=2, largest_V=LARGE_V)
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        scales = natural_scales(bench, "joint", training)
        inputs = inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad")
        [coils] = [each for each in inputs if each.probe == "coil_time"]
        span = span_of([training[0].simulate(bench.records()).signals], bench.records()[0], 12.0, "rad")
        law = Law(coils, BUILT, 0.0, 1.0, (0.1,))
        begin = (nominal.values, np.array([0.1 * coils.scale]))
        found = fitted(workbench, nominal, law, held_out, span, begin, workbench.fine)
        return workbench, nominal, found, held_out

    with ThreadPoolExecutor(2) as pool:
        yield tell


@pytest.fixture(scope="module")
def astray(machine, told):
    """Training data at a third of the voltage of the held-out ones."""
    return told(machine)


def test_fitted_to_parts_of_both_it_explains_both(astray) -> None:
    workbench, nominal, law, held_out = astray
    assert nominal.fit.over_noise > 2.0
    assert law.fit.over_noise < EXPLAINED and law.held_out_over_noise > 2.0 * PREDICTED
    both = law_by_both(workbench, nominal, law, held_out)
    assert both is not None and predicting(both)
    assert both.values == pytest.approx([COIL_S], rel=0.03)
    training, kept = both.parts
    [part], [rest] = training[len(workbench.training) :], kept
    assert not np.any(part.used & rest.used)
    np.testing.assert_array_equal(part.used | rest.used, held_out[0].used)


def test_it_must_not_go_astray_by_something_else(machine, told) -> None:
    """Friction in the held-out recording alone: no numbers of the machine explain both."""
    rubbing = machine.with_values({"effects.cylinder.coulomb_friction.coulomb_N": 600.0})
    workbench, nominal, law, held_out = told(rubbing)
    assert law.fit.over_noise < EXPLAINED and not predicting(law)
    assert law_by_both(workbench, nominal, law, held_out) is None


def test_what_predicts_or_is_periodic_is_not_fitted_again(astray, machine, told) -> None:
    assert law_by_both(*told(machine, LARGE_V)) is None
    workbench, nominal, law, held_out = astray
    sine = replace(law, law=replace(law.law, terms=(), frequency=1.0))
    assert law_by_both(workbench, nominal, sine, held_out) is None


def test_what_was_tried_before_is_held_against_the_same_parts(astray) -> None:
    workbench, nominal, law, held_out = astray
    both = law_by_both(workbench, nominal, law, held_out)
    found = Search()
    found.keep(nominal)
    counted = sum(experiment.counted for experiment in held_out)
    judged = (Judged(nominal, workbench.residuals(nominal, held_out, workbench.fine), counted, 1.0),)
    known = Known(workbench, found, tuple(held_out), judged, conclude(judged), interrupted=False)
    again = known_by_both(known, both, lambda text: None)
    training, kept = both.parts
    assert again.found.law is both
    assert [e.used.sum() for e in again.held_out] == [e.used.sum() for e in kept]
    assert again.found.baseline.fit.counted == sum(experiment.counted for experiment in training)
    # the numbers of the small voltages are not those of all
    there = workbench.residuals(nominal, kept, workbench.fine)
    [refitted] = again.judged
    assert float(refitted.held_out @ refitted.held_out) < float(there @ there)
    assert refitted.over_noise > PREDICTED
