"""A planted law for physics in no list is found at its stage, with its size, and told as a law there."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.laws.enlarged_rig import enlarged_rig
from hydrolek_drake.diagnosis.report.panels import after
from hydrolek_drake.diagnosis.structures.term_forms import Term, law_records, span_of
from hydrolek_drake.physics.law import BELOW, NEAR
from hydrolek_drake.station.simulation import command_source, initial_context
from hydrolek_drake.station.simulation import run as run_diagram
from hydrolek_drake.station.station import make_station

FEW = ("cylinder.coulomb_friction", "sensor.drift", "supply.pressure_droop")
"""Effects that are candidates too; a matter of time."""

HOSE = 8e-13
"""Capacity of a hose on side A [m^3/Pa]: 5 to 10 times that of the bench's oil."""

SHAKING_NM, SHAKING_HZ = 60.0, 1.3
RIPPLE_PA, RIPPLE_HZ = 2e6, 3.104

LONG = pytest.mark.long("takes most of a minute")


@pytest.fixture
def span(bench, recorded):
    plain = recorded(bench, bench)[0].simulate(bench.records()).signals
    return span_of([plain], bench.records()[0], 12.0, "rad")


@pytest.fixture
def law_of(answer_of):
    """(how it was recorded) -> the answer and its law, which explains all data."""

    def make(planted=None, **how):
        answer = answer_of(planted or {}, FEW, **{"pressure_noise_Pa": 2e4, "own": {}, **how})
        assert answer.conclusion.verdict == "unlisted_physics"
        assert answer.law is not None
        assert answer.known.found.baseline.fit.over_noise > 1.5
        assert answer.law.held_out_over_noise < 1.1
        return answer, answer.law

    return make


@LONG
def test_what_shakes_the_load_is_told_as_a_law_there(law_of) -> None:
    _, law = law_of(unknown=("load", SHAKING_NM), unknown_Hz=SHAKING_HZ)
    assert law.law.input.stage == "load"
    assert law.values[2] == pytest.approx(SHAKING_HZ, abs=0.01)
    assert law.amplitudes[0] == pytest.approx(SHAKING_NM, rel=0.1)


@LONG
@pytest.mark.parametrize("size", [RIPPLE_PA, 6e6])
def test_a_ripple_of_the_supply_is_found(law_of, size) -> None:
    """The larger one lies beyond what is searched at first."""
    _, law = law_of(unknown=("supply", size), unknown_Hz=RIPPLE_HZ, largest_V=7.0)
    assert law.law.input.stage == "supply" and law.law.periodic
    assert law.values[2] == pytest.approx(RIPPLE_HZ, abs=0.02)
    assert law.amplitudes[0] == pytest.approx(size, rel=0.05)


@LONG
def test_a_hose_that_expands_is_found_at_the_fluid(bench, law_of) -> None:
    answer, law = law_of(unknown=("capacity_a", HOSE), largest_V=7.0)
    assert law.law.input.stage == "fluid"
    assert law.amplitudes[0] == pytest.approx(HOSE, rel=0.1)
    assert "side A" in law.equation() and not law.equation().endswith("* 1")
    known, held_out = answer.known, answer.known.held_out[0]
    told = SimpleNamespace(
        bench=known.bench,
        best=answer.conclusion.best,
        law=law,
        held_out=known.held_out,
        step=known.bench.fine,
    )
    shown = held_out.residuals(after(told, held_out))
    assert np.sqrt(shown @ shown / held_out.counted) == pytest.approx(law.held_out_over_noise, rel=0.02)
    enlarged = enlarged_rig(bench, answer.conclusion.best.hypothesis, law)
    with_law, plain = (
        held_out.simulate(rig.records(), known.bench.fine).signals for rig in (enlarged, bench)
    )
    left = held_out.residuals(with_law)
    assert np.sqrt(left @ left / held_out.counted) == pytest.approx(law.held_out_over_noise, rel=0.02)
    volts = command_source(held_out.command_times, held_out.command[:, None])
    station = make_station(enlarged, command=volts)
    context = initial_context(station, np.array([with_law.position[0]]))
    done = run_diagram(station, float(held_out.time[-1]), context=context)
    off = done.signals["reading"][: held_out.time.size, 0] - with_law.reading
    assert np.abs(off).max() < 0.05 * np.abs(plain.reading - with_law.reading).max()


@LONG
@pytest.mark.parametrize(
    ("probe", "path", "size"),
    [
        ("ramp", "joints.joint.command.ramp", 1.0 / 250.0),
        ("coil_time", "joints.joint.amplifier.coil_time", 0.02),
    ],
)
def test_a_ramp_and_slow_coils_are_told_from_each_other(law_of, probe, path, size) -> None:
    _, law = law_of({path: size})
    assert law.law.input.probe == probe
    assert law.values == pytest.approx([size], rel=0.1)


@LONG
@pytest.mark.parametrize(("side", "share"), [("back_a", -0.1), ("back_b", -0.2)])
def test_a_throttle_in_the_way_back_is_told_from_a_smaller_valve(law_of, span, side, share) -> None:
    """Of either side alone: what drives the rod one way is as it was."""
    throttle = law_records(side, span, (Term(()),), (share,))
    _, law = law_of(law=lambda _: throttle)
    assert law.law.input.probe == side
    assert law.values == pytest.approx([share], rel=0.05)


@LONG
def test_hoses_that_pull_tight_are_found_with_the_place_where_they_do(law_of, span) -> None:
    """Between the places where a search begins."""
    tight = law_records("load", span, (Term((), place=BELOW, centre=-0.2),), (120.0,))
    _, law = law_of(law=lambda _: tight)
    assert law.law.input.stage == "load"
    assert [term.place for term in law.law.terms] == [BELOW]
    assert law.values[0] == pytest.approx(120.0, rel=0.1)
    assert law.values[1] == pytest.approx(-0.2, abs=0.05)


@LONG
def test_where_a_bore_is_scored_and_how_far_is_found(law_of, span) -> None:
    """Between two of the places where a search begins, and narrower than it begins."""
    rubbing = Term((), place=NEAR, speed="sign(v)", centre=0.35, reach=0.3)
    scored = law_records("cylinder", span, (rubbing,), (-1500.0,))
    _, law = law_of(law=lambda _: scored)
    assert law.law.input.stage == "cylinder"
    assert law.values == pytest.approx([-1500.0, 0.35, 0.3], rel=0.05)


@LONG
def test_a_track_that_is_worn_at_one_place_is_found_at_the_sensor(law_of, span) -> None:
    """Narrower than a search begins, and between two of its places."""
    worn = law_records("sensor", span, (Term((), place=NEAR, centre=0.06, reach=0.18),), (0.015,))
    _, law = law_of(law=lambda _: worn)
    assert law.law.input.stage == "sensor"
    assert law.values == pytest.approx([0.015, 0.06, 0.18], rel=0.05)
