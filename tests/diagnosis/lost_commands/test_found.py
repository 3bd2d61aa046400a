"""Commands that got lost are found where they were, in each recording, and nowhere else."""

import numpy as np
import pytest

from hydrolek_drake.diagnosis.laws.enlarged_rig import enlarged_rig
from hydrolek_drake.diagnosis.laws.found import names_of
from hydrolek_drake.diagnosis.report.words import law_sentence, where_sentence
from hydrolek_drake.diagnosis.structures.lost_windows import joined, recording_of
from hydrolek_drake.identification.experiments.experiment import Experiment

LOST_S, HELD_OUT_S = ((3.27, 3.41), (8.14, 8.26)), ((8.08, 8.22),)
BRIEF_S, BRIEF_HELD_OUT_S = ((3.297, 3.317), (8.143, 8.163)), ((6.896, 6.916),)
FEW = ("cylinder.coulomb_friction", "sensor.drift")
"""Effects that are candidates too; a matter of time."""


@pytest.mark.long("takes a third of a minute")
@pytest.mark.parametrize(
    ("lost_s", "held_out_s", "how", "close_s"),
    [
        # a valve passes a command on within 25 ms, and a joint moves by what both ends of a window are apart
        (LOST_S, HELD_OUT_S, {"largest_V": 5.0, "pressure_noise_Pa": None}, 0.02),
        # lost samples of a controller, between two of the windows that are tried: the joint hardly stops, and the oil
        # rings; a fifth of the valve's time constant
        (BRIEF_S, BRIEF_HELD_OUT_S, {"largest_V": 9.0, "pressure_noise_Pa": 2e4}, 0.005),
    ],
)
def test_commands_that_got_lost_are_found_in_both_recordings(
    bench, answer_of, lost_s, held_out_s, how, close_s
) -> None:
    answer = answer_of({}, FEW, own={}, trained={"lost_s": lost_s}, lost_s=held_out_s, **how)
    found, known = answer.law, answer.known
    assert known.found.baseline.fit.over_noise > 2.0
    assert answer.conclusion.verdict == "unlisted_physics" and found is not None
    assert (
        found.fit.over_noise < 1.06
    )  # the deviation of 1200 samples of noise is known to 2 %; three times that
    assert found.held_out_over_noise < 1.1
    told = law_sentence(found) + where_sentence(found)
    for experiment, lost in ((known.bench.training[0], lost_s), (known.held_out[0], held_out_s)):
        windows = found.windows[recording_of(experiment)]
        np.testing.assert_allclose(windows, lost, atol=close_s)
        assert f"at {', '.join(f'{begin:.2f}' for begin in windows[:, 0])} s" in told
    np.testing.assert_allclose(found.acts, lost_s, atol=close_s)
    assert len(found.more()["windows_s"]) == 2
    assert enlarged_rig(bench, answer.conclusion.best.hypothesis, found).laws == {}  # the machine has no law


@pytest.mark.long("takes half a minute: loops over lanes with laws are compiled")
def test_a_machine_with_friction_has_lost_nothing(answer_of) -> None:
    friction = {"joints.joint.effects.cylinder.coulomb_friction.coulomb_N": 600.0}
    answer = answer_of(friction, FEW, largest_V=5.0, pressure_noise_Pa=None)
    assert answer.law is None
    assert [c.id for c in answer.conclusion.best.hypothesis.effects] == ["cylinder.coulomb_friction"]


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


def test_windows_that_were_fitted_side_by_side_are_told_as_one() -> None:
    np.testing.assert_array_equal(
        joined(np.array([[5.0, 5.1], [1.0, 1.09], [1.095, 1.2], [5.02, 5.05]])), [[1.0, 1.2], [5.0, 5.1]]
    )
    assert joined(np.zeros((0, 2))).shape == (0, 2)
