"""A drive with commanded position and measured current, fitted and watched by both."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.fit import fit_rig
from hydrolek_drake.recordings import read_recording, write_signals
from hydrolek_drake.replay import compare, replay
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.watching.watch import watch
from hydrolek_drake.wizard.making import written_rig

SHARED = Path(__file__).parents[3] / "shared" / "recordings" / "ballscrew_faults"
SHEET = {
    "moves": "screw", "joint": "nut", "travel": "160 mm", "lead": "5 mm", "torque_constant": "1.5 N m/A",
    "peak_current": "5 A", "mass": "5 kg", "position_gain": "4 1/s", "position_time": "0.4 s", "pushed_by": "-196 N",
    "drag_torque": "0.6 N m", "current_reads": "size", "current_at_rest": "0.4 A",
}  # fmt: skip
"""What is known of the recorded machine: docs/evidence/real_recordings.md."""

FRICTION = "joints.nut.effects.load.coulomb_friction.force_N"
OWN = "joints.nut.effects.load.stribeck_friction.force_N"
NOISES = {"nut.position": 0.3e-3, "nut.current": 0.045}


@pytest.fixture(scope="module")
def rig():
    return written_rig("screw", SHEET)[1]


def _stroke(path, rig, friction, seed):
    """One stroke out and back with the noise of the recorded ones, of a machine whose friction has grown."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, 13.0, 0.04)
    volts = np.interp(times + 0.02, [0.0, 5.0, 8.0, 13.0], [20.0, 140.0, 140.0, 20.0])
    start = {"joints.nut.load.initial_position": 0.0201}
    records = rig.with_values({FRICTION: friction, **start}).records()
    signals = roll_out(records, times, volts, times, longest_step=1e-3).signals
    measured = {
        "nut.command": volts,
        "nut.position": signals.reading + NOISES["nut.position"] * rng.standard_normal(times.size),
        "nut.current": signals.current + NOISES["nut.current"] * rng.standard_normal(times.size),
    }
    write_signals(path, times, measured, {"nut.command": "V", "nut.position": "m", "nut.current": "A"})
    return path


def test_friction_is_told_by_the_current_and_hardly_by_the_position(rig, tmp_path):
    recording = read_recording(_stroke(tmp_path / "one.csv", rig, 0.0, 1), rig.columns)
    own = experiments_of(rig, recording)
    assert [(c.key, c.unit, c.model) for e in own for c in e.channels] == [
        ("nut.position", "m", "reading"),
        ("nut.current", "A", "current"),
    ]
    true = rig.value(OWN)
    begun = rig.with_values({OWN: 0.7 * true})
    widths = {}
    for signals in (("position", "current"), ("position",)):
        found = fit_rig(begun, [recording], paths=[OWN], signals=signals)
        _, low, high = found.intervals()[OWN]
        assert low <= true <= high
        widths[signals] = high - low
        assert found.over_noise < 1.1
    assert widths["position", "current"] < 0.3 * widths["position",]
    assert widths["position", "current"] < 40.0


@pytest.mark.thorough
def test_friction_that_grows_is_alarmed_by_name_and_a_healthy_series_is_not(rig, tmp_path):
    reference = [_stroke(tmp_path / f"reference_{k}.csv", rig, 0.0, 10 + k) for k in range(3)]
    healthy = [_stroke(tmp_path / f"2026-03-0{k + 1}.csv", rig, 0.0, 20 + k) for k in range(3)]
    worn = [_stroke(tmp_path / f"2026-03-0{k + 4}.csv", rig, 60.0 * (k + 1), 30 + k) for k in range(4)]
    sound = watch(rig, reference, healthy, cores=1, drift={"": 0.002})
    assert sound.alarm is None
    watched = watch(rig, reference, [*healthy, *worn], cores=1, drift={"": 0.002})
    assert watched.alarm is not None and watched.alarm.effect == "load.coulomb_friction"
    assert watched.alarm.since >= 3
    told = next(e for e in watched.answers[-1].effects if e.effect == "load.coulomb_friction")
    assert told.low <= 240.0 <= told.high


@pytest.mark.thorough
@pytest.mark.shared_recordings
@pytest.mark.skipif(not SHARED.is_dir(), reason="the folder ../shared/recordings is not there")
def test_a_recorded_stroke_is_followed_near_its_noise(rig, tmp_path):
    """Position to three times its noise without a fit, both to twice with one; 29 times with the current as command."""
    table = pd.read_csv(SHARED / "normal.csv")
    stroke = table[(table["load"] == 20) & (table["group"] == 11)]
    points = stroke["set_point"].to_numpy()
    written = {
        "time_s": stroke["time"],
        "nut.command_V": points + 0.5 * np.diff(points, append=points[-1]),
        "nut.position_mm": points - stroke["position_error"],
        "nut.current_A": stroke["current"],
    }
    pd.DataFrame(written).to_csv(tmp_path / "stroke.csv", index=False)
    recording = read_recording(tmp_path / "stroke.csv", rig.columns)
    found = {c.key: c for c in compare(replay(rig, recording))}
    assert found["nut.position"].rms_over_noise < 3.0
    assert fit_rig(rig, [recording]).over_noise < 2.0
