"""Fits with pulled rollouts: along the valley of a play, and let go again."""

from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import AT_NOISE, NEAR
from hydrolek_drake.diagnosis.pulled_fits import fit_pulled, let_go, with_sizes_walked
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.identification.problem import PULL_S

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

PLAY = "joints.joint.effects.linkage.backlash.gap_rad"
SHARE = 0.03
"""Of the travel: far more than the noise."""


@pytest.fixture(scope="module")
def worn(bench, recorded):
    """Play, recordings of a bench that has it, with pressures."""
    play = SHARE * float(np.ptp(recorded(bench, bench)[0].channels[0].measured))
    machine = bench.with_values({PLAY: play})
    return play, recorded(machine, bench, noise_deg=0.02, pressure_noise_Pa=1e4)


def test_the_valley_of_a_play_is_walked_from_four_times_too_much(bench, worn):
    play, experiments = worn
    with ThreadPoolExecutor(1) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        scales = natural_scales(bench, "joint", experiments)
        effect = next(c for c in candidates_of(bench, "joint", scales) if c.size_path == PLAY)
        begun = ((effect,), [{PLAY: 4.0 * play}], workbench.fine, experiments)
        stuck = fit_pulled(workbench, *begun)
        walked = with_sizes_walked(workbench, *begun)
    assert stuck.fit.over_noise > 10.0
    assert stuck.values[PLAY] > 2.0 * play
    assert walked.fit.over_noise < AT_NOISE
    assert walked.values[PLAY] == pytest.approx(play, rel=0.02)


def test_what_fades_with_its_size_is_not_walked(bench, worn):
    _, experiments = worn
    with ThreadPoolExecutor(1) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        scales = natural_scales(bench, "joint", experiments)
        candidates = candidates_of(bench, "joint", scales)
        effect = next(c for c in candidates if c.id == "cylinder.coulomb_friction")
        begun = ((effect,), [effect.starts[0]], workbench.fine, experiments)
        plain, walked = fit_pulled(workbench, *begun), with_sizes_walked(workbench, *begun)
    assert walked.values == plain.values


class _Hollows:
    """Pulled rollouts leave a parameter off by what they do not see; free ones have hollows of one unit."""

    fine = 1.0

    def __init__(self, missing=0.0):
        self.missing = missing
        self.pulls = []

    def fit(self, effects, values, step, most_steps, tolerance, pull_time, alone):
        self.pulls.append(pull_time)
        off = 0.4 / pull_time  # what drifts more slowly than the pull is not seen
        width = 5.0 / pull_time  # hollows are as much wider as errors pile up for a shorter time
        off = values["x"] if abs(values["x"]) > width else off
        fit = SimpleNamespace(over_noise=1.0 + self.missing * pull_time)
        return SimpleNamespace(effects=effects, values={"x": off}, fit=fit, step=step)


def test_each_looser_pull_begins_in_the_hollow_of_the_tighter_one():
    bench = _Hollows()
    pulled = bench.fit((), {"x": 0.0}, 1.0, 1, 1e-3, PULL_S, True)
    assert pulled.values["x"] > 1.0  # free rollouts would end in another hollow
    freed = let_go(bench, pulled)
    assert freed.values["x"] < 0.5
    assert bench.pulls == sorted(bench.pulls)


def test_a_model_that_something_is_missing_from_is_let_go_at_once():
    bench = _Hollows(missing=2.0)
    pulled = bench.fit((), {"x": 0.0}, 1.0, 1, 1e-3, PULL_S, True)
    bench.pulls.clear()
    freed = let_go(bench, pulled)
    assert bench.pulls == [0.3]  # where it leaves too much already
    assert freed.fit.over_noise >= NEAR
