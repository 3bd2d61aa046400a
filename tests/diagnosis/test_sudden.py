"""Effects that are there as soon as they are: which these are, and from where they are searched."""

from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import LOOK
from hydrolek_drake.diagnosis.first_fits import Trial, sudden
from hydrolek_drake.diagnosis.growing import _near
from hydrolek_drake.diagnosis.unsticking import fit_pulled
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

PLAY = "joints.joint.effects.linkage.backlash.gap_rad"

FADED = 1e-3
"""Of a size, at which nothing must be left of an effect that fades with it, but for a tenth."""


@pytest.fixture
def fading(bench, recorded):
    """Effect -> change of the residuals at a thousandth of where its search begins, over that where it begins."""
    experiments = recorded(bench, bench, largest_V=4.0)
    with ThreadPoolExecutor(1) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)

        def changed(candidate, factor):
            start = dict(candidate.starts[0])
            moments = {free.path for free in candidate.moments}
            sizes = [
                p.name
                for p in candidate.effect.parameters
                if p.neutral == 0.0 and f"{candidate.path}.{p.name}" not in moments
            ] or [candidate.effect.size]
            start |= {
                f"{candidate.path}.{name}": factor * start[f"{candidate.path}.{name}"] for name in sizes
            }
            problem = workbench.problem((candidate,), 0.5 * workbench.fine)
            return problem.residuals(problem.parameters.unit(start))

        plain = workbench.problem((), 0.5 * workbench.fine)
        nominal = plain.residuals(plain.parameters.unit({}))
        found = {}
        for candidate in candidates_of(bench, "joint", natural_scales(bench, "joint", experiments)):
            weak = 1.0 / FADED if candidate.effect.weakens else FADED
            small, large = (np.linalg.norm(changed(candidate, f) - nominal) for f in (weak, 1.0))
            if large > 0.0:  # a cushion is not reached
                found[candidate.id] = small / large
    return found


def test_an_effect_fades_with_its_size_unless_it_is_called_sudden(fading):
    assert {name for name, share in fading.items() if share > 0.1} == {
        name for name in fading if EFFECTS[name].sudden
    }


SIZE, OWN = "joints.j.effects.linkage.backlash.gap_rad", "joints.j.valve.max_area_a"


def _candidate(path, *sizes, sudden=False):
    return SimpleNamespace(
        joint="j",
        size_path=path,
        starts=tuple({path: size} for size in sizes),
        effect=SimpleNamespace(sudden=sudden, stage="linkage"),
    )


class _Bench:
    """Only a fit that begins at the rig's own values, with a small play and not too coarse a step, gets anywhere."""

    fine = 1.0
    together = False

    def beginning(self):
        return ["part"]

    def joints_of(self, effects):
        return {"j"}

    def side_by_side(self, work, items):
        return [work(item) for item in items]

    def fit(self, effects, values, step, most_steps, tolerance=1e-5, experiments=None, alone=False):
        near = (
            OWN not in values
            and all(abs(values.get(c.size_path, 0.0)) < 1e-3 for c in effects)
            and step <= 2.0
        )
        left = 1.0 if near else 5.0
        fit = SimpleNamespace(objective=left**2, over_noise=left)
        return SimpleNamespace(effects=effects, values=values, fit=fit, step=step)

    def refit(self, hypothesis, step, most_steps, alone=False):
        return hypothesis


def _parent(left):
    """The model to which effects are added, with the squared residuals that it leaves."""
    return SimpleNamespace(fit=SimpleNamespace(objective=left, counted=1000, unsure=0.0))


def test_a_sudden_effect_is_searched_from_the_rig_s_own_values_with_each_size():
    play = _candidate(SIZE, 5e-4, 5e-3, sudden=True)
    best = sudden(_Bench(), (play,), {OWN: 2.0, SIZE: 5e-3}, 4.0)
    assert best.values == {SIZE: 5e-4}


@pytest.mark.parametrize("sudden", [False, True])
def test_what_does_not_reach_the_noise_from_a_bent_model_is_fitted_anew(sudden, monkeypatch):
    monkeypatch.setattr("hydrolek_drake.diagnosis.growing.timed", lambda bench, hypothesis, step: hypothesis)
    effects = (_candidate(SIZE, 5e-4, sudden=sudden),)
    trials = [Trial(effects, 0.0, [{OWN: 2.0, SIZE: 5e-4}], [9.0])]
    bench = _Bench()
    monkeypatch.setattr(  # leads nowhere here: what is asked is whether fits with free rollouts begin anew
        "hydrolek_drake.diagnosis.growing.anew_pulled",
        lambda bench, trial, step: bench.fit((), {OWN: 2.0}, step, 1),
    )
    assert _near(bench, _parent(25.0), trials, [], trials, 1.0)[0].fit.over_noise == 1.0
    at_noise = _near(bench, _parent(25.0), trials, [], [], 1.0)[0]
    assert at_noise.fit.over_noise == 5.0  # a model at the noise is not bent
    bench.together = (
        True  # what joints do to each other was told without the effect: where that brings enough ...
    )
    assert (
        _near(bench, _parent(60.0), trials, [], trials, 1.0)[0].fit.over_noise == 5.0
    )  # ... it is told anew first
    assert _near(bench, _parent(26.0), trials, [], trials, 1.0)[0].fit.over_noise == 1.0


def test_effects_whose_tried_sizes_were_too_large_are_followed_by_what_they_promise(monkeypatch):
    monkeypatch.setattr("hydrolek_drake.diagnosis.growing.timed", lambda bench, hypothesis, step: hypothesis)
    each = [(_candidate(f"joints.j.effects.e{i}.size", 1e-4),) for i in range(12)]
    trials = [Trial(e, float(i), [{e[0].size_path: 1e-4}], [float(i)]) for i, e in enumerate(each)]
    tried = {h.effects[0].size_path for h in _near(_Bench(), _parent(25.0), trials, [], [], 1.0)}
    assert {each[0][0].size_path, each[-1][0].size_path} <= tried and len(tried) < 12


@pytest.mark.parametrize("share", [0.01, 0.15])
def test_a_play_is_found_whether_small_or_a_good_part_of_the_travel(share, bench, recorded):
    travel = np.ptp(recorded(bench, bench)[0].channels[0].measured)
    worn = bench.with_values({PLAY: share * travel})
    experiments = recorded(worn, bench, pressure_noise_Pa=2e4)
    with ThreadPoolExecutor(1) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        scales = natural_scales(bench, "joint", experiments)
        play = next(c for c in candidates_of(bench, "joint", scales) if c.size_path == PLAY)
        pulled = fit_pulled(workbench, (play,), play.starts, workbench.fine, experiments)
        found = workbench.refit(pulled, workbench.fine, LOOK)
    assert found.values[PLAY] == pytest.approx(share * travel, rel=0.1)
