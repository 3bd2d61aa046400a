"""Which hypotheses are held against the held-out data to the end, and beside which the data are weighed."""

from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import FAR, POLISH
from hydrolek_drake.diagnosis.evidence import OUT_OF_REACH, _contenders
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.weighing import weigh_anew
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

COUNT = 1000


def _fitted(*names: str, left: float = 1.0) -> Hypothesis:
    effects = tuple(SimpleNamespace(size_path=name, free=()) for name in names)
    one = np.array([0.5])
    fit = Fit(one, left * np.ones(COUNT), np.zeros(1), np.zeros((COUNT, 1)), np.zeros((1, 1)), COUNT, 1)
    return Hypothesis(effects, {}, fit, 1e-3)


def _far_off(hypothesis: Hypothesis, half_chi_squared: float) -> Judged:
    return Judged(hypothesis, np.full(COUNT, np.sqrt(2.0 * half_chi_squared / COUNT)), COUNT)


def test_a_model_without_one_of_the_best_one_s_effects_is_judged_however_far_off_it_is() -> None:
    pair, alone, other, nominal = _fitted("a", "b"), _fitted("a"), _fitted("c"), _fitted(left=50.0)
    found = Search()
    for hypothesis in (pair, alone, other, nominal):
        found.keep(hypothesis)
    near = 0.5 * COUNT
    far = near + 4.0 * OUT_OF_REACH
    first = [_far_off(pair, near), _far_off(alone, far), _far_off(other, far), _far_off(nominal, 1e6)]
    kept = [hypothesis.ids for hypothesis in _contenders(first, found)]
    assert alone.ids in kept and nominal.ids in kept
    assert other.ids not in kept


def test_beside_a_model_that_leaves_half_the_noise_is_told_anew(bench, recorded) -> None:
    machine = bench.with_values({"effects.sensor.drift.rate_rad_per_min": 0.3})
    experiments = recorded(machine, bench)
    drift = next(
        c
        for c in candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
        if c.id == "sensor.drift"
    )
    with ThreadPoolExecutor(2) as pool:
        work = Workbench(bench, free_parameters(bench, ["load.gravity_cos"]), experiments, pool)
        found = Search()
        found.keep(work.fit((), {}, work.fine, POLISH))
        found.weighed_at = found.baseline.fit.over_noise
        found.keep(work.fit((drift,), {**found.baseline.values, **drift.starts[0]}, work.fine, POLISH))
        before = work.training
        weigh_anew(work, found)
        weighed = work.training
        weigh_anew(work, found)
    assert found.baseline.fit.over_noise > FAR
    assert weighed is not before
    assert work.training is weighed  # once is enough, as long as nothing better is found
    assert set(found.hypotheses) == {frozenset(), frozenset({drift.size_path})}
    assert abs(found.best.fit.over_noise - 1.0) < 0.1
