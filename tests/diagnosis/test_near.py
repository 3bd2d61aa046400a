"""Near the noise: an effect for which nothing speaks beside a nominal model that has bent its parameters."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import AT_NOISE, LOOK, NEAR
from hydrolek_drake.diagnosis.growing import grow
from hydrolek_drake.diagnosis.score import scores_of
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

COULOMB = "cylinder.coulomb_friction"
OTHERS = ("sensor.hysteresis", "fluid.entrained_air", "supply.pressure_droop")
SMALL_N = 250.0


def test_an_effect_that_promises_nothing_is_tried_where_no_other_reaches_the_noise(bench, recorded) -> None:
    training = recorded(bench.with_values({f"effects.{COULOMB}.coulomb_N": SMALL_N}), bench)
    every = candidates_of(bench, "joint", natural_scales(bench, "joint", training))
    candidates = [c for c in every if c.id in (COULOMB, *OTHERS)]
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        over = nominal.fit.over_noise
        assert AT_NOISE < over < NEAR
        scores = scores_of(workbench, nominal, candidates, workbench.fine)
        blind = [
            replace(s, gain=0.0, left=nominal.fit.objective) if s.candidate.id == COULOMB else s
            for s in scores
        ]
        grown = grow(workbench, [nominal], candidates, blind, over).hypotheses
        coulomb = next(c for c in candidates if c.id == COULOMB)
        right = workbench.fit((coulomb,), {coulomb.size_path: SMALL_N}, workbench.fine, LOOK)
    best = grown[0]
    assert {c.id for c in best.effects} == {COULOMB}
    assert best.fit.objective < right.fit.objective + 1.0  # by the likelihood as good as from the truth
    assert best.values[coulomb.size_path] == pytest.approx(SMALL_N, rel=0.15)
