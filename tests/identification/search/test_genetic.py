"""Codings, operators and both genetic algorithms."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.search.evaluation import FAILED
from hydrolek_drake.identification.search.genetic.coding import BinaryCoding, IntegerCoding
from hydrolek_drake.identification.search.genetic.crossover import PointwiseCrossover, UniformCrossover
from hydrolek_drake.identification.search.genetic.multi_objective import ParetoSet, pareto_set
from hydrolek_drake.identification.search.genetic.mutation import ElementMutation
from hydrolek_drake.identification.search.genetic.selection import RouletteSelection, fitness
from hydrolek_drake.identification.search.genetic.settings import (
    MULTI_TABLE,
    MULTI_TEXT,
    SIMPLE,
    SIMPLE_INTEGER,
    GeneticSettings,
)


@pytest.mark.parametrize("gray", [True, False])
def test_binary_coding_has_every_value_of_16_bits_once(gray):
    coding = BinaryCoding(1, 16, gray)
    units = np.arange(65536)[:, None] / 65535
    chromosomes = coding.encode(units)
    np.testing.assert_array_equal(coding.decode(chromosomes), units)
    changed = (chromosomes[1:] != chromosomes[:-1]).sum(axis=1)
    assert changed.max() == (1 if gray else 16)


def test_chromosome_of_4_19_has_nine_times_sixteen_bits_in_order():
    coding = BinaryCoding(9, 16, True)
    units = np.random.default_rng(0).uniform(size=(20, 9))
    assert coding.elements == 144
    np.testing.assert_allclose(coding.decode(coding.encode(units)), units, atol=0.5 / 65535)


def test_integer_coding_rounds_to_its_levels():
    coding = IntegerCoding(3, 1001)
    np.testing.assert_allclose(coding.decode(coding.encode(np.array([[0.0, 0.1234, 1.0]]))), [[0, 0.123, 1]])


def _parents(elements=12, matings=50):
    return np.array([np.zeros((matings, elements), dtype=int), np.ones((matings, elements), dtype=int)])


def test_pointwise_crossover_swaps_pieces_between_its_points():
    children = PointwiseCrossover(1.0, 3)._do(None, _parents(), random_state=np.random.default_rng(0))
    np.testing.assert_array_equal(children.sum(axis=0), 1)  # together they have what the parents had
    assert set(np.abs(np.diff(children[0], axis=1)).sum(axis=1)) == {3}


def test_uniform_crossover_gives_each_child_half_of_either_parent():
    children = UniformCrossover(1.0)._do(None, _parents(), random_state=np.random.default_rng(0))
    np.testing.assert_array_equal(children.sum(axis=2), 6)
    np.testing.assert_array_equal(children[0][0], [0, 1] * 6)


def test_mutation_of_a_chromosome_changes_one_element_of_the_given_share():
    before = np.random.default_rng(1).integers(1000, size=(4000, 9))
    after = ElementMutation(0.5, "chromosome", 999)._do(None, before, random_state=np.random.default_rng(0))
    changed = (after != before).sum(axis=1)
    assert set(changed) == {0, 1}
    assert changed.mean() == pytest.approx(0.5, abs=4 * 0.5 / np.sqrt(4000))
    assert after.min() >= 0 and after.max() <= 999


def test_mutation_of_elements_changes_each_by_itself():
    before = np.zeros((200, 144), dtype=int)
    after = ElementMutation(0.05, "element", 1)._do(None, before, random_state=np.random.default_rng(0))
    assert after.mean() == pytest.approx(0.05, abs=4 * np.sqrt(0.05 * 0.95 / before.size))


def test_roulette_draws_in_proportion_to_the_distance_below_the_worst():
    values = np.array([[1.0], [3.0], [4.0], [FAILED]])
    np.testing.assert_allclose(fitness(values), [3.0, 1.0, 0.0, 0.0])

    class Population(list):
        def get(self, name):
            return values

    drawn = RouletteSelection()._do(
        None, Population(range(4)), 4000, 2, random_state=np.random.default_rng(0)
    )
    assert drawn.shape == (4000, 2)
    assert np.mean(drawn == 0) == pytest.approx(0.75, abs=4 * np.sqrt(0.75 * 0.25 / 8000))
    assert not np.any(drawn >= 2)


def test_roulette_with_segments_prefers_the_first_front_and_never_dies():
    np.testing.assert_array_equal(fitness(np.array([[1.0, 2.0], [2.0, 1.0], [3.0, 3.0]])), [2, 2, 1])
    np.testing.assert_array_equal(fitness(np.array([[FAILED], [FAILED]])), [1, 1])


def test_pareto_set_best_per_segment_and_average():
    points = np.array([[0.0], [1.0], [2.0], [9.0]])
    values = np.array([[0.0, 3.0], [1.0, 1.0], [3.0, 0.0], [4.0, 4.0]])
    front = pareto_set(points, values)
    assert isinstance(front, ParetoSet)
    assert sorted(front.points[:, 0]) == [0.0, 1.0, 2.0]
    np.testing.assert_array_equal(front.best_per_segment, [[0.0], [2.0]])
    assert front.average == pytest.approx([1.0])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"coding": "ternary"}, "choose binary, integer"),
        ({"crossover_rate": 1.5}, "choose 0 to 1"),
        ({"population": 1}, "choose 4 or more"),
        ({"elite": 70}, "choose 0 to 69"),
    ],
)
def test_impossible_settings_are_refused(changes, said):
    with pytest.raises(InputError, match=said):
        GeneticSettings(**changes)


def test_settings_are_those_of_table_4_4():
    for settings, crossover_rate, mutation_rate, population in (
        (SIMPLE, 0.8, 0.05, 70),
        (MULTI_TABLE, 0.4, 0.2, 20),
        (MULTI_TEXT, 0.8, 0.2, 70),
        (SIMPLE_INTEGER, 0.8, 0.5, 70),
    ):
        assert settings.crossover_rate == crossover_rate
        assert settings.mutation_rate == mutation_rate
        assert settings.population == population
    assert (SIMPLE.coding, SIMPLE.crossover, SIMPLE.bits, SIMPLE.gray) == ("binary", "pointwise", 16, True)
    assert (SIMPLE_INTEGER.coding, SIMPLE_INTEGER.crossover) == ("integer", "uniform")
