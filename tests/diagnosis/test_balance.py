"""Signals that count alike where no model comes near the noise."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.balance import squares_of, told, weighed, weights_by
from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.conclusion import Conclusion
from hydrolek_drake.diagnosis.effort import FAR
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_choice import material
from hydrolek_drake.diagnosis.search import MATERIAL_GAIN
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

KEYS = ("joint.angle", "joint.pressure_a", "joint.pressure_b")


@pytest.fixture(scope="module")
def three(bench, recorded):
    return recorded(bench, bench, pressure_noise_Pa=2e3)


def _left(experiment, *over_noise):
    return np.repeat(over_noise, experiment.time.size).astype(float)


def _weights(three, *over_noise):
    fits = SimpleNamespace(fine=1e-3, training=three, residuals=lambda *_: _left(three[0], *over_noise))
    return weights_by(fits, SimpleNamespace(effects=(), values={}))


def test_signals_count_as_the_one_that_is_followed_best(three) -> None:
    assert [c.key for c in three[0].channels] == list(KEYS)
    assert _weights(three, 8.0, 40.0, 16.0) == pytest.approx(dict(zip(KEYS, (1.0, 5.0, 2.0), strict=True)))


def test_all_stay_far_from_the_noise(three) -> None:
    assert _weights(three, 1.0, 30.0, 2.0) == pytest.approx(
        dict(zip(KEYS, (1.0, 30.0 / FAR, 1.0), strict=True))
    )


def test_signals_that_are_followed_alike_keep_their_noise(three) -> None:
    assert _weights(three, 10.0, 13.0, 19.0) == {}
    assert _weights(three, 1.0, 1.1, 1.0) == {}


def test_the_factor_widens_the_deviation_and_is_told(three) -> None:
    wide = weighed(three, {KEYS[1]: 7.0})
    for key, before, after in zip(KEYS, three[0].channels, wide[0].channels, strict=True):
        np.testing.assert_allclose(after.deviation, (7.0 if key == KEYS[1] else 1.0) * before.deviation)
    assert "joint.pressure_a 7.0 times)" in told({KEYS[0]: 1.0, KEYS[1]: 7.0})


def test_squares_belong_to_their_signals(three) -> None:
    squares = squares_of(_left(three[0], 1.0, 2.0, 3.0), three)
    n = three[0].time.size
    assert squares == {KEYS[0]: n, KEYS[1]: 4.0 * n, KEYS[2]: 9.0 * n}


@pytest.mark.parametrize(
    ("left", "named"),
    [((5.0, 4.0, 5.0), False), ((5.0, 3.0, 5.0), True), ((5.0, 3.0, 7.0), False)],
    ids=["less than half of any signal's squares", "more than half of one's", "worse on the whole"],
)
def test_effects_must_take_a_material_part_of_one_signal_and_spoil_nothing(three, left, named) -> None:
    counted = 3 * three[0].time.size
    judged = tuple(
        Judged(SimpleNamespace(effects=effects), _left(three[0], *over), counted, probability=0.5)
        for effects, over in (((1,), left), ((), (5.0, 5.0, 5.0)))
    )
    done = material(Conclusion("unlisted_physics", judged[0], {}, ()), judged, three)
    assert bool(done.best.hypothesis.effects) is named


def test_what_explains_by_a_wider_noise_is_no_explanation(three) -> None:
    counted = 3 * three[0].time.size
    judged = tuple(
        Judged(SimpleNamespace(effects=effects), _left(three[0], *over), counted, probability=0.5)
        for effects, over in (((1,), (0.9, 1.0, 0.8)), ((), (5.0, 5.0, 5.0)))
    )
    for verdict in ("missing_physics", "ambiguous"):
        done = material(Conclusion(verdict, judged[0], {}, (("one", "other"),)), judged, three)
        assert (done.verdict, done.best) == ("unlisted_physics", judged[0])
        assert done.groups == (("one", "other"),)  # rivals of what is named are told


def test_a_shifted_null_shows_beside_a_pressure_that_rings_as_nothing_explains(bench, recorded) -> None:
    shift = 2e-5
    path = "joints.joint.effects.valve.asymmetric_overlap.shift_m"
    machine = bench.with_values({path: shift})
    experiment = recorded(machine, bench, pressure_noise_Pa=2e3)[0]
    angle, first, second = experiment.channels
    ringing = 3e6 * np.sin(2.0 * np.pi * 0.4 * experiment.time)
    training = (
        replace(experiment, channels=(angle, replace(first, measured=first.measured + ringing), second)),
    )
    effect = next(
        c
        for c in candidates_of(bench, "joint", natural_scales(bench, "joint", training))
        if c.id == "valve.asymmetric_overlap"
    )
    with ThreadPoolExecutor(2) as pool:
        fits = Workbench(bench, free_parameters(bench), training, pool)
        gains, found, needed = [], [], []
        for _ in range(2):
            nominal = fits.fit((), {}, 2e-3, 10)
            named = fits.fit((effect,), {**nominal.values, path: 0.5 * shift}, 2e-3, 10)
            gains.append(1.0 - named.fit.objective / nominal.fit.objective)
            found.append(named.values[path])
            needed.append(MATERIAL_GAIN / fits.alike)
            fits.training = weighed(fits.training, weights_by(fits, named))
    assert gains[0] < needed[0]  # by its noise alone, the pressure outweighs what the shift explains
    assert gains[1] > needed[1]
    assert abs(found[1] - shift) < 0.5 * abs(found[0] - shift)
