"""Times of the simulated operator: sums of published acts, Hick's law, scatter."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.operator_model import (
    choice_time,
    clicking,
    make_operator,
    preparation,
    reaction_time,
)


def test_reaction_is_the_three_cycles_of_the_model_human_processor():
    assert reaction_time() == pytest.approx(0.24)


def test_choice_grows_by_one_step_with_every_doubling():
    steps = np.diff([choice_time(2**bits - 1) for bits in range(6)])
    assert choice_time(0) == 0.0
    np.testing.assert_allclose(steps, 0.15)


def test_a_click_is_the_keystroke_level_model_s_sum_and_a_beginner_s_has_one_mental_act_more():
    assert clicking(make_operator("experienced"), 1) == pytest.approx(1.35 + 1.1 + 0.2)
    beginner = clicking(make_operator("inexperienced"), 5)
    assert beginner == pytest.approx(clicking(make_operator("experienced"), 5) + 5 * 1.35)


def test_a_beginner_takes_longer_to_the_next_stick_by_a_mental_act_and_by_finding_it():
    longer = preparation(make_operator("inexperienced"), 6) - preparation(make_operator("experienced"), 6)
    assert longer == pytest.approx(1.35 + 1.2 - 0.2)


def test_the_pace_scatters_about_one_as_the_published_model_errs():
    generator = np.random.default_rng(1)
    paces = np.array([make_operator("experienced", generator).pace for _ in range(4000)])
    assert np.median(paces) == pytest.approx(1.0, abs=0.02)
    assert np.std(np.log(paces)) == pytest.approx(0.21, abs=0.01)


def test_an_unknown_operator_is_refused():
    with pytest.raises(InputError, match="choose inexperienced, experienced"):
        make_operator("robot")
