"""Laws for physics in no list: what they mean, and that a planted one is found at its stage."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.effort import POLISH
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_search import _along, _gain, promising
from hydrolek_drake.diagnosis.laws import Term, inputs_of, law_record, span_of
from hydrolek_drake.diagnosis.unlisted import find_law
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.rollout.law import law_value

HOSE = 8e-13
"""Capacity of a hose on side A [m^3/Pa]: 5 to 10 times that of the bench's oil."""

RIPPLE, RIPPLE_HZ = 2e6, 3.104
"""Of the supply pressure [Pa]; midway between two frequencies that lie half a cycle over 12 s apart."""


def test_a_law_means_the_same_in_a_shorter_and_gentler_recording(bench, recorded) -> None:
    brisk, gentle = (recorded(bench, bench, largest_V=volts)[0] for volts in (9.0, 3.0))
    runs = [e.simulate(bench.records()).signals for e in (brisk, gentle)]
    span = span_of(runs[:1], bench.records()[0], 12.0)
    law = law_record("load", span, Term(("load",), speed="v"), 5.0)[0]
    for run in runs:
        told = [law_value(law, 0.0, 0.0, w, 0.0, 0.0, 0.0) for w in run.velocity]
        assert told == pytest.approx(5.0 * run.velocity / np.abs(runs[0].velocity).max())
    assert np.abs(runs[1].velocity).max() < 0.8 * np.abs(runs[0].velocity).max()


def test_a_ripple_is_found_between_the_frequencies_that_are_scanned(bench, recorded) -> None:
    training = recorded(bench, bench, largest_V=7.0, unknown=("supply", RIPPLE), unknown_Hz=RIPPLE_HZ)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = workbench.refit(fit_baseline(workbench), workbench.fine, POLISH)
        records = workbench.parameters(()).records(nominal.fit.unit)
        signals = [e.simulate(records, workbench.fine).signals for e in training]
        span = span_of(signals, records[training[0].index], 12.0)
        scales = natural_scales(bench, "joint", training)
        inputs = inputs_of(scales, bench.value("supply.pressure"), 10.0, training[0].channels[0].unit)
        laws = promising(
            workbench, nominal, [i for i in inputs if i.stage == "supply"], span, 4 * workbench.fine
        )
    ripple = next(law for law in laws if law.term is None)
    assert nominal.fit.over_noise > 2.0
    assert ripple is max(laws, key=lambda law: law.gain)
    assert ripple.frequency == pytest.approx(RIPPLE_HZ, abs=0.15 / 12.0)
    assert np.hypot(*ripple.amplitudes) * ripple.input.scale == pytest.approx(RIPPLE, rel=0.5)


def test_a_law_with_which_the_rollout_diverged_promises_nothing() -> None:
    rest, good = np.array([1.0, -2.0, 2.0]), np.array([-0.5, 1.0, -1.0])
    assert _gain(good[:, None], rest)[0] == pytest.approx(9.0)
    assert _along(good, rest) == pytest.approx(9.0)
    for bad in (np.nan, np.inf):
        away = np.array([-0.5, bad, bad])
        assert _gain(np.stack([good, away], axis=1), rest) == (0.0, (0.0, 0.0))
        assert _along(away, rest) == 0.0


def test_a_hose_that_expands_is_found_at_the_fluid(bench, recorded) -> None:
    kept = {"largest_V": 7.0, "pressure_noise_Pa": 2e4, "unknown": ("capacity_a", HOSE)}
    training, held_out = (recorded(bench, bench, seed=seed, **kept) for seed in (1, 2))
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = workbench.refit(fit_baseline(workbench), workbench.fine, POLISH)
        left = workbench.residuals(nominal, held_out, workbench.fine)
        judged = Judged(nominal, left, sum(e.counted for e in held_out))
        found = find_law(workbench, judged, held_out, natural_scales(bench, "joint", training))
    assert judged.over_noise > 2.0
    assert found is not None
    assert found.law.input.stage == "fluid"
    assert found.amplitude == pytest.approx(HOSE, rel=0.1)
    assert found.held_out_over_noise < 1.1
    assert "side A" in found.equation()
    assert not found.equation().endswith("* 1")
