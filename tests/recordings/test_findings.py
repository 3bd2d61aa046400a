"""What is reported about a recording, and that nothing is reported about a clean one."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording, read_recording, require, write_signals


@pytest.fixture
def read_back(tmp_path):
    """Writes signals and reads them as a recording."""

    def read(time, **signals):
        path = tmp_path / "run.csv"
        return read_recording(
            write_signals(path, time, {f"j.{name}": values for name, values in signals.items()}),
        )

    return read


@pytest.fixture
def noisy():
    rng = np.random.default_rng(3)
    time = 0.01 * np.arange(1000)
    return time, np.sin(2 * time) + rng.normal(0, 0.001, time.size)


def only(recording, kind):
    assert [finding.kind for finding in recording.findings] == [kind]
    return recording.findings[0]


def test_clean_recording_has_no_findings(read_back, noisy):
    time, angle = noisy
    assert read_back(time, angle=angle, command=np.sign(angle)).findings == ()


def test_gap(read_back, noisy):
    time, angle = noisy
    keep = (time < 3.0) | (time > 3.5)
    found = only(read_back(time[keep], angle=angle[keep]), "gap")
    np.testing.assert_allclose(found.spans, [(2.99, 3.51)])
    assert "1 gaps" in found.message and "0.52 s" in found.message


def test_interval_of_exactly_three_is_no_gap_but_off_the_clock(read_back, noisy):
    """Two lost samples make an interval of three usual ones."""
    _, angle = noisy
    time = np.arange(1000) / 128  # binary fractions, so that three intervals are exactly three
    keep = np.ones(time.size, dtype=bool)
    keep[500:502] = False
    found = only(read_back(time[keep], angle=angle[keep]), "clock")
    assert found.spans == ((499 / 128, 502 / 128),)


def test_clock_jitter(read_back, noisy):
    time, angle = noisy
    late = time.copy()
    late[200] += 0.004
    found = only(read_back(late, angle=angle), "clock")
    np.testing.assert_allclose(found.spans, [(1.99, 2.01)])
    assert found.message.startswith("2 of 999 sample intervals")


def test_repeated_time_stamps_keep_the_first(read_back, noisy):
    time, angle = noisy
    recording = read_back(np.insert(time, 500, time[499]), angle=np.insert(angle, 500, 99.0))
    found = only(recording, "duplicate")
    assert found.spans == ((time[499], time[499]),)
    np.testing.assert_array_equal(recording.signal("j.angle"), angle)


def test_nan_stretches(read_back, noisy):
    time, angle = noisy
    angle[100:110] = np.nan
    angle[999] = np.nan
    angle[300] = np.inf
    recording = read_back(time, angle=angle)
    found = only(recording, "nan")
    np.testing.assert_allclose(found.spans, [(1.0, 1.09), (3.0, 3.0), (9.99, 9.99)])
    assert found.signal == "j.angle" and "12 of 1000" in found.message
    assert np.isnan(recording.signal("j.angle")).sum() == 12


def test_constant(read_back, noisy):
    time, angle = noisy
    found = only(read_back(time, angle=angle, pressure=np.full(time.size, 5e6)), "constant")
    assert found.signal == "j.pressure" and found.spans == ((0.0, 9.99),)


@pytest.mark.parametrize("sign", [1, -1])
def test_saturated(read_back, noisy, sign):
    time, angle = noisy
    limit = np.sin(2 * 0.5)
    clipped = sign * np.minimum(angle, limit)
    found = only(read_back(time, angle=clipped), "saturated")
    assert ("largest" if sign > 0 else "smallest") in found.message
    # sin(2 t) is above its value at 0.5 s until pi/2 - 0.5 s, with period pi; the recording ends at 9.99 s.
    period = np.pi * np.arange(4)
    expected = np.minimum(np.column_stack([0.5 + period, np.pi / 2 - 0.5 + period]), 9.99)
    np.testing.assert_allclose(found.spans, expected, atol=0.02)


def test_saturated_stretch_at_the_start_counts_with_a_later_one(read_back):
    time = 0.01 * np.arange(700)
    recording = read_back(time, pot=np.minimum(np.cos(2 * time), 0.9))
    assert len(only(recording, "saturated").spans) == 3


def test_rest_is_not_saturation(read_back):
    """A noise-free signal that rests, moves and comes to rest again is cut off nowhere."""
    time = 0.01 * np.arange(1000)
    phase = np.clip((time - 3) / 4, 0, 1)
    moving = phase**3 * (10 - 15 * phase + 6 * phase**2)  # minimum-jerk move
    assert read_back(time, position=moving).findings == ()


def test_coarse_quantisation_is_not_saturation(read_back):
    time = 0.001 * np.arange(5000)
    assert read_back(time, angle=np.round(np.sin(time), 1)).findings == ()


def test_commands_may_sit_at_their_limits(read_back, noisy):
    time, angle = noisy
    command = 10 * np.sign(np.sin(time))
    assert read_back(time, angle=angle, command=command).findings == ()


@pytest.fixture
def emps_like(write_lines):
    return read_recording(
        write_lines("time_s,j.command_V,j.angle_deg,qm\n2,1,1,0\n3,,2,0\n4,3,,0\n", "run.csv")
    )


def test_require_is_satisfied_whatever_the_unit_of_an_absent_signal(emps_like):
    keys, units = ["j.command", "j.angle"], {"j.command": "V", "j.absent": "m"}
    assert set(emps_like.signals) == set(keys)
    require(emps_like, keys, units=units)
    with pytest.raises(InputError, match=r"j\.command is in V; A is needed"):
        require(emps_like, keys, units={**units, "j.command": "A"})


def test_require_names_what_is_missing_and_how_to_map_it(emps_like):
    with pytest.raises(InputError) as refused:
        require(emps_like, ["j.angle", "j.pot"])
    message = str(refused.value)
    assert (
        "run.csv: signal j.pot is missing; the file has j.angle, j.command and the unused columns qm"
        in message
    )
    assert "columns: {qm: j.pot_<unit>}" in message
    assert "\n" not in message


def test_require_complete_names_the_first_time_without_value(emps_like):
    with pytest.raises(InputError, match=r"run.csv: signal j.command has no value at 3 s \(1 of 3 samples\)"):
        require(emps_like, ["j.angle"], complete=["j.command"])
    with pytest.raises(InputError, match=r"signal j.pot is missing"):
        require(emps_like, [], complete=["j.pot"])
    part = Recording("n", np.arange(2.0), {"j.command": np.ones(2)}, emps_like.source)
    require(part, [], complete=["j.command"])


def test_require_unit(emps_like):
    with pytest.raises(InputError, match=r"signal j.command is in V; A is needed"):
        require(emps_like, [], units={"j.command": "A"})
