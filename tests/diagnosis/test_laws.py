"""Laws for physics in no list: what they mean, and that a planted one is found at its stage."""

from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.effort import POLISH
from hydrolek_drake.diagnosis.enlarged import enlarged_rig
from hydrolek_drake.diagnosis.law_fit import begun_from_afar, fitted, glance
from hydrolek_drake.diagnosis.law_inputs import Input, inputs_of
from hydrolek_drake.diagnosis.law_problem import FoundLaw, Law, LawProblem
from hydrolek_drake.diagnosis.law_search import promising
from hydrolek_drake.diagnosis.law_terms import gain_along
from hydrolek_drake.diagnosis.laws import Term, law_record, span_of
from hydrolek_drake.diagnosis.panels import after
from hydrolek_drake.diagnosis.score import gain_of
from hydrolek_drake.diagnosis.words import where_sentence
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.physics.law import NEAR, Seen, law_value
from hydrolek_drake.station.simulation import command_source, initial_context
from hydrolek_drake.station.simulation import run as run_diagram
from hydrolek_drake.station.station import make_station

HOSE = 8e-13
"""Capacity of a hose on side A [m^3/Pa]: 5 to 10 times that of the bench's oil."""

RIPPLE, RIPPLE_HZ = 2e6, 3.104
"""Of the supply pressure [Pa]; midway between two frequencies that lie half a cycle over 12 s apart."""


def _inputs(bench, training) -> tuple[Input, ...]:
    """The unknown inputs of the bench's joint."""
    return inputs_of(natural_scales(bench, "joint", training), bench.value("supply.pressure"), 10.0, "rad")


def test_a_law_means_the_same_in_a_shorter_and_gentler_recording(bench, recorded) -> None:
    brisk, gentle = (recorded(bench, bench, largest_V=volts)[0] for volts in (9.0, 3.0))
    runs = [e.simulate(bench.records()).signals for e in (brisk, gentle)]
    span = span_of(runs[:1], bench.records()[0], 12.0, "rad")
    law = law_record("load", span, Term(("load",), speed="v"), 5.0)[0]
    for run in runs:
        told = [law_value(law, Seen(0.0, 0.0, w, 0.0, 0.0, 0.0, 0.0, 0.0)) for w in run.velocity]
        assert told == pytest.approx(5.0 * run.velocity / np.abs(runs[0].velocity).max())
    assert np.abs(runs[1].velocity).max() < 0.8 * np.abs(runs[0].velocity).max()


def test_a_ripple_is_found_between_the_frequencies_that_are_scanned(bench, recorded) -> None:
    training = recorded(bench, bench, largest_V=7.0, unknown=("supply", RIPPLE), unknown_Hz=RIPPLE_HZ)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = workbench.refit(fit_baseline(workbench), workbench.fine, POLISH)
        records = workbench.parameters(()).records(nominal.fit.unit)
        signals = [e.simulate(records, workbench.fine).signals for e in training]
        span = span_of(signals, records[training[0].index], 12.0, "rad")
        scales = natural_scales(bench, "joint", training)
        inputs = inputs_of(scales, bench.value("supply.pressure"), 10.0, training[0].channels[0].unit)
        laws = promising(
            workbench, nominal, [i for i in inputs if i.stage == "supply"], span, 4 * workbench.fine
        )
    assert nominal.fit.over_noise > 2.0
    # told by free rollouts, and by pulled ones, whose fits reach half a cycle over the recording
    for pulled, cycles in ((False, 0.15), (True, 0.5)):
        ripple = max((law for law in laws if law.pulled is pulled), key=lambda law: law.gain)
        assert ripple.periodic
        assert ripple.frequency == pytest.approx(RIPPLE_HZ, abs=cycles / 12.0)
        assert np.hypot(*ripple.amplitudes) * ripple.input.scale == pytest.approx(RIPPLE, rel=0.5)


def test_a_ripple_beyond_what_is_searched_at_first_is_fitted_all_the_same(bench, recorded) -> None:
    kept = {"largest_V": 7.0, "pressure_noise_Pa": 2e4, "unknown_Hz": RIPPLE_HZ}
    supply = bench.value("supply.pressure")
    large = 0.4 * supply
    training, held_out = (recorded(bench, bench, seed=s, unknown=("supply", large), **kept) for s in (1, 2))
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        inputs = inputs_of(natural_scales(bench, "joint", training), supply, 10.0, "rad")
        narrow = next(given for given in inputs if given.stage == "supply")
        law = Law(narrow, (), RIPPLE_HZ, 0.0, (0.9, 0.0))
        span = span_of(
            [e.simulate(bench.records()).signals for e in training], bench.records()[0], 12.0, "rad"
        )
        begin = ({}, np.array([0.9 * narrow.scale, 0.0, RIPPLE_HZ]))
        found = fitted(workbench, nominal, law, held_out, span, begin, workbench.fine)
    assert narrow.scale < 0.9 * large
    assert found.amplitudes[0] == pytest.approx(large, rel=0.02)
    assert found.fit.over_noise < 1.1
    assert found.held_out_over_noise < 1.1


def test_a_law_with_which_the_rollout_diverged_promises_nothing() -> None:
    rest, good = np.array([1.0, -2.0, 2.0]), np.array([-0.5, 1.0, -1.0])
    assert gain_along(good[:, None], rest)[0] == pytest.approx(9.0)
    assert gain_of(good, rest) == pytest.approx(9.0)
    for bad in (np.nan, np.inf):
        away = np.array([-0.5, bad, bad])
        assert gain_along(np.stack([good, away], axis=1), rest) == (0.0, (0.0, 0.0))
        assert gain_of(away, rest) == 0.0


