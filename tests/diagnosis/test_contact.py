"""Laws of what begins at a place of the movement: hoses that pull tight, something that is touched."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.diagnosis import law_scan, law_search
from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.gains import GAIN_NEEDED
from hydrolek_drake.diagnosis.law_fit import CHANCE, fitted, glance, left_of_all
from hydrolek_drake.diagnosis.law_inputs import Input, inputs_of
from hydrolek_drake.diagnosis.law_problem import FoundLaw, Law, left_in_all
from hydrolek_drake.diagnosis.law_search import promising
from hydrolek_drake.diagnosis.laws import Term, law_record, law_records, span_of
from hydrolek_drake.diagnosis.words import where_sentence
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.physics.law import BELOW, BEYOND, Seen, law_value
from hydrolek_drake.rigs.short_law import read_law, terms_of


@pytest.fixture
def span(bench, recorded):
    plain = recorded(bench, bench)[0].simulate(bench.records()).signals
    return span_of([plain], bench.records()[0], 12.0, "rad")


def test_it_is_a_spring_with_a_gap(span) -> None:
    """M = -k (q - c) past the angle c, and nothing before it; k by the amplitude over half of the movement."""
    size, centre = -80.0, 0.2
    half = 0.5 * (span.joint.high - span.joint.low)
    begins = span.joint.low + 1.2 * half
    for place, sign in ((BEYOND, 1.0), (BELOW, -1.0)):
        row = law_record("load", span, Term((), place=place, centre=centre), size)[0]
        for q in np.linspace(span.joint.low, span.joint.high, 9):
            past = max(sign * (q - begins), 0.0)
            told = law_value(row, Seen(0.0, q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
            assert told == pytest.approx(size / half * past, abs=1e-9)


@pytest.mark.long("takes a third of a minute")
@pytest.mark.parametrize(("place", "size", "centre"), [(BELOW, 120.0, -0.2)])
def test_hoses_that_pull_tight_are_found_with_the_place_where_they_do(
    bench, recorded, span, place, size, centre, monkeypatch
) -> None:
    """Between the places where a search begins, and told from every other moment at the load."""
    monkeypatch.setattr(law_scan, "HIGHEST_HZ", 1.0)  # a matter of time
    monkeypatch.setattr(law_search, "shaking", lambda *given: [])
    tight = law_records("load", span, (Term((), place=place, centre=centre),), (size,))
    kept = {"pressure_noise_Pa": 2e4, "law": lambda _: tight}
    training, held_out = (recorded(bench, bench, seed=seed, **kept) for seed in (1, 2))
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        scales = natural_scales(bench, "joint", training)
        inputs = inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad")
        load = [given for given in inputs if given.stage == "load"]
        laws = promising(workbench, nominal, load, span, 4.0 * workbench.fine)
        first = sorted((law for law in laws if law.terms), key=lambda law: -law.gain)[:3]
        tried = [(glance(workbench, nominal, law, span, 2.0 * workbench.fine), law) for law in first]
        (_, *at), law = min(tried, key=lambda each: each[0][0])
        found = fitted(workbench, nominal, law, held_out, span, at, workbench.fine)
    assert nominal.fit.over_noise > 2.0
    assert [term.place for term in found.law.terms] == [place]
    assert found.held_out_over_noise < 1.1
    assert found.values[0] == pytest.approx(size, rel=0.1)
    assert found.values[1] == pytest.approx(centre, abs=0.05)


def test_of_all_data_the_right_stage_leaves_least_and_no_more_than_noise(bench, recorded, span) -> None:
    """Fitted to the training data alone a law goes astray ahead, the right one too; angles alone tell little."""
    term, size = Term((), place=BEYOND, centre=0.1), -45.0
    tight = law_records("load", span, (term,), (size,))
    training, held_out = (recorded(bench, bench, seed=seed, law=lambda _: tight) for seed in (1, 2))
    left = {}
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        scales = natural_scales(bench, "joint", training)
        for given in inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad"):
            if given.probe not in ("load", "cylinder"):
                continue
            law = Law(given, (term,), 0.0, 0.0, (-0.1,))
            _, *at = glance(workbench, nominal, law, span, 2.0 * workbench.fine)
            found = fitted(workbench, nominal, law, held_out, span, at, workbench.fine)
            left[given.probe] = left_of_all(workbench, nominal, found, held_out, workbench.fine)
            apart = left_in_all(found.fit, found.held_out_over_noise, held_out)
            assert left[given.probe] < apart + CHANCE * law.size
    counted = sum(experiment.counted for experiment in (*training, *held_out))
    free = len(workbench.nominal) + 2
    assert left["load"] - 2.0 * CHANCE == pytest.approx(counted - free, abs=3.0 * np.sqrt(2.0 * counted))
    assert left["cylinder"] > left["load"] + GAIN_NEEDED  # the lever changes over the stroke


def test_a_rig_file_holds_it_and_the_report_says_what_it_means(span) -> None:
    term = Term((), place=BELOW, centre=-0.5)
    rows = law_records("load", span, (term, replace(term, place=BEYOND, centre=0.5)), (30.0, -20.0))
    written = [each.as_tree() for each in terms_of(rows, ("N m", "rad"), "fitted", "recorded")]
    read = read_law(written, "law", Path("rig.yaml"))
    for seen in (Seen(0.0, q, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0) for q in (span.joint.low, 0.0, span.joint.high)):
        again = [law_value(each.record()[0], seen) for each in read]
        assert again == pytest.approx([law_value(row, seen) for row in rows])
    assert {"centre", "reach"} <= set(written[0]) and "low" not in written[0]
    given = Input("load", "load", "moment added at the joint", "N m", 100.0)
    law = Law(given, (term,), 0.0, 0.0, ())
    joint = replace(span.joint, low=0.0, high=np.radians(60.0))
    found = FoundLaw(
        law, np.array([30.0, -0.5]), {}, None, 1.0, np.zeros(0), replace(span, joint=joint), (), "joint"
    )
    assert found.equation() == "moment added at the joint = 30 N m * below(15 deg)"
    assert where_sentence(found) == (
        " Here below(c) is 0 down to a position of c and grows as it falls further, by 1 over 30 deg."
    )
