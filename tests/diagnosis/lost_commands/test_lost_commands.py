"""Commands that got lost are found where they were, and nowhere else."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.evidence.noise import COARSE
from hydrolek_drake.diagnosis.laws.terms import span_of
from hydrolek_drake.diagnosis.lost_commands import found as in_commands
from hydrolek_drake.diagnosis.lost_commands.fit import LENGTHS_S, tried_about
from hydrolek_drake.diagnosis.lost_commands.found import lost_commands, names_of
from hydrolek_drake.diagnosis.lost_commands.windows import (
    WINDOW_S,
    Window,
    joined,
    merged,
    picked,
    recording_of,
    within,
)
from hydrolek_drake.diagnosis.report.words import law_sentence, where_sentence
from hydrolek_drake.diagnosis.structures.as_rig import enlarged_rig
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.parameter_set import free_parameters

LOST_S, AHEAD_S = ((3.27, 3.41), (8.14, 8.26)), ((8.08, 8.22),)


@pytest.fixture
def asked_for(bench, fitted):
    """(training, held-out data, most that may be left) -> the nominal model, and the commands that got lost."""

    def ask(training, held_out, most=math.inf):
        with ThreadPoolExecutor(2) as pool:
            workbench = Workbench(bench, free_parameters(bench), training, pool)
            nominal = fitted(workbench)
            signals = [e.simulate(bench.records()).signals for e in training]
            span = span_of(signals, bench.records()[0], 12.0, "rad")
            step = workbench.coarsest(nominal, nominal.fit.over_noise, COARSE)
            return nominal, lost_commands(workbench, nominal, held_out, span, step, most)

    return ask


def _named(name, experiments):
    [experiment] = experiments
    return [Experiment(**{**experiment.__dict__, "name": name})]


def test_commands_that_got_lost_are_found_in_both_recordings(bench, recorded, asked_for) -> None:
    training = _named("train", recorded(bench, bench, seed=1, largest_V=5.0, lost_s=LOST_S))
    held_out = _named("ahead", recorded(bench, bench, seed=2, largest_V=5.0, lost_s=AHEAD_S))
    nominal, found = asked_for(training, held_out)
    assert nominal.fit.over_noise > 2.0
    assert found is not None
    assert (
        found.fit.over_noise < 1.06
    )  # the deviation of 1200 samples of noise is known to 2 %; three times that
    assert found.held_out_over_noise < 1.1
    # a valve passes a command on within 25 ms, and a joint moves by what both ends of a window are apart
    np.testing.assert_allclose(found.windows[recording_of(training[0])], LOST_S, atol=0.02)
    np.testing.assert_allclose(found.windows[recording_of(held_out[0])], AHEAD_S, atol=0.02)
    np.testing.assert_allclose(found.acts, LOST_S, atol=0.02)
    assert list(found.more()["windows_s"]) == ["train", "ahead"]
    told = law_sentence(found) + where_sentence(found)
    assert "in train at 3.2" in told and "in ahead at 8.0" in told
    assert enlarged_rig(bench, nominal, found).laws == {}  # the machine has no law


def test_where_windows_do_not_explain_the_training_data_none_are_looked_for_ahead(
    bench, recorded, asked_for, monkeypatch
) -> None:
    looked: list[tuple] = []
    monkeypatch.setattr(in_commands, "_in_held_out", lambda *given: looked.append(given))
    training = recorded(bench, bench, seed=1, largest_V=5.0, lost_s=LOST_S)
    held_out = _named("ahead", recorded(bench, bench, seed=2, largest_V=5.0, lost_s=AHEAD_S))
    _, found = asked_for(training, held_out, most=0.9)  # nothing leaves less than the noise
    assert found is None and not looked


@pytest.mark.long("takes half a minute")
def test_lost_samples_of_a_controller_are_found_by_the_pressures(bench, recorded, asked_for) -> None:
    """20 ms, between two of the windows that are tried side by side: the joint hardly stops, and the oil rings."""
    lost_s, ahead_s = ((3.297, 3.317), (8.143, 8.163)), ((6.896, 6.916),)
    kept = {"largest_V": 9.0, "pressure_noise_Pa": 2e4}
    training = recorded(bench, bench, seed=1, lost_s=lost_s, **kept)
    held_out = recorded(bench, bench, seed=2, lost_s=ahead_s, **kept)
    nominal, found = asked_for(training, held_out)
    assert nominal.fit.over_noise > 2.0
    assert found is not None
    assert found.fit.over_noise < 1.06 and found.held_out_over_noise < 1.1
    for experiment, lost in ((training[0], lost_s), (held_out[0], ahead_s)):
        windows = found.windows[recording_of(experiment)]
        nearest = [windows[np.abs(windows[:, 0] - begin).argmin()] for begin, _ in lost]
        np.testing.assert_allclose(nearest, lost, atol=0.005)  # a fifth of the valve's time constant
        assert np.diff(windows, axis=1).sum() < 1.5 * np.diff(lost, axis=1).sum()  # and hardly any other


def test_a_machine_with_friction_has_lost_nothing(bench, recorded, asked_for) -> None:
    machine = bench.with_values({"effects.cylinder.coulomb_friction.coulomb_N": 600.0})
    training, held_out = (recorded(machine, bench, seed=seed, largest_V=5.0) for seed in (1, 2))
    nominal, found = asked_for(training, held_out)
    assert nominal.fit.over_noise > 1.5
    assert found is None or found.fit.over_noise > 1.1


def test_a_command_is_neutral_within_a_window_and_itself_after(bench, recorded) -> None:
    [experiment] = recorded(bench, bench)
    times = np.arange(0.0, 11.9, 0.001)

    def held(of):
        return of.command[np.maximum(np.searchsorted(of.command_times, times, side="right") - 1, 0)]

    windows = np.array([[2.003, 2.0155], [4.0, 4.5]])
    arrived = experiment.without_command(windows, 0.25)
    assert np.all(np.diff(arrived.command_times) > 0.0)
    inside = np.any([(times >= begin) & (times < end) for begin, end in windows], axis=0)
    np.testing.assert_array_equal(held(arrived), np.where(inside, 0.25, held(experiment)))


@pytest.mark.parametrize("at", [2.003, 2.0])  # between two commands, and with one
def test_a_window_without_length_loses_nothing(bench, recorded, at: float) -> None:
    """A fit may narrow a window down to nothing."""
    [experiment] = recorded(bench, bench)
    arrived = experiment.without_command(np.array([[at, at]]), 0.25)
    np.testing.assert_array_equal(arrived.command_times, experiment.command_times)
    np.testing.assert_array_equal(arrived.command, experiment.command)


def test_windows_are_picked_by_what_they_explain() -> None:
    rng = np.random.default_rng(4)
    columns = rng.standard_normal((500, 40))
    columns[:, 7] *= 30.0  # what moves much is not what explains much
    rest = rng.standard_normal(500) - 0.9 * columns[:, 11] - 0.6 * columns[:, 30] + 0.7 * columns[:, 20]
    chosen, multiples = picked(columns, rest)
    assert chosen[0] == 11 and set(chosen) >= {11, 30} and 20 not in chosen  # no window gives a command back
    # each of 500 values tells a multiple with the deviation of all that is left, here 1.2
    assert dict(zip(chosen, multiples, strict=True))[11] == pytest.approx(0.9, abs=3.0 * 1.2 / np.sqrt(500.0))
    assert picked(columns, rng.standard_normal(500))[0] == []  # of 40 none reaches five standard deviations


def test_no_more_is_lost_in_a_window_than_all_of_it() -> None:
    """A window in which hardly anything was commanded explains much only as its own multiple, which it cannot be."""
    rng = np.random.default_rng(5)
    lost, tiny = 20.0 * rng.standard_normal((2, 500))
    tiny *= 0.01
    rest = rng.standard_normal(500) - lost - 100.0 * tiny
    chosen, multiples = picked(np.stack([tiny, lost], axis=1), rest)
    assert chosen[0] == 1
    np.testing.assert_allclose(multiples, 1.0)


def test_recordings_of_one_name_and_one_command_are_two(bench, recorded) -> None:
    first, again, other = (
        recorded(bench, bench, seed=seed, largest_V=volts)[0]
        for seed, volts in ((1, 5.0), (1, 5.0), (2, 5.0))
    )
    repeated = Experiment(**{**again.__dict__, "channels": other.channels})
    blocks = first.split(first.time < 3.0)
    assert recording_of(blocks) == recording_of(first)
    assert len({recording_of(each) for each in (first, repeated, other)}) == 3
    assert list(names_of([first, repeated, blocks, other]).values()) == ["made", "made (2)", "made (3)"]


def test_windows_that_touch_are_one() -> None:
    whole = WINDOW_S
    [lost, later] = merged([(1.0, whole, 0.4), (1.1, whole, 0.8), (3.0, whole, 0.5)])
    assert lost == pytest.approx([1.0 + WINDOW_S * 2 / 3 + 0.05 - 0.06, 1.0 + WINDOW_S * 2 / 3 + 0.05 + 0.06])
    assert later == pytest.approx([3.025, 3.075])
    [brief] = merged(
        [(1.0, whole, 0.07)]
    )  # less than a sample of a controller, at full speed a joint misses it
    assert brief == pytest.approx([1.0465, 1.0535])
    assert merged([(1.0, whole, 0.005)]).shape == (0, 2)  # half a millisecond
    [short] = merged([(2.02, 0.2 * whole, 0.5), (2.04, 0.2 * whole, 0.5)])  # two short ones, half of each
    assert short == pytest.approx([2.03, 2.05])


def test_shorter_windows_are_tried_within_those_that_promise_most_and_beside_them() -> None:
    tried = [Window(0, k * WINDOW_S, WINDOW_S) for k in range(100)]
    gains = np.zeros(100)
    gains[[0, 40]] = 1.0
    shorter = within(tried, gains)
    begins = sorted({round(each.begin / WINDOW_S, 6) for each in shorter})
    assert begins == pytest.approx([*np.arange(0, 2, 0.2), *np.arange(39, 42, 0.2)])
    assert [each.length for each in shorter] == pytest.approx(25 * [0.2 * WINDOW_S])
    assert within(tried, np.zeros(100)) == []


def test_a_window_is_tried_elsewhere_where_it_meets_no_other() -> None:
    others = np.array([[2.0, 2.1], [5.0, 5.1]])
    tried = np.array(tried_about(2.12, 2.13, others))
    assert np.all((tried[:, 0] >= 2.1) | (tried[:, 1] <= 2.0))
    assert tried.mean(axis=1).min() == pytest.approx(1.975)  # on the other side of its neighbour
    assert tried.mean(axis=1).max() == pytest.approx(2.275)
    assert np.unique(np.diff(tried, axis=1).round(6)) == pytest.approx(LENGTHS_S)  # its own is among them


def test_windows_that_were_fitted_side_by_side_are_told_as_one() -> None:
    np.testing.assert_array_equal(
        joined(np.array([[5.0, 5.1], [1.0, 1.09], [1.095, 1.2], [5.02, 5.05]])), [[1.0, 1.2], [5.0, 5.1]]
    )
    assert joined(np.zeros((0, 2))).shape == (0, 2)