@pytest.mark.usefixtures("in_less_time", "with_fewer_laws")
def test_a_hose_that_expands_is_found_at_the_fluid(bench, recorded, sought) -> None:
    kept = {"largest_V": 7.0, "pressure_noise_Pa": 2e4, "unknown": ("capacity_a", HOSE)}
    training, held_out = (recorded(bench, bench, seed=seed, **kept) for seed in (1, 2))
    workbench, judged, found = sought(bench, training, held_out)
    assert judged.over_noise > 2.0
    assert found is not None
    assert found.law.input.stage == "fluid"
    assert found.amplitudes[0] == pytest.approx(HOSE, rel=0.1)
    assert found.held_out_over_noise < 1.1
    assert "side A" in found.equation()
    assert not found.equation().endswith("* 1")
    told = SimpleNamespace(bench=workbench, best=judged, law=found, held_out=held_out, step=workbench.fine)
    shown = held_out[0].residuals(after(told, held_out[0]))
    assert np.sqrt(np.mean(shown**2)) == pytest.approx(found.held_out_over_noise, rel=0.02)
    _its_rig_predicts_as_it_does(bench, workbench, judged, found, held_out[0])


def _its_rig_predicts_as_it_does(bench, workbench, judged, found, held_out) -> None:
    """The rig with the law, written and read, in the rollout and in the Drake Diagram."""
    enlarged = enlarged_rig(bench, judged.hypothesis, found)
    with_law, plain = (held_out.simulate(rig.records(), workbench.fine).signals for rig in (enlarged, bench))
    over_noise = np.sqrt(np.mean(held_out.residuals(with_law) ** 2))
    assert over_noise == pytest.approx(found.held_out_over_noise, rel=0.02)
    volts = command_source(held_out.command_times, held_out.command[:, None])
    station = make_station(enlarged, command=volts)
    seconds = float(held_out.time[-1])
    done = run_diagram(station, seconds, context=initial_context(station, np.array([with_law.position[0]])))
    off = done.signals["reading"][: held_out.time.size, 0] - with_law.reading
    assert np.abs(off).max() < 0.05 * np.abs(plain.reading - with_law.reading).max()


def test_a_first_fit_finds_a_law_for_which_the_nominal_model_bent_its_numbers_far(bench, recorded) -> None:
    """Fifty times the oil's own capacity: from where the nominal model was fitted, and from the rig's own numbers."""
    large = 5.0 * HOSE
    training = recorded(bench, bench, largest_V=7.0, pressure_noise_Pa=2e4, unknown=("capacity_a", large))
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        inputs = _inputs(bench, training)
        hose = next(given for given in inputs if given.probe == "capacity_a")
        span = span_of(
            [e.simulate(bench.records()).signals for e in training], bench.records()[0], 12.0, "rad"
        )
        law = Law(hose, (Term(()),), 0.0, 0.0, (0.1 * large / hose.scale,))
        left, _, values = glance(workbench, nominal, law, span, 2.0 * workbench.fine)
    assert nominal.fit.over_noise > 50.0
    assert values == pytest.approx([large], rel=0.02)
    assert left < 1.1**2 * sum(e.counted for e in training)


@pytest.mark.parametrize(
    ("probe", "planted"),
    [("capacity_a", HOSE), ("supply", -RIPPLE), ("cylinder", 900.0), ("flow_force", 0.1)],
)
def test_a_fit_from_afar_begins_near_what_is_there_whatever_was_promised(
    bench, recorded, probe, planted
) -> None:
    """The nearest of the sizes that are tried, or its neighbour, with the right sign."""
    training = recorded(bench, bench, largest_V=7.0, pressure_noise_Pa=2e4, unknown=(probe, planted))
    given = next(given for given in _inputs(bench, training) if given.probe == probe)
    span = span_of([e.simulate(bench.records()).signals for e in training], bench.records()[0], 12.0, "rad")
    promised = -1e-3 * planted / given.scale
    law = Law(given, (Term(()),), 0.0, 0.0, (0.0 if given.one_sided else promised,))
    with ThreadPoolExecutor(1) as pool:
        parameters = Workbench(bench, free_parameters(bench), training, pool).parameters(())
    problem = LawProblem(parameters, training, 1e-3, law, span)
    (begun,) = begun_from_afar(problem, parameters.unit({}))
    assert 1 / 3 < begun / planted < 3


def test_a_law_says_what_its_letters_mean(bench) -> None:
    run = SimpleNamespace(
        position=np.radians([10.0, 40.0]), velocity=np.array([0.0, 0.5]), spool=np.array([0.0, 1e-3])
    )
    span = span_of([run], bench.records()[0], 20.0, "rad")
    given = Input("load", "load", "moment added at the joint", "N m", 100.0)

    def told(*terms, values):
        law = Law(given, terms, 0.0, 0.0, ())
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
    law = FoundLaw(Law(given, (), 1.7, 0.0, ()), values, {}, None, 1.0, np.zeros(0), None, (), "joint")
    assert law.equation() == f"added to the supply pressure = 2.5 MPa * sin(2 pi 1.7 Hz t {told})"
