"""First fits of a search: a start that no rollout survives does not give an effect up."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.first_fits import Trial, diverged, glance
from hydrolek_drake.identification.problem import DIVERGED

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

SIZE = "joints.j.effects.base.stiffness"
STIFF, SOFT = {SIZE: 5e5}, {SIZE: 1e4}


def _hypothesis(values, residuals):
    residuals = np.asarray(residuals, float)
    return SimpleNamespace(
        values=values, fit=SimpleNamespace(residuals=residuals, objective=float(residuals @ residuals))
    )


class _Bench:
    """Rollouts break down with a spring that is too stiff for the step."""

    def beginning(self):
        return ["part"]

    def __init__(self):
        self.tried = []

    def fit(self, effects, values, step, most_steps, tolerance, experiments, alone):
        self.tried.append(values[SIZE])
        left = [DIVERGED, 1.0] if values[SIZE] > 1e5 else [2.0, 1.0]
        return _hypothesis(values, left)


def _candidate(*starts):
    return SimpleNamespace(moments=(), starts=starts, effect=SimpleNamespace(sudden=False))


EFFECTS = (_candidate(STIFF, SOFT),)


def test_where_the_most_promising_start_breaks_down_the_others_are_tried():
    bench = _Bench()
    best = glance(bench, Trial(EFFECTS, 0.0, [{**STIFF, "other": 7.0}]), 1e-3)
    assert not diverged(best)
    assert best.values == {**SOFT, "other": 7.0}


def test_a_start_that_is_survived_costs_no_further_fits():
    bench = _Bench()
    best = glance(bench, Trial(EFFECTS, 0.0, [SOFT]), 1e-3)
    assert bench.tried == [SOFT[SIZE]]
    assert best.values == SOFT


def test_an_effect_that_breaks_down_everywhere_is_told_as_such():
    bench = _Bench()
    assert diverged(glance(bench, Trial((_candidate(STIFF),), 0.0, [STIFF]), 1e-3))
