"""How far the numbers of a law are known, and those of the machine that were fitted with it."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.diagnosis.intervals.curvature import NORMAL
from hydrolek_drake.diagnosis.laws.found import LostCommands, law_of
from hydrolek_drake.diagnosis.laws.law import amplitude_intervals, frequency_interval
from hydrolek_drake.diagnosis.report.words import known_to
from hydrolek_drake.diagnosis.structures.inputs import inputs_of
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm
from hydrolek_drake.diagnosis.structures.term_forms import Term, span_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

HOSE = 8e-13
RIPPLE_PA, RIPPLE_HZ = 1.5e6, 2.3
SEEDS = 8
STEP_S = 5e-4
CONSTANT_TERM = Term(("fluid",))
NEVER = 1e-3
"""A test that is right fails so often at most, at either end."""


@pytest.fixture(scope="module")
def found(bench, recorded, fitted):
    """(probe, form, planted values, frequency, seed) -> the law fitted from there, beside the nominal model."""
    supply = bench.value("supply.pressure")

    def find(probe, form, planted, unknown_Hz=0.0, seed=1):
        kept = {"largest_V": 7.0, "pressure_noise_Pa": 2e4, "unknown_Hz": unknown_Hz}
        training = recorded(bench, bench, seed=seed, unknown=(probe, planted[0]), **kept)
        workbench = Workbench(bench, free_parameters(bench), training, pool, 2)
        inputs = inputs_of(natural_scales(bench, "joint", training), supply, 10.0, "rad")
        [given] = [each for each in inputs if each.probe == probe]
        span = span_of([training[0].simulate(bench.records()).signals], bench.records()[0], 12.0, "rad")
        term = LawTerm(given, form, "joint", span, unknown_Hz)
        values = dict(zip((free.path for free in term.free), planted, strict=True))
        # the planted machine is the rig, so that nothing has to be searched
        there = fitted(workbench, (term,), values, rounds=8)
        left = workbench.residuals(there, training, workbench.fine)
        return law_of(workbench, Judged(there, left, there.fit.counted), training, ())

    with ThreadPoolExecutor(2) as pool:
        yield find


@pytest.mark.thorough
def test_repeated_recordings_give_a_size_as_uncertain_as_its_interval_says(found) -> None:
    off = []
    for seed in range(1, SEEDS + 1):
        law = found("capacity_a", CONSTANT_TERM, (HOSE,), seed=seed)
        [size] = amplitude_intervals(law)
        assert size.value == law.amplitudes[0]
        assert size.high - size.value == pytest.approx(size.value - size.low)
        off.append(NORMAL * (size.value - HOSE) / (size.high - size.value))
    squares = float(np.sum(np.square(off)))
    assert chi2.ppf(NEVER, SEEDS) < squares < chi2.ppf(1.0 - NEVER, SEEDS)


def test_a_periodic_law_has_intervals_of_amplitude_and_frequency(found) -> None:
    law = found("supply", None, (RIPPLE_PA, 0.0, RIPPLE_HZ), unknown_Hz=RIPPLE_HZ)
    [amplitude], frequency = amplitude_intervals(law), frequency_interval(law)
    for known, planted in ((amplitude, RIPPLE_PA), (frequency, RIPPLE_HZ)):
        half = known.high - known.value
        assert abs(known.value - planted) < 2.0 * half  # four standard deviations
        assert half < 0.05 * planted
    told = known_to(law)
    assert "MPa" in told and "Hz" in told and told.count(" to ") == 2


def test_the_machine_is_told_as_it_was_fitted_with_the_law(bench, found, recorded, fitted) -> None:
    """The nominal model alone bends its bulk modulus to make up for a hose."""
    law = found("capacity_a", CONSTANT_TERM, (HOSE,))
    path = bench.full_path("fluid.bulk_modulus")
    with_law = law.intervals[path]
    assert with_law.value == law.parameters[path]
    half = with_law.high - with_law.value
    assert abs(with_law.value - bench.value(path)) < 2.0 * half
    training = recorded(bench, bench, largest_V=7.0, pressure_noise_Pa=2e4, unknown=("capacity_a", HOSE))
    with ThreadPoolExecutor(2) as pool:
        alone = fitted(Workbench(bench, free_parameters(bench), training, pool, 2))
    assert abs(alone.values[path] - bench.value(path)) > 10.0 * half


def test_what_a_law_leaves_ahead_is_told_by_the_noise_that_counts_in_the_end(bench, found, recorded) -> None:
    law = found("capacity_a", CONSTANT_TERM, (HOSE,))
    held_out = recorded(bench, bench, largest_V=7.0, pressure_noise_Pa=2e4, unknown=("capacity_a", HOSE))
    records = bench.with_values(law.parameters).records()
    as_fitted = law.held_against(held_out, records, STEP_S)
    assert as_fitted.held_out_over_noise == pytest.approx(1.0, abs=0.1)
    louder = [
        replace(e, channels=tuple(replace(c, noise=2.0 * c.noise) for c in e.channels)) for e in held_out
    ]
    assert law.held_against(louder, records, STEP_S).held_out_over_noise == pytest.approx(
        0.5 * as_fitted.held_out_over_noise, rel=0.01
    )


def test_commands_that_got_lost_have_no_interval(found) -> None:
    law = found("capacity_a", CONSTANT_TERM, (HOSE,))
    lost = LostCommands(**{**law.__dict__})
    assert amplitude_intervals(lost) == [] and known_to(lost) == ""
