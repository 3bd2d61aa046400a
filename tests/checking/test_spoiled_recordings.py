"""Each mistake that engineers make with a recording, once: it is told in words; sound recordings are left alone."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.checking.recording_checks import check_recording
from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out

NOISE, PRESSURE_NOISE = 8e-4, 2e4  # rad, Pa


@pytest.fixture(scope="module")
def rig():
    """A link with a pump and a valve of four edges."""
    return load_rig("hopsan_link")


@pytest.fixture(scope="module")
def sound(rig):
    """A recording of that link, whose numbers are some per cent off the rig's."""
    generator = np.random.default_rng(1)
    times = np.arange(0.0, 12.0, 0.01)
    levels = generator.uniform(-2.0, 2.0, size=40)
    levels[0] = 0.0
    volts = np.repeat(levels, 31)[: times.size]
    other = {
        "load.mass": 1.1 * rig.value("load.mass"),
        "fluid.bulk_modulus": 0.9 * rig.value("fluid.bulk_modulus"),
    }
    signals = roll_out(rig.with_values(other).records(), times, volts, times, longest_step=5e-4).signals
    noisy = {
        "joint.angle": signals.reading + NOISE * generator.standard_normal(times.size),
        "joint.pressure_a": signals.pressure_a + PRESSURE_NOISE * generator.standard_normal(times.size),
        "joint.pressure_b": signals.pressure_b + PRESSURE_NOISE * generator.standard_normal(times.size),
        "supply.pressure": signals.supply_pressure + PRESSURE_NOISE * generator.standard_normal(times.size),
    }
    units = {"joint.command": "V", "joint.angle": "rad", **{k: "Pa" for k in noisy if "pressure" in k}}
    return Recording("sound", times, {"joint.command": volts, **noisy}, Path("sound.csv"), units=units)


def _with(recording, **signals):
    changed = {key.replace("__", "."): values for key, values in signals.items()}
    return replace(recording, signals={**recording.signals, **changed})


def _wrong(rig, recording):
    return [complaint.sentence() for complaint in check_recording(rig, recording) if complaint.wrong]


def test_a_sound_recording_is_left_alone(rig, sound):
    assert check_recording(rig, sound) == []


SCALED = [
    ("joint__angle", 180 / np.pi, "deg in a column of rad", "joint.angle_rad: joint.angle_deg"),
    ("joint__angle", np.pi / 180, "rad in a column of deg", "joint.angle_deg: joint.angle_rad"),
    ("joint__command", 1e3, "mV in a column of V", "joint.command_V: joint.command_mV"),
    ("joint__command", 1e-3, "V in a column of mV", "joint.command_mV: joint.command_V"),
    ("joint__pressure_a", 1e-5, "bar in a column of Pa", "joint.pressure_a_Pa: joint.pressure_a_bar"),
    ("joint__pressure_b", 1e-6, "MPa in a column of Pa", "joint.pressure_b_Pa: joint.pressure_b_MPa"),
    ("joint__pressure_a", 1e-3, "kPa in a column of Pa", "joint.pressure_a_Pa: joint.pressure_a_kPa"),
    ("joint__pressure_b", 1e5, "Pa in a column of bar", "joint.pressure_b_bar: joint.pressure_b_Pa"),
    ("supply__pressure", 1e6, "Pa in a column of MPa", "supply.pressure_MPa: supply.pressure_Pa"),
    ("supply__pressure", 1e-5, "bar in a column of Pa", "supply.pressure_Pa: supply.pressure_bar"),
]


@pytest.mark.parametrize(("key", "factor", "says", "line"), SCALED)
def test_a_slip_of_unit_is_named_with_the_line_that_mends_it(rig, sound, key, factor, says, line):
    found = _wrong(rig, _with(sound, **{key: factor * sound.signals[key.replace("__", ".")]}))
    assert len(found) == 1 and says in found[0] and line in found[0]


@pytest.mark.parametrize("key", ["joint__command", "joint__angle"])
def test_a_wrong_sign_is_named(rig, sound, key):
    found = _wrong(rig, _with(sound, **{key: -sound.signals[key.replace("__", ".")]}))
    assert any("moves against its command" in said and "polarity: {value: -1" in said for said in found)


