"""Verdicts and probabilities from judged hypotheses."""

from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.evidence.judged import (
    Judged,
    conclude,
    dispersion_of,
    probability_of,
    with_least,
    with_probabilities,
)
from hydrolek_drake.diagnosis.evidence.judging import pays, predicts
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.weighing import least_over_noise
from hydrolek_drake.identification.least_squares.least_squares import Fit

COUNTED = 4000
BLOCKS = np.repeat(np.arange(10), COUNTED // 10)


def _judged(effects, over_noise: float, ahead: float | None = None) -> Judged:
    unit = np.full(10 + sum(len(c.free) for c in effects), 0.5)
    nothing = np.zeros((1, unit.size))
    fit = Fit(unit, np.full(COUNTED, over_noise), 0.0 * unit, nothing, nothing, COUNTED, 1)
    held = np.full(COUNTED, over_noise if ahead is None else ahead)
    return Judged(Hypothesis(tuple(effects), {}, fit, 1e-3), held, COUNTED)


@pytest.fixture(scope="module")
def effect(bench, recorded):
    from hydrolek_drake.identification.experiments.natural_scales import natural_scales

    scales = natural_scales(bench, "joint", recorded(bench, bench))
    return {c.id: c for c in candidates_of(bench, "joint", scales)}


def test_a_model_at_the_noise_is_none(effect) -> None:
    leak = effect["cylinder.cross_port_leakage"]
    done = conclude(with_probabilities([_judged((), 1.0), _judged((leak,), 0.9999)]))
    assert done.verdict == "none"


def test_a_clear_effect_is_named_with_certainty(effect) -> None:
    leak, droop = effect["cylinder.cross_port_leakage"], effect["supply.pressure_droop"]
    judged = with_probabilities([_judged((), 5.0), _judged((droop,), 3.0), _judged((leak,), 1.0)])
    done = conclude(judged)
    assert done.verdict == "missing_physics"
    assert [c.id for c in done.best.hypothesis.effects] == ["cylinder.cross_port_leakage"]
    assert done.probability[leak.size_path] > 0.999
    assert done.groups == ()


def test_two_effects_that_do_equally_well_are_a_group(effect) -> None:
    gap, play = effect["linkage.backlash"], effect["sensor.hysteresis"]
    done = conclude(with_probabilities([_judged((), 4.0), _judged((gap,), 1.0), _judged((play,), 1.0)]))
    assert done.verdict == "ambiguous"
    assert done.groups == (("linkage.backlash", "sensor.hysteresis"),)
    assert done.probability[gap.size_path] == pytest.approx(0.5, abs=0.01)


def test_what_no_effect_explains_is_unlisted(effect) -> None:
    leak = effect["cylinder.cross_port_leakage"]
    assert (
        conclude(with_probabilities([_judged((), 9.0), _judged((leak,), 4.0)])).verdict == "unlisted_physics"
    )


def test_a_nominal_model_that_does_not_predict_is_not_called_complete() -> None:
    """The noise is known to 1 to 2 %: what is left far above it on data that nothing was chosen by is something."""
    assert conclude(with_probabilities([_judged((), 0.99, ahead=1.05)])).verdict == "none"
    assert conclude(with_probabilities([_judged((), 0.99, ahead=1.2)])).verdict == "unlisted_physics"


@pytest.mark.parametrize(
    ("whole", "behind", "verdict"),
    [
        (1.4, 1.0, "none"),  # a line that rings otherwise now and then
        (1.4, 1.3, "unlisted_physics"),  # something is missing behind its recorded pressure
        (3.5, 1.0, "unlisted_physics"),  # the line is far off on the whole
        (1.05, 1.3, "unlisted_physics"),
    ],
)
def test_a_line_that_rings_excuses_nothing_behind_its_recorded_pressure(whole, behind, verdict) -> None:
    judged = replace(_judged((), 0.99, ahead=whole), left_behind_cut=behind)
    assert conclude(with_probabilities([judged])).verdict == verdict


def test_a_machine_is_held_to_what_its_equations_leave_at_best(effect, bench, recorded) -> None:
    """A rig that grants its equations three times the noise: ten times its squares are no missing physics."""
    experiments = recorded(bench, bench)
    granted = [
        replace(e, channels=tuple(replace(c, least_error=3.0 * c.noise) for c in e.channels))
        for e in experiments
    ]
    assert least_over_noise(experiments) == 1.0
    assert least_over_noise(granted) == pytest.approx(np.sqrt(10.0), rel=1e-3)
    leak = effect["cylinder.cross_port_leakage"]
    left = [_judged((), 9.0), _judged((leak,), 3.3)]
    assert conclude(with_probabilities(left)).verdict == "unlisted_physics"
    held = with_probabilities([with_least(j, granted, granted) for j in left])
    assert conclude(held).verdict == "missing_physics"
    assert conclude(with_probabilities([with_least(_judged((), 3.3), granted, granted)])).verdict == "none"
    assert (
        conclude(with_probabilities([with_least(_judged((), 4.9), granted, granted)])).verdict
        == "unlisted_physics"
    )


def test_what_does_not_predict_better_is_not_named(effect) -> None:
    """However much better it fits the training data: improvement counts on held-out data."""
    leak, gap = effect["cylinder.cross_port_leakage"], effect["linkage.backlash"]
    nominal = _judged((), 1.0, ahead=1.05)
    better, worse = _judged((leak,), 0.95, ahead=1.04), _judged((gap,), 0.90, ahead=1.06)
    both = _judged((leak, gap), 0.80, ahead=1.045)
    judged = [nominal, better, worse, both]
    assert [predicts(j, judged, BLOCKS) for j in judged] == [True, True, False, False]
    assert predicts(both, [nominal, worse, both], BLOCKS)  # of what it contains


def test_what_gains_in_some_blocks_and_loses_in_others_is_not_named(effect) -> None:
    """The simpler one within a standard error; a gain of the same size that every block shows is one."""
    nominal = _judged((), 1.05)
    leak = _judged((effect["cylinder.cross_port_leakage"],), 1.0)
    for scatter, named in ((0.01, True), (0.2, False)):
        swings = scatter * np.tile(np.repeat([1.0, -1.0], COUNTED // 10), 5)
        uneven = replace(leak, held_out=np.sqrt(1.05**2 - 0.02 + swings))
        gain = uneven.log_density - nominal.log_density
        assert gain == pytest.approx(0.01 * COUNTED)  # whatever the scatter
        assert predicts(uneven, [nominal, uneven], BLOCKS) == named


def test_what_strayed_far_off_ahead_predicts_by_what_it_leaves_of_both(effect) -> None:
    """A joint stuck where a hair decides: fitted to both data the model leaves the noise, see `NOISE.far`."""
    nominal = _judged((), 2.9, ahead=3.7)
    strayed = _judged((effect["sensor.hysteresis"],), 0.9, ahead=5.5)
    assert not predicts(strayed, [nominal, strayed], BLOCKS)
    fitted_to_both = replace(strayed, chi_squared=0.9**2 * COUNTED)
    assert predicts(fitted_to_both, [nominal, fitted_to_both], BLOCKS)


def test_what_parameters_leave_uncertain_is_no_error_ahead(effect) -> None:
    """What counts is the density of the held-out data, parameters integrated out, and not what one value leaves."""
    nominal = replace(_judged((), 1.0, ahead=1.05), chi_squared=1.05**2 * COUNTED, spread=9.0)
    true = _judged((effect["sensor.hysteresis"],), 0.98, ahead=1.06)
    assert not predicts(true, [nominal, true], BLOCKS)
    known_to = replace(true, chi_squared=1.03**2 * COUNTED, spread=11.0)
    assert predicts(known_to, [nominal, known_to], BLOCKS)
    vague = replace(known_to, spread=9.0 + 2.0 * (1.05**2 - 1.03**2) * COUNTED)
    assert not predicts(vague, [nominal, vague], BLOCKS)


def test_what_is_named_beside_unlisted_physics_may_have_rivals(effect) -> None:
    leak, gap, play = (
        effect[name] for name in ("cylinder.cross_port_leakage", "linkage.backlash", "sensor.hysteresis")
    )
    judged = [_judged((), 9.0), _judged((leak, gap), 4.0), _judged((leak, play), 4.0)]
    done = conclude(with_probabilities(judged))
    assert done.verdict == "unlisted_physics"
    assert done.groups == (("linkage.backlash", "sensor.hysteresis"),)
    alone = conclude(with_probabilities([_judged((), 4.0), _judged((gap,), 4.0 + 1e-4)]))
    assert alone.verdict == "unlisted_physics" and alone.groups == ()


def test_probabilities_sum_to_one_and_follow_the_likelihood(effect) -> None:
    leak = effect["cylinder.cross_port_leakage"]
    judged = with_probabilities([_judged((), 1.002), _judged((leak,), 1.0)])
    assert sum(j.probability for j in judged) == pytest.approx(1.0)
    by = {len(j.hypothesis.effects): j for j in judged}
    odds = by[1].probability / by[0].probability
    assert odds == pytest.approx(np.exp(by[1].support - by[0].support), rel=1e-9)
    assert probability_of(leak.size_path, judged) == by[1].probability


def test_a_systematic_rest_flattens_the_likelihood(effect) -> None:
    assert dispersion_of(_judged((), 1.0)) == 1.0
    tau = dispersion_of(_judged((), 1.1))
    # what both the training and the held-out data leave beyond the noise, for each of ten parameters
    assert tau == pytest.approx(2 * (1.1**2 - 1.015**2) * COUNTED / 10, rel=1e-9)


def test_one_more_effect_must_pay_for_itself(effect) -> None:
    leak, drift = effect["cylinder.cross_port_leakage"], effect["sensor.drift"]
    judged = with_probabilities([_judged((leak,), 1.0), _judged((leak, drift), 0.9995)])
    assert len(judged[0].hypothesis.effects) == 1


def test_an_effect_that_gains_nothing_on_the_training_data_is_not_judged(effect) -> None:
    leak, drift = effect["cylinder.cross_port_leakage"], effect["sensor.drift"]
    nominal, alone = _judged((), 5.0).hypothesis, _judged((leak,), 1.0).hypothesis
    # chi squared of 4000 values falls by 4 in the one case, by 40 in the other
    idle = _judged((leak, drift), (1.0 - 4.0 / COUNTED) ** 0.5).hypothesis
    needed = _judged((leak, drift), (1.0 - 40.0 / COUNTED) ** 0.5).hypothesis
    assert pays(alone, [nominal, alone, idle])
    assert not pays(idle, [nominal, alone, idle])
    assert pays(needed, [nominal, alone, needed])


def test_an_effect_in_place_of_its_special_case_must_gain_on_the_training_data(effect) -> None:
    leak, droop = effect["cylinder.cross_port_leakage"], effect["supply.pressure_droop"]
    coulomb, stribeck = effect["cylinder.coulomb_friction"], effect["cylinder.stribeck_friction"]
    special = _judged((leak, coulomb), 1.0).hypothesis
    idle = _judged((leak, stribeck), (1.0 - 4.0 / COUNTED) ** 0.5).hypothesis
    needed = _judged((leak, stribeck), (1.0 - 40.0 / COUNTED) ** 0.5).hypothesis
    assert pays(special, [special, idle])
    assert not pays(idle, [special, idle])
    assert pays(needed, [special, needed])
    other = _judged((droop, coulomb), 1.0).hypothesis  # no special case of what has the leak
    assert pays(idle, [other, idle])
