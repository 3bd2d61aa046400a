"""An effect that promises nothing beside a bent nominal model, and effects that a law would stand for."""

import copy
import functools
import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import SimpleNamespace

import pytest

from hydrolek_drake.diagnosis import again, overlooked
from hydrolek_drake.diagnosis.again import by_what_was_overlooked, in_place_of_law
from hydrolek_drake.diagnosis.attempt import Known
from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.conclusion import EXPLAINED, conclude
from hydrolek_drake.diagnosis.effort import ABOVE_NOISE, MORE_AHEAD
from hydrolek_drake.diagnosis.evidence import judge
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

DRIFT = "sensor.drift"
TRIED = (DRIFT, "sensor.nonlinearity", "supply.pressure_droop")
NOISY_deg = 0.25
SLOW_rad_per_min = 0.025


@pytest.fixture(scope="module")
def nominal_alone(bench, recorded):
    """(effects of the machine) -> what is known where no effect promised anything, and the candidates."""
    pool = ThreadPoolExecutor(2)

    @functools.cache
    def searched(effects):
        machine = dict(effects)
        training = recorded(bench.with_values(machine), bench, noise_deg=NOISY_deg)
        held_out = recorded(bench.with_values(machine), bench, seed=7, noise_deg=NOISY_deg)
        candidates = [
            c
            for c in candidates_of(bench, "joint", natural_scales(bench, "joint", training))
            if c.id in TRIED
        ]
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        found = Search()
        found.keep(fit_baseline(workbench))
        judged = judge(workbench, found, held_out)
        known = Known(workbench, found, tuple(held_out), tuple(judged), conclude(judged), False)
        return known, candidates

    def make(machine):
        known, candidates = searched(tuple(machine.items()))
        return replace(known, found=copy.deepcopy(known.found)), candidates

    yield make
    pool.shutdown()


@pytest.mark.long("takes a third of a minute")
def test_what_promised_nothing_is_found_where_the_held_out_data_leave_more_than_noise(nominal_alone) -> None:
    known, candidates = nominal_alone({f"effects.{DRIFT}.rate_rad_per_min": SLOW_rad_per_min})
    nominal = known.conclusion.best
    assert nominal.hypothesis.fit.over_noise <= EXPLAINED and nominal.over_noise > MORE_AHEAD
    second = by_what_was_overlooked(known, candidates, lambda text: None)
    best = second.conclusion.best
    assert [c.id for c in best.hypothesis.effects] == [DRIFT] and best.over_noise < MORE_AHEAD
    rate = best.hypothesis.values[f"joints.joint.effects.{DRIFT}.rate_rad_per_min"]
    assert rate == pytest.approx(SLOW_rad_per_min, rel=0.1)


def test_what_promises_enough_is_found_whatever_the_held_out_data_leave(nominal_alone, monkeypatch) -> None:
    known, candidates = nominal_alone({f"effects.{DRIFT}.rate_rad_per_min": SLOW_rad_per_min})
    monkeypatch.setattr(overlooked, "MORE_AHEAD", math.inf)
    better = overlooked.overlooked(known.bench, known.conclusion.best, candidates, known.held_out)
    assert [c.id for c in better[0].effects] == [DRIFT]


def test_a_healthy_machine_is_not_asked_for_more(nominal_alone) -> None:
    known, candidates = nominal_alone({})
    assert known.conclusion.best.over_noise <= MORE_AHEAD
    assert by_what_was_overlooked(known, candidates, lambda text: None) is None


def test_what_promises_nothing_is_found_beside_the_rig_s_own_numbers(nominal_alone, monkeypatch) -> None:
    known, candidates = nominal_alone({f"effects.{DRIFT}.rate_rad_per_min": SLOW_rad_per_min})
    assert known.conclusion.best.over_noise > ABOVE_NOISE
    monkeypatch.setattr(overlooked, "scores_of", lambda *given: [])
    monkeypatch.setattr(overlooked, "MORE_AHEAD", math.inf)  # nothing is begun beside the model's own numbers
    better = overlooked.overlooked(known.bench, known.conclusion.best, candidates, known.held_out)
    assert [c.id for c in better[0].effects] == [DRIFT]
    monkeypatch.setattr(overlooked, "ABOVE_NOISE", math.inf)
    assert overlooked.overlooked(known.bench, known.conclusion.best, candidates, known.held_out) == []


def test_beside_its_own_numbers_a_healthy_machine_lacks_nothing_either(nominal_alone, monkeypatch) -> None:
    known, candidates = nominal_alone({})
    monkeypatch.setattr(overlooked, "ABOVE_NOISE", 0.0)
    assert by_what_was_overlooked(known, candidates, lambda text: None) is None


def test_a_model_in_a_hollow_is_led_out_of_it(nominal_alone) -> None:
    """As if the search had ended with a valve that opens 3 % less."""
    known, candidates = nominal_alone({})
    nominal = known.found.baseline
    area = "joints.joint.valve.max_area_a"
    bent = replace(nominal, values={**nominal.values, area: 0.97 * nominal.values[area]})
    judged = replace(known.conclusion.best, hypothesis=bent)
    led = overlooked.overlooked(known.bench, judged, candidates, known.held_out)[0]
    assert led.effects == ()
    assert led.values[area] == pytest.approx(nominal.values[area], rel=1e-3)


def _law(over_noise: float, ahead: float) -> SimpleNamespace:
    return SimpleNamespace(fit=SimpleNamespace(over_noise=over_noise), held_out_over_noise=ahead)


def test_effects_stand_in_place_of_a_law_only_if_they_leave_less_of_both(nominal_alone, monkeypatch) -> None:
    known, candidates = nominal_alone({})
    elsewhere = [known.found.baseline]
    monkeypatch.setattr(again, "deepest", lambda *given, **how: elsewhere)
    monkeypatch.setattr(again, "_from_elsewhere", lambda known, candidates, fits, say: fits)

    def asked(law):
        return in_place_of_law(known, law, candidates, lambda text: None)

    left, ahead = known.found.baseline.fit.over_noise, known.judged[0].over_noise
    assert asked(_law(1.1 * left, 1.1 * ahead)) is elsewhere
    assert asked(_law(0.9 * left, 0.9 * ahead)) is None
    elsewhere = []  # nothing explains the training data
    assert asked(_law(1.1 * left, 1.1 * ahead)) is None
