"""Unknown inputs: where a mismatch enters, its course, and the law that it follows."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.sparse import csc_matrix

from hydrolek_drake.diagnosis.laws.law import FRICTIONS
from hydrolek_drake.diagnosis.locating.knot_responses import squared
from hydrolek_drake.diagnosis.locating.terms_for import Slightly, terms_seen
from hydrolek_drake.diagnosis.locating.unknown_input import unknown_inputs
from hydrolek_drake.diagnosis.structures.inputs import Input, inputs_of
from hydrolek_drake.diagnosis.structures.term_forms import TERMS, law_record, span_of
from hydrolek_drake.diagnosis.structures.weighing import weighted_by
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

SHAKING_NM, SHAKING_HZ = 60.0, 1.3
OBSERVER_S = 0.3


@pytest.fixture
def seen_of(bench, recorded, fitted):
    """(how it was recorded) -> what an observer around the bench's own numbers saw, and its joint's record and span."""

    def make(**how):
        training = recorded(bench, bench, pressure_noise_Pa=2e4, **how)
        with ThreadPoolExecutor(2) as pool:
            workbench = Workbench(bench, free_parameters(bench), training, pool, 2)
            nominal = fitted(workbench, rounds=0)
            workbench.training = tuple(weighted_by(workbench, nominal, training))
            scales = natural_scales(bench, "joint", training)
            inputs = inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad")
            probes = ("command", "supply", "cylinder", "load", "sensor")
            wanted = [Slightly(i) for i in inputs if i.probe in probes]
            seen = unknown_inputs(workbench, nominal, nominal.values, wanted, OBSERVER_S)
        record = bench.records()[0]
        return seen, record, span_of(seen.signals, record, 12.0, "rad")

    return make


def test_what_shakes_the_load_is_seen_there_with_its_course(seen_of) -> None:
    seen, record, span = seen_of(unknown=("load", SHAKING_NM), unknown_Hz=SHAKING_HZ)
    estimates = {u.input.probe: u.estimated() for u in seen.unknowns}
    most = estimates["load"]
    other = {key for key, each in estimates.items() if each.evidence > 0.1 * most.evidence}
    assert other <= {
        "load",
        "cylinder",
    }  # a force at the rod is a moment at the joint, but for the lever's change
    assert max(each.evidence for each in estimates.values()) < 1.001 * most.evidence
    course = SHAKING_NM * np.sin(2.0 * np.pi * SHAKING_HZ * most.unknown.times)
    slope, _ = np.polyfit(course, most.course, 1)  # what a constant does, the machine's own numbers undo
    assert slope == pytest.approx(1.0, abs=0.1)
    assert np.corrcoef(most.course, course)[0, 1] > 0.9
    (_, best), *_ = terms_seen(seen, record, "joint", span)
    assert best.input.probe == "load" and best.term is None
    assert best.frequency == pytest.approx(SHAKING_HZ, abs=0.02)
    assert np.hypot(*best.seen) * best.input.scale == pytest.approx(SHAKING_NM, rel=0.15)


def test_a_dry_friction_is_seen_as_one_beside_a_viscous_one_that_is_free(bench, seen_of) -> None:
    def friction(experiment) -> np.ndarray:
        signals = experiment.simulate(bench.records()).signals
        span = span_of([signals], bench.records()[0], 12.0, "rad")
        form = next(term for term in TERMS if term.name == "sign(v)")
        return law_record("load", span, form, -30.0)

    seen, record, span = seen_of(law=friction)
    (_, best), *_ = terms_seen(seen, record, "joint", span)
    assert best.input.stage in ("load", "cylinder")
    assert best.term is not None and best.term.speed in FRICTIONS


def test_a_machine_that_lacks_nothing_promises_next_to_nothing(seen_of) -> None:
    seen, record, span = seen_of()
    counted = 3 * 1200
    assert seen.unknowns[0].left == pytest.approx(counted, rel=0.25)
    assert (
        max(gain for gain, _ in terms_seen(seen, record, "joint", span)) < 0.1 * counted
    )  # the error of the integration


@pytest.mark.parametrize("covered", [7, 40, 300])
def test_products_of_responses_are_those_of_the_whole_matrices(covered: int) -> None:
    """Responses that overlap with few, with some, and with all others; two channels one after the other."""
    generator = np.random.default_rng(3)
    samples, knots = 400, 200
    whole = np.zeros((2 * samples, knots))
    for knot in range(knots):
        rows = np.arange(2 * knot, min(2 * knot + covered, samples))
        for channel in range(2):
            whole[channel * samples + rows, knot] = generator.standard_normal(rows.size)
    np.testing.assert_allclose(squared(csc_matrix(whole)), whole.T @ whole, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["sign(v)", "z sign(v)", "v"])
@pytest.mark.parametrize("stage", ["cylinder", "load"])
def test_of_frictions_only_the_one_that_is_in_the_list_is_no_law(name: str, stage: str) -> None:
    force = Input(stage, stage, "force added", "N", 100.0)
    [form] = [term for term in TERMS if term.name == name and term.meant_for(force)]
    # the joint's own is only a candidate where a link weighs, or there is no oil
    assert form.is_listed(force) is (name == "sign(v)" and stage == "cylinder")
