"""Which command, start and time a replay takes, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay import compare, replay
from hydrolek_drake.rigs import load_rig


def test_bench_with_its_own_parameters_leaves_only_noise(labelled_rig, bench_recording):
    (angle,) = compare(replay(labelled_rig("practice_01"), bench_recording("practice_01")))
    assert np.degrees(angle.rms) <= 0.055  # bench.md: noise about 0.05 deg, reproduced with 0.049
    assert angle.agrees
    assert angle.spans == ()
    assert "agree to the noise" in angle.sentence()


def test_bench_with_its_own_parameters_and_leak_leaves_only_noise(labelled_rig, bench_recording):
    angle, *_ = compare(replay(labelled_rig("practice_03", effects=True), bench_recording("practice_03")))
    assert np.degrees(angle.rms) <= 0.055
    assert angle.agrees


def test_times_need_not_start_at_zero_nor_be_uniform(labelled_rig, bench_recording):
    recording = bench_recording("practice_01")
    rng = np.random.default_rng(3)
    # samples are dropped only where the command is held, so that it changes when it did
    changes = np.flatnonzero(np.diff(recording.signal("joint.command"))) + 1
    kept = np.union1d(np.union1d(changes, [0]), np.flatnonzero(rng.random(recording.time.size) > 0.3))
    thinned = Recording(
        "thinned",
        recording.time[kept] + 1234.5,
        {key: values[kept] for key, values in recording.signals.items()},
        recording.source,
    )
    (angle,) = compare(replay(labelled_rig("practice_01"), thinned))
    assert np.degrees(angle.rms) <= 0.055


def test_signals_with_gaps_are_compared_where_they_are(labelled_rig, bench_recording):
    recording = bench_recording("practice_01")
    angle = recording.signal("joint.angle").copy()
    angle[500:900] = np.nan
    holed = replace(recording, signals={**recording.signals, "joint.angle": angle})
    (compared,) = compare(replay(labelled_rig("practice_01"), holed))
    assert compared.samples == recording.time.size - 400
    assert compared.agrees


def test_part_begins_where_the_recording_is_and_is_told_what_was_commanded_before(
    labelled_rig, bench_recording
):
    rig, recording = labelled_rig("practice_01"), bench_recording("practice_01")
    moved = np.ptp(np.lib.stride_tricks.sliding_window_view(recording.signal("joint.angle"), 20), axis=1)
    quiet = recording.time[np.flatnonzero(moved < np.radians(0.4))]  # 20 samples of noise span 0.2 deg
    start = next(time for time in quiet if time > 2.0)
    part = replay(rig, recording, (float(start), float(start) + 2.0))
    assert part.recording.time[0] == start
    first = np.median(part.recording.signal("joint.angle")[:5])
    assert part.outcomes["joint"].signals.position[0] == pytest.approx(first, abs=1e-12)
    assert part.notes == ()


def test_command_before_the_part_acts_for_as_long_as_the_delay(bench_recording):
    """A part that begins one sample after a command step still sees that step a delay later, not at once."""
    rig = load_rig("joint_bench").with_values({"command.delay": 0.05, "fluid.bulk_modulus": 1e9})
    time = np.arange(0.0, 1.0, 0.01)
    recording = Recording(
        "step",
        time,
        {
            "joint.command": np.where(time < 0.495, 0.0, 8.0),
            "joint.angle": np.full(time.size, np.radians(25.0)) + 1e-6 * np.sin(50 * time),
        },
        rig.path,
    )
    spool = replay(rig, recording, (0.51, 0.99)).outcomes["joint"].signals.spool
    times = time[(time >= 0.51) & (time <= 0.99)]
    assert np.all(spool[times < 0.545] == 0.0)
    assert np.all(spool[times > 0.56] > 0.0)


def test_moving_start_is_said(labelled_rig, bench_recording):
    rig, recording = labelled_rig("practice_01"), bench_recording("practice_01")
    rate = np.abs(np.diff(recording.signal("joint.angle"), n=1))
    moving = float(recording.time[int(np.convolve(rate, np.ones(10) / 10, mode="same").argmax())])
    notes = replay(rig, recording, (moving, moving + 1.0)).notes
    assert len(notes) == 1
    assert "the model starts at rest" in notes[0]


def test_other_start_than_the_rigs_is_said(labelled_rig, bench_recording):
    rig = labelled_rig("practice_01").with_values({"load.initial_position": np.radians(30.0)})
    notes = replay(rig, bench_recording("practice_01")).notes
    assert "25 deg in the recording but at 30 deg in the rig" in notes[0]


def test_command_with_a_missing_value_is_refused_with_its_time(labelled_rig, bench_recording):
    recording = bench_recording("practice_01")
    command = recording.signal("joint.command").copy()
    command[700] = np.nan
    holed = replace(recording, signals={**recording.signals, "joint.command": command})
    with pytest.raises(InputError, match=r"joint\.command has no value at 7 s"):
        replay(labelled_rig("practice_01"), holed)
    after = replay(labelled_rig("practice_01"), holed, (8.0, 9.0))
    assert after.recording.time[0] == 8.0


@pytest.mark.parametrize("window", [(5.0, 5.0), (6.0, 5.0), (100.0, 200.0)])
def test_empty_window_is_refused(labelled_rig, bench_recording, window):
    with pytest.raises(InputError):
        replay(labelled_rig("practice_01"), bench_recording("practice_01"), window)


def test_recording_of_another_machine_is_refused(bench_recording):
    with pytest.raises(InputError, match=r"signal axis\.command is missing"):
        replay(load_rig("emps"), bench_recording("practice_01"))


def test_potentiometer_is_read_with_its_calibration(labelled_rig, bench_recording, tmp_path):
    volts_per_degree, zero_voltage = 0.037, 2.11
    path = tmp_path / "with_pot.yaml"
    path.write_text(
        "name: with_pot\nbased_on: joint_bench\n"
        "joints:\n  joint:\n    sensor:\n      variant: potentiometer\n"
        "      travel_lower: {value: -10.3, unit: deg, source: test}\n"
        "      travel_upper: {value: 65.6, unit: deg, source: test}\n"
        f"      volts_per_degree: {{value: {volts_per_degree}, unit: V/deg, source: test}}\n"
        f"      zero_voltage: {{value: {zero_voltage}, unit: V, source: test}}\n"
    )
    recording = bench_recording("practice_01")
    volts = zero_voltage + volts_per_degree * np.degrees(recording.signal("joint.angle"))
    with_pot = Recording(
        "pot",
        recording.time,
        {"joint.command": recording.signal("joint.command"), "joint.pot": volts},
        recording.source,
    )
    (pair,) = replay(load_rig(path), with_pot).pairs
    assert pair.key == "joint.angle"
    np.testing.assert_allclose(pair.measured, recording.signal("joint.angle"), rtol=0, atol=1e-12)
    with pytest.raises(InputError, match="has no potentiometer"):
        replay(load_rig("joint_bench"), with_pot)


def test_divergence_is_a_note_and_is_compared_up_to_there():
    rig = load_rig("emps").with_values({"cylinder.force_constant": 1e6, "load.inertia": 1.0})
    time = np.arange(0.0, 10.0, 0.01)
    recording = Recording(
        "runaway",
        time,
        {"axis.command": np.full(time.size, 10.0), "axis.position": 1e-3 * np.sin(time)},
        rig.path,
    )
    result = replay(rig, recording)
    (axis,) = compare(result)
    assert 0 < axis.samples < time.size
    assert any("left all bounds at" in note for note in result.notes)


@pytest.fixture
def two_joint_rig(tmp_path):
    path = tmp_path / "two_joints.yaml"
    path.write_text(
        "name: two_joints\nbased_on: joint_bench\njoints:\n  other:\n    like: joint\n"
        "effects:\n  supply.pressure_droop:\n"
        "    resistance_Pa_s_per_m3: {value: 2.0e+10, unit: Pa s/m^3, source: test}\n"
    )
    return load_rig(path)


def _two_joint_recording(recording, command_other):
    command, angle = recording.signal("joint.command"), recording.signal("joint.angle")
    signals = {
        "joint.command": command,
        "joint.angle": angle,
        "supply.pressure": np.full(angle.size, 16e6),
        "other.angle": angle,
    }
    if command_other is not None:
        signals["other.command"] = command_other
    return Recording("two", recording.time, signals, recording.source)


def test_joints_share_one_supply(two_joint_rig, bench_recording):
    recording = bench_recording("practice_01")
    both = replay(
        two_joint_rig, _two_joint_recording(recording, recording.signal("joint.command")), (0.0, 6.0)
    )
    assert list(both.outcomes) == ["joint", "other"]
    (supply,) = [pair for pair in both.pairs if pair.key == "supply.pressure"]
    full = two_joint_rig.value("supply.pressure")
    for joint in both.outcomes.values():
        np.testing.assert_allclose(supply.model, joint.signals.supply_pressure, rtol=1e-12)
    assert supply.joint is None
    alone = replay(two_joint_rig, _two_joint_recording(recording, None), (0.0, 6.0))
    (own,) = [pair for pair in alone.pairs if pair.key == "supply.pressure"]
    # two that draw let it fall further than one, and less than twice as far, for they are slower
    assert 1.0 < (full - supply.model.min()) / (full - own.model.min()) < 2.0
    assert full - own.model.min() > 1e5


def test_joint_without_command_is_left_out_and_said_to_be(two_joint_rig, bench_recording):
    result = replay(two_joint_rig, _two_joint_recording(bench_recording("practice_01"), None), (0.0, 6.0))
    assert list(result.outcomes) == ["joint"]
    assert result.notes == ("without a command in the recording, left out: other",)
