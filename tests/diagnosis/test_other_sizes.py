"""A model with something sudden, fitted again from sizes near by."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.effort import AT_NOISE, NEAR
from hydrolek_drake.diagnosis.unsticking import from_other_sizes

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

GAP, AREA = "joints.j.effects.linkage.backlash.gap_rad", "joints.j.valve.max_area_a"
TRUE = 1.05e-2
HOLLOW = math.log(1.02)
COUNTED = 1000


class _Bench:
    """Least squares ends in the nearest hollow of the size, two hundredths apart, from the rig's own values only."""

    fine = 1.0
    training = ()

    def __init__(self):
        self.begun = []

    def joints_of(self, effects):
        return {"j"}

    def problem(self, effects, step, experiments, pull_time):
        return SimpleNamespace(parameters=SimpleNamespace(unit=lambda s: s), residuals=lambda s: np.zeros(1))

    def side_by_side(self, work, items):
        return [work(item) for item in items]

    def fit(
        self, effects, values, step, most_steps, tolerance=1e-5, experiments=None, pull_time=None, alone=False
    ):
        self.begun.append(values)
        hollows = math.log(values[GAP] / TRUE) / HOLLOW
        gap = TRUE * math.exp(HOLLOW * round(hollows))
        left = 1.0 + abs(math.log(gap / TRUE)) + (1.0 if AREA in values else 0.0)
        fit = SimpleNamespace(objective=COUNTED * left**2, over_noise=left, counted=COUNTED, unsure=0.0)
        return SimpleNamespace(effects=effects, values={**values, GAP: gap}, fit=fit, step=step)

    def refit(self, hypothesis, step, most_steps):
        return hypothesis


def _stuck(off, sudden=True):
    """A model that ended in a hollow so far off, with bent parameters of the joint."""
    effect = SimpleNamespace(sudden=sudden, stage="linkage")
    effects = (SimpleNamespace(joint="j", size_path=GAP, effect=effect),)
    fitted = _Bench().fit(effects, {GAP: TRUE * math.exp(off)}, 1.0, 1)
    fitted.values[AREA] = 2.0
    return fitted


@pytest.mark.parametrize("off", [-0.24, -0.08, 0.1, 0.26])
def test_hollows_of_a_gap_are_left_over_sizes_near_by(off):
    fits = from_other_sizes(_Bench(), _stuck(off), NEAR)
    assert min(h.fit.over_noise for h in fits) < AT_NOISE


@pytest.mark.parametrize("off", [0.0, 0.5])
def test_a_model_at_the_noise_or_far_from_it_is_left_alone(off):
    bench = _Bench()
    assert from_other_sizes(bench, _stuck(off), NEAR) == [] == bench.begun


def test_only_what_is_sudden_is_tried():
    assert from_other_sizes(_Bench(), _stuck(0.1, sudden=False), NEAR) == []
