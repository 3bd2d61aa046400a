"""The observer is the rollout's own; what it sees of a stream is judged, gathered and remembered."""

from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.physics import sensor
from hydrolek_drake.recordings import Recording, read_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.onwards import JointOnwards, JointsOnwards
from hydrolek_drake.rollout.rest import state_at_reading
from hydrolek_drake.watching.live import windows as gathered
from hydrolek_drake.watching.live.blocks import healthy_of
from hydrolek_drake.watching.live.following import Follower
from hydrolek_drake.watching.live.observing import Observer
from hydrolek_drake.watching.live.samples import Samples, by_joint, refuse_driven
from hydrolek_drake.watching.live.settings import EVENTS, HISTORY_S, SHOWN_HZ

UNITS = {"joint.command": "V", "joint.angle": "rad"}
NOISE = 3e-4
WINDOW_S = 4.0


@pytest.fixture(scope="module")
def rig():
    return load_rig("joint_bench")


def _made(rig, seconds, seed, leakage=0.0):
    """Time, command and noisy reading of the model itself."""
    rng = np.random.default_rng(seed)
    time = 0.01 * np.arange(round(100 * seconds))
    steps = rng.uniform(3.0, 5.0, time.size // 50 + 1)
    steps[1::2] *= -1.0  # it stays about where it is
    volts = np.repeat(steps, 50)[: time.size]
    machine = rig.with_values({"effects.cylinder.cross_port_leakage.conductance_m3_per_s_Pa": leakage})
    step, spool = rig.value("integration.longest_step"), int(rig.value("integration.spool_steps"))
    done = roll_out(machine.records(), time, volts, time, longest_step=step, spool_steps=spool)
    assert done.diverged is None
    return time, volts, done.signals.reading + NOISE * rng.standard_normal(time.size)


@pytest.fixture(scope="module")
def healthy(rig):
    recordings = []
    for seed in (1, 2):
        time, volts, reading = _made(rig, 20.0, seed)
        signals = {"joint.command": volts, "joint.angle": reading}
        recordings.append(Recording(f"reference {seed}", time, signals, Path("made.csv")))
    return healthy_of(rig, ("joint",), recordings)


def _fed(follower, time, volts, reading, begin=0.0, begins=False, arrival=None):
    for first in range(0, time.size, 100):
        part = slice(first, first + 100)
        signals = {"joint.command": volts[part], "joint.angle": reading[part]}
        follower.take(
            Samples(begin + time[part], signals, UNITS, begins and first == 0), arrival, 1e9 + begin
        )


def test_a_joint_that_is_pulled_step_by_step_is_the_rollout_that_is(rig):
    time, volts, reading = _made(rig, 2.0, 5)
    measured = np.full((time.size, 3), np.nan)
    measured[:, 0] = reading
    machine = JointOnwards(rig, "joint", 0.0, float(reading[0]))
    begin = machine.states()[0]
    stepped = [machine.signals[0, 0]]
    for i in range(time.size - 1):
        machine.advance(volts[i : i + 1], float(time[i + 1]), (0.3, measured[i : i + 1]))
        stepped.append(machine.signals[0, 0])
    step, spool = rig.value("integration.longest_step"), int(rig.value("integration.spool_steps"))
    rolled = roll_out(
        rig.records(),
        time,
        volts,
        time,
        state=begin,
        longest_step=step,
        spool_steps=spool,
        pull=(0.3, measured),
    )
    assert stepped == pytest.approx(rolled.signals.reading, abs=1e-9)
    free = roll_out(rig.records(), time, volts, time, state=begin, longest_step=step, spool_steps=spool)
    assert np.abs(np.array(stepped) - free.signals.reading).max() > 1e-5


def test_innovations_of_the_machine_itself_are_its_noise(rig):
    time, volts, reading = _made(rig, 12.0, 5)
    observer = Observer(rig, ("joint",))
    values = np.full((time.size, 1, 4), np.nan)
    values[:, 0, 0], values[:, 0, 1] = volts, reading
    told = [observer.step(t, row) for t, row in zip(time.tolist(), values, strict=True)]
    assert told[0] is None and np.ptp(reading) > 100.0 * NOISE
    own = np.array([each[0, 0] for each in told[200:]])
    assert own.std() == pytest.approx(NOISE, rel=0.1)
    assert abs(np.corrcoef(own[1:], own[:-1])[0, 1]) < 0.15  # white


def test_a_command_that_changed_while_samples_were_lost_is_no_fault(rig, healthy):
    time, volts, reading = _made(rig, 30.0, 18)
    changes = np.flatnonzero(np.diff(volts))[2::3] + 1
    keep = np.ones(time.size, dtype=bool)
    keep[np.concatenate([changes, changes + 1])] = False  # the machine was commanded what nobody has heard of
    follower = Follower(rig, healthy, 0.005)
    _fed(follower, time[keep], volts[keep], reading[keep])
    assert follower.merger.counts.lost == 2 * changes.size >= 30
    assert follower.alarm_text == "" and not follower.events
    doubted, first = Observer(rig, ("joint",), healthy.response), changes[0]
    for i in (*range(first), first + 2):
        sure = doubted.sure.all()
        doubted.step(float(time[i]), np.array([[volts[i], reading[i], np.nan, np.nan]]))
    assert sure
    assert not doubted.sure.any()


def test_joints_that_move_together_are_pulled_as_one_by_itself(rig):
    time, volts, reading = _made(rig, 1.0, 6)
    alone, together = JointOnwards(rig, "joint", 0.0), JointsOnwards(rig, ("joint",), 0.0)
    for i in range(time.size - 1):
        measured = np.array([[reading[i] + 0.01, 4e6 if i > 50 else np.nan, np.nan]])
        for machine in (alone, together):
            machine.advance(volts[i : i + 1], float(time[i + 1]), (0.2, measured))
    ranges = np.array([1.0, 1.0, 10.0, 1e7, 1e7, 1e-3, 1e7, 1e5])
    assert (
        np.abs((alone.signals[..., : ranges.size] - together.signals[..., : ranges.size]) / ranges).max()
        < 1e-6
    )
    assert alone.signals[0, 0] == pytest.approx(reading[-1] + 0.01, abs=0.02)


def test_a_state_is_moved_to_where_the_sensor_reads(rig):
    bowed = rig.with_values({"effects.sensor.nonlinearity.amplitude_rad": 0.02})
    state = JointOnwards(rig, "joint", 0.0).states()[0]
    moved = state_at_reading(bowed.records(), state, 0.3)
    assert sensor.reading(moved[11], moved[12], bowed.records()[0]) == pytest.approx(0.3, abs=1e-9)
    changed = np.flatnonzero(moved != state)
    assert set(changed) == {4, 9, 11}


def test_a_healthy_stream_raises_nothing_and_a_leakage_is_alarmed(rig, healthy):
    follower = Follower(rig, healthy, 0.005)
    _fed(follower, *_made(rig, 40.0, 7))
    assert follower.blocks > 30 and follower.alarm_text == "" and follower.settled
    time, volts, reading = _made(rig, 40.0, 8, leakage=2e-12)
    _fed(follower, time, volts, reading, begin=40.0)
    assert "joint" in follower.alarm_text and 40.0 < follower.detector.alarmed < 70.0
    assert [e.kind for e in follower.events][-1] == "alarm"


def test_gaps_and_jumps_restart_the_observer_and_are_told(rig, healthy):
    follower = Follower(rig, healthy, 0.005)
    begin = 0.0
    for seed, by in ((11, 60.0), (12, -20.0), (13, 0.0)):
        time, volts, reading = _made(rig, 8.0, seed)
        _fed(follower, time, volts, reading, begin)
        begin += float(time[-1]) + by
    follower.flush(1e9)
    assert [e.kind for e in follower.events] == ["gap", "clock back"]
    assert follower.alarm_text == "" and follower.settled
    unsettled = [s.time for s in follower.history if not s.settled]
    assert len(unsettled) == pytest.approx(3 * 2.0 * SHOWN_HZ, abs=6)  # two seconds each


def test_what_a_stream_lacks_is_told_and_ends_nothing(rig, healthy):
    follower = Follower(rig, healthy, 0.005)
    follower.take(Samples(np.arange(3.0), {"joint.command": np.ones(3)}, UNITS), None, 0.0)
    assert [e.kind for e in follower.events] == ["refused"] and "joint.angle" in follower.events[0].text
    time, volts, reading = _made(rig, 4.0, 14)
    reading[100:120] = np.nan
    volts[200:220] = np.nan
    _fed(follower, time, volts, reading)
    assert follower.settled and follower.happened == 1
    nothing = [s for s in follower.history if np.isnan(s.measured[0, 0])]
    assert nothing and all(np.isfinite(s.modelled[0, 0]) for s in nothing)


def test_a_window_from_within_a_movement_is_followed_as_the_machine_was(rig, healthy, tmp_path, monkeypatch):
    monkeypatch.setattr(gathered, "WINDOW_S", WINDOW_S)
    found = []
    follower = Follower(rig, healthy, 0.005, on_window=found.append)
    _fed(follower, *_made(rig, 16.0, 15))
    follower.flush(1e9)
    assert len(found) == 3
    for window in found:
        path = window.write(tmp_path, rig, follower.joints)
        [experiment] = window.experiments(rig, read_recording(path), follower.joints)
        assert experiment.state is not None
        assert experiment.command_times[0] < 0.0 == experiment.time[0]
        residuals = experiment.residuals(experiment.simulate(rig.records()).signals)
        counted = residuals[experiment.used]
        assert np.sqrt(np.mean(counted**2)) < 1.5
        at_rest = experiments_of(rig, read_recording(path))[0]
        wrong = at_rest.residuals(at_rest.simulate(rig.records()).signals)
        assert np.sqrt(np.mean(wrong**2)) > 3.0  # as if it had rested there


def test_what_is_remembered_has_an_end(rig, healthy):
    follower = Follower(rig, healthy, 0.005)
    assert follower.history.maxlen == round(HISTORY_S * SHOWN_HZ) and follower.events.maxlen == EVENTS
    values = _made(rig, 1.0, 16)
    for again in range(2 * EVENTS):
        _fed(follower, *values, begin=100.0 * again)
    assert len(follower.events) == EVENTS and follower.happened == 2 * EVENTS - 1
    assert len(follower.history) <= follower.history.maxlen


def test_a_reference_that_is_too_short_is_refused(rig):
    time, volts, reading = _made(rig, 6.0, 17)
    recording = Recording("short", time, {"joint.command": volts, "joint.angle": reading}, Path("short.csv"))
    with pytest.raises(InputError, match="too short"):
        healthy_of(rig, ("joint",), [recording])


def test_potentiometers_and_pressures_are_taken_as_in_recordings(rig):
    with pytest.raises(InputError, match="potentiometer"):
        by_joint(
            rig, ("joint",), Samples(np.zeros(1), {"joint.command": np.ones(1), "joint.pot": np.ones(1)})
        )
    signals = {"joint.command": np.ones(1), "joint.angle": np.ones(1), "joint.pressure_b": np.full(1, 3e6)}
    assert by_joint(rig, ("joint",), Samples(np.zeros(1), signals))[0, 0, 3] == 3e6
    refuse_driven(rig)
