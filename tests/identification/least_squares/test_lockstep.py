"""Many fits in lockstep: each ends where it would alone, and where scipy's ends."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.fitting.line_search import Along, lowest_along_each, searched_along
from hydrolek_drake.identification.least_squares.acceptance import Ending
from hydrolek_drake.identification.least_squares.least_squares import fit_from
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.parameter_set import ParameterSet, free_parameters
from hydrolek_drake.identification.problem import Problem


@pytest.fixture
def problem(bench, recorded):
    free = [each for each in free_parameters(bench) if "max_area" in each.path or "viscous" in each.path]
    return Problem(ParameterSet(bench, free), recorded(bench, bench), 1e-3)


def _begun(problem: Problem, by: float) -> Place:
    moving = np.ones(len(problem.parameters), dtype=bool)
    unit = np.clip(problem.parameters.unit() + by, 0.0, 1.0)
    return Place(problem, moving, unit)


def test_fits_end_where_scipys_do_whatever_runs_beside_them(problem) -> None:
    starts = [_begun(problem, by) for by in (0.1, -0.05, 0.2)]
    with ThreadPoolExecutor(2) as pool:
        together = descend(starts, 25, pool, 2, worth=1e-3, share=0.0)
        alone = [descend([start], 25, pool, 2, worth=1e-3, share=0.0)[0] for start in starts]
    reference = fit_from(problem, starts[0].unit, most_steps=40, tolerance=1e-9)
    for place, same in zip(together, alone, strict=True):
        np.testing.assert_array_equal(place.unit, same.unit)
        assert place.objective == pytest.approx(reference.objective, abs=1.0)


def test_what_is_held_stays(problem) -> None:
    start = _begun(problem, 0.1)
    moving = start.moving.copy()
    moving[0] = False
    with ThreadPoolExecutor(2) as pool:
        [ended] = descend([Place(problem, moving, start.unit)], 5, pool, 2)
    assert ended.unit[0] == start.unit[0]
    assert np.all(ended.unit[1:] != start.unit[1:])


def test_a_fit_stays_within_its_ranges(problem) -> None:
    with ThreadPoolExecutor(2) as pool:
        [ended] = descend([_begun(problem, 1.0)], 5, pool, 2)
    assert np.all((0.0 <= ended.unit) & (ended.unit <= 1.0))


def test_a_search_along_one_parameter_takes_the_others_with_it(problem) -> None:
    """From a bottom nothing is lower; from a place beside it the search comes nearly to the bottom in one go."""
    with ThreadPoolExecutor(2) as pool:
        [bottom] = descend([_begun(problem, 0.05)], 25, pool, 2, worth=1e-3, share=0.0)
        [led] = descend([_begun(problem, 0.05)], 1, pool, 2)
        values = np.linspace(0.05, 0.95, 19)
        [same] = searched_along([bottom], [Along(0, values)], pool, 2)
        away = Place(problem, led.moving, led.unit + 0.2 * np.eye(led.unit.size)[0], slopes=led.slopes)
        [away] = descend([away], 0, pool, 2)
        [found] = searched_along([away], [Along(0, np.append(values, bottom.unit[0]))], pool, 2)
    assert same is bottom
    assert found.objective < 0.2 * away.objective


def test_who_would_not_catch_up_with_the_steps_that_are_left_ends(problem) -> None:
    """The nearer the end of a race, the more a step must promise; the best one goes on."""
    with ThreadPoolExecutor(2) as pool:
        [best] = descend([_begun(problem, 0.05)], 25, pool, 2, worth=1e-3, share=0.0)
        [behind] = descend([_begun(problem, 0.2)], 0, pool, 2)
    distance = behind.objective - best.objective
    for steps in (10, 2):
        ending = Ending(0.0, 0.0, 0.01, best.objective, best.objective, steps)
        assert ending.least(behind) == pytest.approx(distance / steps)
        assert ending.least(best) == 0.0


def test_a_fit_that_would_not_come_to_what_is_known_already_ends(problem) -> None:
    """Alone it is the best of its race and goes on to the bottom."""
    with ThreadPoolExecutor(2) as pool:
        [bottom] = descend([_begun(problem, 0.2)], 25, pool, 2, behind=0.01)
        [begun] = descend([_begun(problem, 0.2)], 0, pool, 2)
        goal = -100.0 * begun.objective  # farther away than any step leads
        [ended] = descend([_begun(problem, 0.2)], 25, pool, 2, behind=0.01, goal=goal)
    assert ended.ended and ended.objective == begun.objective
    assert bottom.objective < 0.1 * begun.objective


class Threshold(Problem):
    """What the first number is beyond a place makes no difference."""

    BEYOND = 0.2
    """From where it is right [ranges]."""

    def runs(self, unit):
        most = self.parameters.unit()[0] + self.BEYOND
        return super().runs(np.where(np.arange(unit.size) == 0, np.minimum(unit, most), unit))


def test_a_number_that_acts_from_a_threshold_on_is_found_from_its_other_side(problem) -> None:
    """Below the threshold it has no slope, and a fit that begins there stays."""
    hidden = Threshold(problem.parameters, problem.experiments, problem.longest_step)
    with ThreadPoolExecutor(2) as pool:
        [led] = descend([_begun(problem, 0.05)], 25, pool, 2, worth=1e-3, share=0.0)
        beyond = np.where(np.arange(led.unit.size) == 0, led.unit[0] + 0.3, led.unit)
        [stuck] = descend([Place(hidden, led.moving, beyond)], 10, pool, 2)
        lowest = lowest_along_each(stuck, pool, 2)
        [ended] = descend([lowest], 10, pool, 2)
        same = lowest_along_each(led, pool, 2)
    assert stuck.objective > 2.0 * led.objective
    assert ended.objective == pytest.approx(led.objective, rel=0.05)
    assert same.objective == led.objective


def test_how_one_observers_fit_ended_does_not_stop_the_next_ones(problem) -> None:
    """A fit that ends in a local minimum has tried ever shorter steps; another observer knows no such minimum."""
    with ThreadPoolExecutor(2) as pool:
        [observed] = descend([_begun(problem.pulled(0.1), 0.1)], 0, pool, 2)
        stuck = replace(observed, damping=1e12, ended=True)
        [begun] = descend([stuck.at(problem)], 0, pool, 2)
        [ended] = descend([stuck.at(problem)], 5, pool, 2)
    assert ended.objective < 0.5 * begun.objective


class Leaping(Problem):
    """Residuals that change by leaps in each parameter and are level between them."""

    WIDTH = 5e-4
    """Between leaps [ranges]."""

    def runs(self, unit):
        return super().runs(np.clip(np.round(unit / self.WIDTH) * self.WIDTH, 0.0, 1.0))


@pytest.mark.parametrize(("wide", "arrives"), [((0.03, 0.01, 0.001), True), ((), False)])
def test_a_fit_of_residuals_that_leap_is_led_by_wide_differences(
    bench, recorded, problem, wide, arrives
) -> None:
    leaping = Leaping(problem.parameters, recorded(bench, bench), 1e-3, wide=wide)
    with ThreadPoolExecutor(2) as pool:
        [begun] = descend([_begun(leaping, 0.2)], 0, pool, 2)
        [ended] = descend([_begun(leaping, 0.2)], 40, pool, 2)
    noise = float(leaping.counted)
    assert begun.objective > 20.0 * noise
    assert (ended.objective < 2.0 * noise) is arrives
