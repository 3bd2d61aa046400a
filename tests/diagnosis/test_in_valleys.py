"""Fits near the noise go on along their valleys: where least squares stopped at a jump, and where that is asked for."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis import baseline, evidence
from hydrolek_drake.diagnosis.effort import ABOVE_NOISE, FAR, NEAR
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_inputs import inputs_of
from hydrolek_drake.diagnosis.law_problem import Law, LawProblem
from hydrolek_drake.diagnosis.laws import span_of
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.least_squares import Fit, fit_from
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.identification.recorded import experiments_of
from hydrolek_drake.identification.valleys import along_valleys
from hydrolek_drake.recordings import read_recording

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

PAIR = Path(__file__).parents[1] / "data" / "bench" / "practice_14"
RIPPLE_PA, RIPPLE_HZ = 2.5e6, 1.7
TRUE = {
    "supply.pressure": 15.1701e6,
    "fluid.bulk_modulus": 937.865e6,
    "command.delay": 0.021539,
    "amplifier.max_current_a": 1.05892,
    "valve.overlap_a": 6.3416e-5,
    "valve.full_opening_a": 3.48984e-4,
    "valve.max_area_a": 7.12332e-7,
    "cylinder.viscous_friction": 3201.31,
    "load.inertia": 24.7856,
    "load.gravity_cos": 255.658,
}
"""The machine's own numbers (practice_labels.json)."""

ASTRAY = {"amplifier.max_current_a": 1.093, "valve.overlap_a": 6.758e-5, "valve.full_opening_a": 3.7044e-4}
"""Current, overlap and opening where a fit ended: the spool's stroke and lands are larger together."""


def test_a_ripple_s_nominal_numbers_are_found_behind_the_jumps(bench) -> None:
    """From where least squares stops, as low as from the machine's own numbers but for what chance moves."""
    training = experiments_of(bench, read_recording(PAIR / "train.csv", bench.columns))
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        parameters = workbench.parameters(())
        scales = natural_scales(bench, "joint", training)
        supply = next(
            given
            for given in inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad")
            if given.probe == "supply"
        )
        signals = [e.simulate(bench.records()).signals for e in training]
        span = span_of(signals, bench.records()[0], 40.0, "rad")
        law = Law(supply, (), RIPPLE_HZ, 0.0, (0.1, 0.0))
        problem = LawProblem(parameters, training, workbench.fine, law, span)

        def fitted(values: dict[str, float]) -> Fit:
            full = {path: v for path in parameters.paths for key, v in values.items() if path.endswith(key)}
            start = problem.start(parameters.unit(full), np.array([RIPPLE_PA, 0.0, RIPPLE_HZ]))
            return fit_from(problem, start, most_steps=15, tolerance=1e-4)

        right, astray = fitted(TRUE), fitted(TRUE | ASTRAY)
        gone = along_valleys(problem, astray, 1e-4)
    assert astray.objective > right.objective + 50.0
    assert gone.objective < right.objective + 10.0


def _fit(over_noise: float) -> Fit:
    one = np.array([0.5])
    return Fit(one, np.full(1000, over_noise), np.zeros(1), np.zeros((1000, 1)), np.zeros((1, 1)), 1000, 1)


@pytest.mark.parametrize(("over", "goes"), [(1.0, True), (0.99 * FAR, True), (1.01 * FAR, False)])
def test_the_nominal_model_goes_on_where_nothing_large_is_missing(over, goes) -> None:
    fitted = Hypothesis((), {}, _fit(over), 1e-3)
    lower = replace(fitted, fit=_fit(0.9 * over))
    ended = baseline._lowest(SimpleNamespace(along_valleys=lambda _: lower), fitted)
    assert ended is (lower if goes else fitted)


@pytest.mark.parametrize(
    ("fitted", "ahead", "asked"),
    [
        (1.0, 1.01 * ABOVE_NOISE, True),
        (1.0, 0.99 * ABOVE_NOISE, False),
        (1.01 * NEAR, 2.0, False),
    ],
)
def test_models_near_the_noise_go_on_where_the_best_leaves_more_of_the_held_out_data(
    fitted, ahead, asked
) -> None:
    best = Judged(Hypothesis((), {}, _fit(fitted), 1e-3), np.full(500, ahead), 500)
    assert evidence._may_lie_elsewhere(best) == asked


def test_of_the_models_near_the_best_those_that_moved_are_judged_again() -> None:
    moved, stays, far = (
        Hypothesis((SimpleNamespace(size_path=name, free=()),), {}, _fit(over), 1e-3)
        for name, over in (("a", 1.0), ("b", 1.001), ("c", 1.5))
    )
    asked = []

    def along(hypothesis):
        asked.append(hypothesis)
        return replace(hypothesis, fit=_fit(0.9)) if hypothesis is moved else hypothesis

    bench = SimpleNamespace(
        along_valleys=along, side_by_side=lambda work, items: [work(item) for item in items]
    )
    lower = evidence._in_their_valleys(bench, [moved, stays, far])
    assert asked == [moved, stays]
    assert list(lower) == [moved.ids] and lower[moved.ids].fit.over_noise == pytest.approx(0.9)
