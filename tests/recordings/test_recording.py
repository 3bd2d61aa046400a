import pickle
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Finding, Recording


@pytest.fixture
def recording():
    time = np.array([2.0, 2.1, 2.2, 2.3, 2.4, 3.4, 3.5])
    return Recording(
        name="run",
        time=time,
        signals={"j.command": np.array([0.0, 1, 2, 3, 4, 5, 6]), "j.angle": 10 * time},
        source=Path("run.csv"),
        findings=(
            Finding("gap", None, "gap", ((2.4, 3.4),)),
            Finding("nan", "j.angle", "nan", ((2.0, 2.1), (3.5, 3.5))),
        ),
    )


def test_signal_that_is_missing_names_recording_and_choices(recording):
    with pytest.raises(InputError, match=r"recording run .*'j.pot'; it has j.angle, j.command"):
        recording.signal("j.pot")


def test_signals_cannot_be_altered_and_do_not_alias_the_input(recording):
    with pytest.raises(ValueError, match=r"read-only"):
        recording.signal("j.angle")[0] = 1.0
    own = np.array([1.0, 2.0])
    made = Recording("n", np.array([0.0, 1.0]), {"j.angle": own}, Path("n"))
    own[0] = 5.0
    assert made.signal("j.angle")[0] == 1.0


def test_survives_being_sent_to_another_process(recording):
    copy = pickle.loads(pickle.dumps(recording))
    np.testing.assert_array_equal(copy.signal("j.angle"), recording.signal("j.angle"))
    assert (copy.findings, copy.units) == (recording.findings, recording.units)


def test_duration_and_recorded_clock(recording):
    assert recording.duration == 1.5
    assert recording.time[0] == 2.0


def test_between_includes_both_ends_and_cuts_findings(recording):
    part = recording.between(2.1, 2.3)
    np.testing.assert_array_equal(part.time, [2.1, 2.2, 2.3])
    np.testing.assert_array_equal(part.signal("j.command"), [1, 2, 3])
    assert [finding.kind for finding in part.findings] == ["nan"]
    assert part.findings[0].spans == ((2.1, 2.1),)
    with pytest.raises(InputError, match=r"has 1 samples between"):
        recording.between(3.0, 3.4)


def test_resampled_holds_commands_and_interpolates_sensors(recording):
    at = np.array([2.0, 2.05, 2.399, 2.4, 3.45, 3.5])
    resampled = recording.resampled(at)
    np.testing.assert_array_equal(resampled.signal("j.command"), [0, 0, 3, 4, 5, 6])
    np.testing.assert_allclose(resampled.signal("j.angle"), 10 * at, rtol=1e-12)


def test_resampled_invents_nothing_in_a_gap(recording):
    resampled = recording.resampled(np.array([2.4, 2.9, 3.4]))
    np.testing.assert_array_equal(resampled.signal("j.angle"), [24.0, np.nan, 34.0])
    np.testing.assert_array_equal(resampled.signal("j.command"), [4, 4, 5])


def test_resampled_keeps_samples_beside_a_nan():
    time = np.arange(5.0)
    recording = Recording("n", time, {"j.angle": np.array([0, 1, np.nan, 3, 4])}, Path("n"))
    values = recording.resampled(np.array([1.0, 1.5, 2.0, 2.5, 3.0])).signal("j.angle")
    np.testing.assert_array_equal(values, [1, np.nan, np.nan, np.nan, 3])


def test_resampled_at_its_own_times_is_the_same(recording):
    same = recording.resampled(recording.time)
    for key, values in recording.signals.items():
        np.testing.assert_array_equal(same.signal(key), values)


def test_resampled_does_not_extrapolate_but_forgives_rounding(recording):
    with pytest.raises(InputError, match=r"it lasts from 2 s to 3.5 s"):
        recording.resampled(np.array([3.0, 3.6]))
    end = recording.resampled(np.array([3.4, np.nextafter(3.5, 4)]))
    assert end.signal("j.command")[-1] == 6


@pytest.mark.parametrize("time", [[0.0], [0.0, 0.0], [1.0, 0.0], [0.0, np.nan]])
def test_time_must_increase(time):
    with pytest.raises(InputError, match=r"strictly increasing"):
        Recording("n", np.array(time), {}, Path("n"))


def test_signals_are_as_long_as_time():
    with pytest.raises(InputError, match=r"j.angle has shape \(3,\), time \(2,\)"):
        Recording("n", np.arange(2.0), {"j.angle": np.zeros(3)}, Path("n"))
