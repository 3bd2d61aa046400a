"""The score test: it sees what is planted, and nothing where nothing is."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.gains import GAIN_NEEDED
from hydrolek_drake.diagnosis.score import VISIBLE, Score, gain_of_pair, scores_of
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

NOMINAL = ["supply.pressure", "valve.max_area_a", "load.gravity_cos", "amplifier.max_current_a"]


def _scores(bench, experiments):
    with ThreadPoolExecutor(2) as pool:
        work = Workbench(bench, free_parameters(bench, NOMINAL), experiments, pool)
        fitted = work.fit((), {}, work.fine, 12)
        candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
        return scores_of(work, fitted, candidates, work.fine)


def test_nothing_is_seen_where_nothing_is(bench, recorded) -> None:
    # chance of more than 12 for one parameter: 0.05 %; some twenty effects, some of them at two or three sizes
    assert _scores(bench, recorded(bench, bench, seed=4))[0].gain < GAIN_NEEDED + 4.0


@pytest.mark.parametrize(
    ("effect_id", "parameter"),
    [("cylinder.cross_port_leakage", "conductance_m3_per_s_Pa"), ("sensor.nonlinearity", "amplitude_rad")],
)
def test_the_visible_size_is_where_the_gain_says_it_is(bench, recorded, effect_id, parameter) -> None:
    nothing = {s.candidate.id: s for s in _scores(bench, recorded(bench, bench, seed=5))}
    size = 2.0 * nothing[effect_id].visible_from
    machine = bench.with_values({f"effects.{effect_id}.{parameter}": size})
    seen = {s.candidate.id: s for s in _scores(bench, recorded(machine, bench, seed=5))}
    # twice the visible size: four times its gain, within the scatter of noise of three deviations
    expected = 4.0 * VISIBLE
    assert abs(seen[effect_id].gain ** 0.5 - expected**0.5) < 3.5


def _held_against(rest: np.ndarray, change: np.ndarray) -> Score:
    return Score(None, 0.0, {}, (), 0.0, 0.0, change, rest)


def test_two_effects_that_add_up_to_what_is_left_promise_all_of_it() -> None:
    first, second = np.eye(5)[:2]
    rest = -(3.0 * first + 0.01 * second)
    assert gain_of_pair(
        _held_against(rest, 1e3 * first), _held_against(rest, 1e-3 * second)
    ) == pytest.approx(rest @ rest)


def test_an_effect_that_would_have_to_be_negative_promises_nothing_in_a_pair() -> None:
    first, second = np.eye(5)[:2]
    rest = -3.0 * first + 2.0 * second
    assert gain_of_pair(_held_against(rest, first), _held_against(rest, second)) == pytest.approx(9.0)


def test_a_third_direction_near_both_promises_more_than_either_and_less_than_the_pair() -> None:
    first, second = np.eye(5)[:2]
    between = (first + second) / np.sqrt(2.0)
    rest = -2.0 * first - 2.0 * second + 0.5 * np.eye(5)[2]
    held = {
        n: _held_against(rest, c) for n, c in (("first", first), ("second", second), ("between", between))
    }
    nothing = _held_against(rest, np.zeros(5))
    alone = {name: gain_of_pair(score, nothing) for name, score in held.items()}
    assert alone["between"] > alone["first"] == pytest.approx(4.0)
    assert gain_of_pair(held["first"], held["second"]) == pytest.approx(8.0)
