"""Force regression: exact on a made motion, by command on EMPS against the published values."""

import json
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.identification.inverse_dynamics.regression import inverse_dynamics
from hydrolek_drake.identification.two_step.gain_rig import gain_rig
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import load_rig

SHARED = Path(__file__).parents[3] / "shared" / "recordings" / "emps"
PUBLISHED = {
    "joints.axis.load.inertia": 95.1089,
    "joints.axis.load.damping": 203.5034,
    "joints.axis.effects.load.coulomb_friction.force_N": 20.3935,
    "joints.axis.effects.load.offset_force.force_N": -3.1648,
}


def _motion(time, around, size):
    """Position, speed and acceleration of three sines."""
    waves = [(0.5, 0.31), (0.3, 0.83), (0.2, 1.71)]
    q, v, a = np.full_like(time, around), np.zeros_like(time), np.zeros_like(time)
    for share, frequency in waves:
        w = 2.0 * np.pi * frequency
        q += size * share * np.sin(w * time)
        v += size * share * w * np.cos(w * time)
        a -= size * share * w**2 * np.sin(w * time)
    return q, v, a


def _sliding(noise_N=0.0, seed=0, step=1e-3):
    rig = load_rig("emps_published")
    time = np.arange(0.0, 25.0, step)
    q, v, a = _motion(time, 0.1, 0.1)
    force = 80.0 * a + 150.0 * v + 12.0 * np.sign(v) - 4.0
    force = force + noise_N * np.random.default_rng(seed).standard_normal(time.size)
    signals = {"axis.command": force / rig.value("cylinder.force_constant"), "axis.position": q}
    return rig, Recording("made", time, signals, Path("made.csv"))


def test_a_sliding_load_is_found_from_its_motion():
    rig, made = _sliding()
    found = inverse_dynamics(rig, [made])
    np.testing.assert_allclose(found.values, [80.0, 150.0, 12.0, -4.0], rtol=0.01)
    assert found.misfit < 0.02


@pytest.mark.thorough
def test_intervals_hold_the_truth_as_often_as_they_say():
    hits = []
    for seed in range(12):
        rig, made = _sliding(noise_N=20.0, seed=seed, step=4e-3)
        rows = inverse_dynamics(rig, [made], decimation=5).intervals().values()
        hits += [low <= true <= high for (_, low, high), true in zip(rows, (80, 150, 12, -4), strict=True)]
    assert np.mean(hits) > 0.85  # of 48 at 95 %: fewer than 41 come three times in 1000


def test_a_turning_load_is_found_with_its_gravity():
    rig = gain_rig(load_rig("hydrolek_right_j2"), "right_j2")
    time = np.arange(0.0, 25.0, 2e-3)
    q, v, a = _motion(time, 0.4, 0.5)
    torque = 20.0 * a + 90.0 * v + 15.0 * np.sign(v) + 250.0 * np.cos(q) + 80.0 * np.sin(q)
    delay = rig.value("command.delay")
    command = np.interp(time + delay, time, torque / rig.value("cylinder.force_constant"))
    made = Recording("made", time, {"right_j2.command": command, "right_j2.angle": q}, Path("made.csv"))
    found = inverse_dynamics(rig, [made.between(0.0, 24.5)], decimation=10)
    np.testing.assert_allclose(found.values, [20.0, 90.0, 15.0, 250.0, 80.0], rtol=0.02)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["joint_bench", "bench"], "driven by a 'cylinder'"),
        (["emps", "made", "--cutoff", "900"], "choose less than half"),
        (["emps", "made", "--decimation", "5000"], "--decimation 5000"),
        (["emps", "made", "made"], "is given twice"),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, said, tmp_path, capsys):
    from hydrolek_drake.recordings.writing import write_recording

    _, made = _sliding()
    path = write_recording(made, tmp_path / "made.csv")
    bench = Path(__file__).parents[1] / "data" / "bench" / "practice_01" / "train.csv"
    files = {"made": str(path), "bench": str(bench)}
    assert run(["identify", "force", *(files.get(a, a) for a in arguments)]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


def test_a_joint_that_stands_is_refused(tmp_path):
    from hydrolek_drake.errors import InputError

    rig, made = _sliding()
    signals = {key: np.zeros_like(values) for key, values in made.signals.items()}
    with pytest.raises(InputError, match="does not tell"):
        inverse_dynamics(rig, [Recording("still", made.time, signals, Path("still.csv"))])


@pytest.mark.shared_recordings
@pytest.mark.skipif(not SHARED.is_dir(), reason="the folder ../shared/recordings is not there")
def test_emps_is_within_2_percent_of_the_published_values_by_command(tmp_path, capsys):
    assert (
        run(["identify", "force", "emps", str(SHARED / "emps_estimation.csv"), "--out", str(tmp_path)]) == 0
    )
    assert "95 % interval" in capsys.readouterr().out
    rows = json.loads((tmp_path / "force.json").read_text())["parameters"]
    assert set(rows) == set(PUBLISHED)
    for path, published in PUBLISHED.items():
        assert rows[path]["value"] == pytest.approx(published, rel=0.02)
        assert rows[path]["low"] < published < rows[path]["high"]
    again = load_rig(tmp_path / "rig_fitted.yaml")
    for path, row in rows.items():
        assert again.value(path) == pytest.approx(row["value"])
