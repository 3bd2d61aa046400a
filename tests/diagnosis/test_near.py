"""Near the noise: an effect for which nothing speaks beside a nominal model that has bent its parameters."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import ABOVE_NOISE, AT_NOISE, LOOK, NEAR
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.growing import grow
from hydrolek_drake.diagnosis.score import Score, scores_of
from hydrolek_drake.diagnosis.search import _worth_going_on
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

COULOMB = "cylinder.coulomb_friction"
OTHERS = ("sensor.hysteresis", "fluid.entrained_air", "supply.pressure_droop")
SMALL_N = 250.0
COUNTED = 4000


@pytest.mark.parametrize(
    "blind_to",
    [
        pytest.param(
            (COULOMB,),
            marks=pytest.mark.long("takes a third of a minute more"),
        ),
        (COULOMB, *OTHERS),
    ],
    ids=["one", "all"],
)
def test_an_effect_that_promises_nothing_is_tried_where_no_other_reaches_the_noise(
    bench, recorded, blind_to
) -> None:
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
            replace(s, gain=0.0, left=nominal.fit.objective) if s.candidate.id in blind_to else s
            for s in scores
        ]
        grown = grow(workbench, [nominal], candidates, blind, over).hypotheses
        coulomb = next(c for c in candidates if c.id == COULOMB)
        right = workbench.fit((coulomb,), {coulomb.size_path: SMALL_N}, workbench.fine, LOOK)
    best = grown[0]
    assert {c.id for c in best.effects} == {COULOMB}
    assert best.fit.objective < right.fit.objective + 1.0  # by the likelihood as good as from the truth
    assert best.values[coulomb.size_path] == pytest.approx(SMALL_N, rel=0.15)


@pytest.mark.parametrize(
    ("over_noise", "goes_on"),
    [
        (1.0, False),
        (0.99 * ABOVE_NOISE, False),
        (1.01 * ABOVE_NOISE, True),
        (0.99 * NEAR, True),
        (1.01 * NEAR, False),
    ],
)
def test_where_nothing_promises_anything_the_search_goes_on_only_near_the_noise(
    bench, recorded, over_noise, goes_on
) -> None:
    unit = np.full(10, 0.5)
    fit = Fit(
        unit, np.full(COUNTED, over_noise), 0.0 * unit, np.zeros((1, 10)), np.zeros((1, 10)), COUNTED, 1
    )
    scales = natural_scales(bench, "joint", recorded(bench, bench))
    coulomb = next(c for c in candidates_of(bench, "joint", scales) if c.id == COULOMB)

    def promising(gain: float) -> Score:
        nothing = np.zeros(0)
        return Score(coulomb, gain, {}, (), fit.objective - gain, np.nan, nothing, nothing)

    found = Search()
    found.keep(Hypothesis((), {}, fit, 1e-3))
    found.left = [promising(0.0)]
    assert _worth_going_on(found, 0.3) == goes_on
    found.left = [promising(0.1 * fit.objective)]
    assert _worth_going_on(found, 0.3)
