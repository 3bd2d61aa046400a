"""Terms of laws as additions: a rollout does with them what it does with a law that is given beside the record."""

import numpy as np
import pytest

from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.inputs import inputs_of
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm, WithTerms
from hydrolek_drake.diagnosis.structures.term_forms import TERMS, law_record, span_of
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters


@pytest.fixture
def machine(bench, recorded):
    [experiment] = recorded(bench, bench)
    scales = natural_scales(bench, "joint", [experiment])
    inputs = {i.probe: i for i in inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad")}
    signals = experiment.simulate(bench.records()).signals
    return experiment, inputs, span_of([signals], bench.records()[0], 12.0, "rad")


@pytest.mark.parametrize(("probe", "name"), [("cylinder", "near sign(v)"), ("sensor", "z^2")])
def test_a_term_does_what_the_law_does(bench, machine, probe, name) -> None:
    experiment, inputs, span = machine
    form = next(term for term in TERMS if term.name == name and term.meant_for(inputs[probe]))
    term = LawTerm(inputs[probe], form, "joint", span)
    parameters = WithTerms(bench, free_parameters(bench), [term])
    size = 0.1 * inputs[probe].scale
    with_term = experiment.simulate(parameters.records(parameters.unit({term.size_path: size}))).signals
    with_law = experiment.simulate(bench.records(), law=law_record(probe, span, form, size)).signals
    np.testing.assert_allclose(with_term.reading, with_law.reading, rtol=0.0, atol=1e-9)


def test_a_term_without_size_changes_nothing(bench, machine) -> None:
    experiment, inputs, span = machine
    terms = [
        LawTerm(inputs["load"], None, "joint", span, 1.3),
        LawTerm(inputs["load"], TERMS[3], "joint", span),
    ]
    parameters = WithTerms(bench, free_parameters(bench), terms)
    plain = experiment.simulate(bench.records()).signals
    np.testing.assert_allclose(
        experiment.simulate(parameters.records(parameters.unit())).signals.reading,
        plain.reading,
        rtol=0.0,
        atol=1e-12,
    )
    assert set(parameters.values(parameters.unit())) == set(parameters.paths)


def test_each_term_has_a_row_of_its_own(bench, machine) -> None:
    _, inputs, span = machine
    terms = [LawTerm(inputs["load"], TERMS[k], "joint", span) for k in (0, 3)]
    parameters = WithTerms(bench, free_parameters(bench), terms)
    unit = parameters.unit({terms[0].size_path: 5.0, terms[1].size_path: 7.0})
    law = parameters.records(unit)["law"][0]
    assert law["term_1"]["sine"] == pytest.approx(5.0) and law["term_2"]["sine"] == pytest.approx(7.0)


def test_a_force_on_the_other_side_of_the_linkage_moves_the_joint_as_much(bench, machine) -> None:
    experiment, inputs, span = machine
    form = next(term for term in TERMS if term.name == "sign(v)" and term.meant_for(inputs["cylinder"]))
    rod = LawTerm(inputs["cylinder"], form, "joint", span, across=inputs["load"])
    values = {**rod.neutral(), rod.size_path: -0.05 * inputs["cylinder"].scale}
    joint, told = rod.moved_across(values)
    assert joint.input.probe == "load" and joint.moved_across(told) == (rod, values)

    def moved(term, at) -> np.ndarray:
        parameters = WithTerms(bench, free_parameters(bench), [term])
        plain = experiment.simulate(bench.records()).signals.reading
        return experiment.simulate(parameters.records(parameters.unit(at))).signals.reading - plain

    at_rod, at_joint = moved(rod, values), moved(joint, told)
    assert np.std(at_rod) > 1e-4
    # the lever changes by a third over the travel, so that they are not the same force everywhere
    assert np.corrcoef(at_rod, at_joint)[0, 1] > 0.95
    assert np.std(at_joint) == pytest.approx(np.std(at_rod), rel=0.3)


def test_what_is_no_force_has_no_other_side(machine) -> None:
    _, inputs, span = machine
    term = LawTerm(inputs["supply"], None, "joint", span, 1.3)
    assert term.moved_across(term.neutral()) is None


def test_a_law_is_no_finding_where_the_effect_that_does_the_same_is_none(bench, machine) -> None:
    """A shifted null and a voltage before the amplifier; a friction and a force at the rod."""
    experiment, inputs, span = machine
    candidates = {
        c.id: c for c in candidates_of(bench, "joint", natural_scales(bench, "joint", [experiment]))
    }
    for probe, effect in (("command", "valve.asymmetric_overlap"), ("cylinder", "cylinder.coulomb_friction")):
        law, listed = LawTerm(inputs[probe], TERMS[0], "joint", span), candidates[effect]
        for times, told in ((0.99, False), (1.01, True)):
            assert law.says_something({law.size_path: times * law.beneath}) is told
            assert listed.says_something({listed.size_path: times * listed.beneath}) is told
