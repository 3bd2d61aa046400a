"""Laws for physics in no list: what they mean, and how they are told."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.laws.law import FoundLaw, Law
from hydrolek_drake.diagnosis.report.words import where_sentence
from hydrolek_drake.diagnosis.structures.inputs import Input
from hydrolek_drake.diagnosis.structures.term_forms import TERMS, Term, law_record, law_records, span_of
from hydrolek_drake.physics.law import BELOW, BEYOND, NEAR, Seen, law_value
from hydrolek_drake.rigs.machine.short_law import read_law, terms_of


def test_a_law_means_the_same_in_a_shorter_and_gentler_recording(bench, recorded) -> None:
    brisk, gentle = (recorded(bench, bench, largest_V=volts)[0] for volts in (9.0, 3.0))
    runs = [e.simulate(bench.records()).signals for e in (brisk, gentle)]
    span = span_of(runs[:1], bench.records()[0], 12.0, "rad")
    law = law_record("load", span, Term(("load",), speed="v"), 5.0)[0]
    for run in runs:
        told = [law_value(law, Seen(0.0, 0.0, w, 0.0, 0.0, 0.0, 0.0, 0.0)) for w in run.velocity]
        assert told == pytest.approx(5.0 * run.velocity / np.abs(runs[0].velocity).max())
    assert np.abs(runs[1].velocity).max() < 0.8 * np.abs(runs[0].velocity).max()


def test_a_law_says_what_its_letters_mean(bench) -> None:
    run = SimpleNamespace(
        position=np.radians([10.0, 40.0]), velocity=np.array([0.0, 0.5]), spool=np.array([0.0, 1e-3])
    )
    span = span_of([run], bench.records()[0], 20.0, "rad")
    given = Input("load", "load", "moment added at the joint", "N m", 100.0)

    def told(*terms, values):
        law = Law(given, terms, 0.0)
        found = FoundLaw(law, np.array(values), {}, None, 1.0, np.zeros(0), span, (), "joint")
        return found.equation(), where_sentence(found)

    friction = Term((), speed="sign(v)")
    assert told(friction, Term((), place="z", speed="sign(v)"), values=(-30.0, 12.0)) == (
        "moment added at the joint = -30 N m * sign(v) + 12 N m * z sign(v)",
        " Here z is the position, -1 at 10 deg and 1 at 40 deg; v is the joint's speed.",
    )
    assert told(Term((), speed="v |v|"), Term(()), values=(-3.0, -2.0)) == (
        "moment added at the joint = -3 N m * v |v| - 2 N m",
        " Here v is the joint's speed over 28.6 deg/s.",
    )
    assert told(Term((), place=NEAR, speed="sign(v)"), values=(-7.0, 0.2, 0.5)) == (
        "moment added at the joint = -7 N m * near(28 deg, 7.5 deg) sign(v)",
        " Here near(c, w) is 1 at a position of c and falls to 0 over w to either side; v is the joint's speed.",
    )
    assert told(Term(()), values=(5.0,)) == ("moment added at the joint = 5 N m", "")


@pytest.mark.parametrize(("phase", "told"), [(-0.5, "- 0.50"), (0.25, "+ 0.25")])
def test_a_periodic_law_is_told_in_units_that_people_read(phase, told) -> None:
    given = Input("supply", "supply", "added to the supply pressure", "Pa", 5e6)
    values = np.array([2.5e6 * np.cos(phase), 2.5e6 * np.sin(phase), 1.7])
    law = FoundLaw(Law(given, (), 1.7), values, {}, None, 1.0, np.zeros(0), None, (), "joint")
    assert law.equation() == f"added to the supply pressure = 2.5 MPa * sin(2 pi 1.7 Hz t {told})"


def test_what_takes_a_time_depends_on_nothing() -> None:
    ramp = Input("command", "ramp", "time for each volt", "s/V", 0.03, one_sided=True)
    assert [term for term in TERMS if term.meant_for(ramp)] == [Term(TERMS[0].stages)]


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
    law = Law(given, (term,), 0.0)
    joint = replace(span.joint, low=0.0, high=np.radians(60.0))
    found = FoundLaw(
        law, np.array([30.0, -0.5]), {}, None, 1.0, np.zeros(0), replace(span, joint=joint), (), "joint"
    )
    assert found.equation() == "moment added at the joint = 30 N m * below(15 deg)"
    assert where_sentence(found) == (
        " Here below(c) is 0 down to a position of c and grows as it falls further, by 1 over 30 deg."
    )
