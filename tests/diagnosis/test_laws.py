"""Laws for physics in no list: what they mean, and that a planted one is found at its stage."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.evidence import Judged
from hydrolek_drake.diagnosis.growing import POLISH
from hydrolek_drake.diagnosis.laws import TERMS, span_of, variables_of
from hydrolek_drake.diagnosis.search import fit_baseline
from hydrolek_drake.diagnosis.unlisted import find_law
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

HOSE = 8e-13
"""Capacity of a hose on side A [m^3/Pa]: 5 to 10 times that of the bench's oil."""


def test_a_law_means_the_same_in_a_shorter_and_gentler_recording(bench, recorded) -> None:
    brisk, gentle = (recorded(bench, bench, largest_V=volts)[0] for volts in (9.0, 3.0))
    runs = [e.simulate(bench.records()).signals for e in (brisk, gentle)]
    span = span_of(runs[:1], 16e6, 12.0)
    for run in runs:
        known = variables_of(run, span)
        assert known["v"] * span.speed == pytest.approx(run.velocity)
        assert 0.5 * (known["z"] + 1.0) * (span.high - span.low) + span.low == pytest.approx(run.position)
        assert known["x"] * span.opening == pytest.approx(run.spool)
        assert known["pa"] * 16e6 == pytest.approx(run.pressure_a)
    assert np.abs(variables_of(runs[0], span)["v"]).max() == pytest.approx(1.0)
    assert np.abs(variables_of(runs[1], span)["v"]).max() < 0.8


def test_every_term_is_of_size_about_one_where_it_was_defined(bench, recorded) -> None:
    run = recorded(bench, bench)[0].simulate(bench.records()).signals
    span = span_of([run], 16e6, 12.0)
    time = np.linspace(0.0, 1.0, run.velocity.size)
    for term in TERMS:
        largest = np.abs(term.values(time, variables_of(run, span))).max()
        assert 0.3 <= largest <= 2.0, term.name


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