def test_exchanged_pressures_are_named(rig, sound):
    a, b = sound.signals["joint.pressure_a"], sound.signals["joint.pressure_b"]
    [said] = _wrong(rig, _with(sound, joint__pressure_a=b, joint__pressure_b=a))
    assert "exchanged" in said and "joint.pressure_a_Pa: joint.pressure_b_Pa" in said


@pytest.mark.parametrize("key", ["joint__pressure_a", "supply__pressure", "joint__angle"])
def test_a_column_that_does_not_move_is_named(rig, sound, key):
    still = np.full(sound.time.size, float(np.median(sound.signals[key.replace("__", ".")])))
    assert any("constant" in said for said in _wrong(rig, _with(sound, **{key: still})))


def test_a_constant_command_is_named(rig, sound):
    found = _wrong(rig, _with(sound, joint__command=np.full(sound.time.size, 1.5)))
    assert any("constant at 1.5 V" in said for said in found)


def test_a_joint_that_reaches_its_stop_sooner_than_the_model_has_no_clock_that_is_apart(rig) -> None:
    """Under a constant command the end of a move says how fast a joint is, not when its command came."""
    times = np.arange(0.0, 10.0, 0.01)
    volts = np.select([times < 0.5, times < 5.0], [0.0, 5.0], -5.0)
    faster = rig.with_values({"valve.discharge": 1.6 * rig.value("valve.discharge")})
    moved = roll_out(faster.records(), times, volts, times, longest_step=5e-4).signals
    noise = NOISE * np.random.default_rng(4).standard_normal(times.size)
    told = Recording(
        "steps", times, {"joint.command": volts, "joint.angle": moved.reading + noise}, Path("steps.csv")
    )
    assert not any("clocks" in said for said in _wrong(rig, told))
    early = _with(told, joint__angle=np.roll(told.signals["joint.angle"], -30))
    assert any("before its command" in said for said in _wrong(rig, early))


def test_a_sensor_s_clock_that_is_ahead_is_named(rig, sound):
    early = {key: np.roll(values, -30) for key, values in sound.signals.items() if key != "joint.command"}
    found = _wrong(rig, replace(sound, signals={**sound.signals, **early}))
    assert any("before its command" in said and "clocks" in said for said in found)


def test_an_answer_that_comes_late_is_told_and_may_be_dead_time(rig, sound):
    late = {key: np.roll(values, 20) for key, values in sound.signals.items() if key != "joint.command"}
    found = check_recording(rig, replace(sound, signals={**sound.signals, **late}))
    assert any("later than the rig's dead time" in c.says and not c.wrong for c in found)


def test_ms_for_s_and_s_for_ms_are_refused_before_anything_is_computed(rig, sound):
    sparse = replace(sound, time=1e3 * sound.time)
    with pytest.raises(InputError, match=r"ms in a column of s.*time_s: time_ms"):
        check_recording(rig, sparse)
    with pytest.raises(InputError, match=r"s in a column of ms.*time_ms: time_s"):
        check_recording(rig, replace(sound, time=1e-3 * sound.time))


def test_a_pump_that_gives_less_than_the_rig_says_is_told_from_the_supply(rig, sound):
    per_radian = rig.with_values({"supply.displacement": 2 * np.pi * rig.value("supply.displacement")})
    fallen = sound.signals["supply.pressure"].copy()
    fallen[400:430] = 7e6
    found = _wrong(per_radian, _with(sound, supply__pressure=fallen))
    assert any("meant per turn" in said and "cm^3/rev" in said for said in found)


def test_what_a_recording_cannot_tell_is_told(rig, sound):
    rising = replace(
        sound.between(0.0, 0.6), signals={k: v for k, v in sound.between(0.0, 0.6).signals.items()}
    )
    told = [c.says for c in check_recording(rig, rising) if not c.wrong]
    assert any("reverses" in said for said in told)
    without = {k: v for k, v in sound.signals.items() if not k.startswith("joint.pressure")}
    assert any(
        c.says.startswith("was not recorded") for c in check_recording(rig, replace(sound, signals=without))
    )
