"""The challenge's own bench is the bench of the practice recordings, effects included."""

import json
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.challenge.bench_machine import play
from hydrolek_drake.challenge.bench_numbers import nominal_machine
from hydrolek_drake.challenge.concealed import Concealed
from hydrolek_drake.challenge.driving import bench_driving, random_series
from hydrolek_drake.challenge.listed import LISTED, with_effects
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import rest_state, roll_out

DATA = Path(__file__).parents[1] / "data" / "bench"
LABELS = {label["id"]: label for label in json.loads((DATA / "practice_labels.json").read_text())}
FIELDS = {
    "A_max_m2": "area", "x_o_m": "x_o", "w_m": "w", "P_S_Pa": "p_s", "B_Pa": "bulk", "c_cyl_N_s_per_m": "c_cyl",
    "J_kg_m2": "inertia", "mgl_Nm": "mgl", "I_max_A": "i_max", "T_d_s": "t_d",
}  # fmt: skip
SAMPLES = 1000
NOISE_DEG = 0.05
OF_THE_BENCH = LISTED.keys() - {"load.payload"}  # it has no tool
LISTED_PAIRS = [name for name, label in LABELS.items() if set(label["effects"]) <= OF_THE_BENCH]


@pytest.mark.parametrize("pair", LISTED_PAIRS)
@pytest.mark.thorough(but=2)
def test_it_reproduces_the_practice_recordings_to_the_noise(pair: str) -> None:
    label = LABELS[pair]
    rig = load_rig("joint_bench", {})
    own = {FIELDS[name]: value for name, value in label["machine"].items()}
    machine = with_effects(nominal_machine(rig)._replace(**own), label["effects"])
    recording = read_recording(DATA / pair / "train.csv", rig.columns)
    done = play(machine, bench_driving(), np.asarray(recording.signal("joint.command"))[:SAMPLES])
    left = np.degrees(np.asarray(recording.signal("joint.angle"))[:SAMPLES] - done.reading)
    # the deviation of 1000 samples of noise is known to 2.2 %; three times that
    assert np.sqrt(np.mean(left**2)) < 1.07 * NOISE_DEG


@pytest.mark.parametrize(
    ("own", "path", "value"),
    [
        ({"ramp_v_per_s": 60.0}, "command.ramp", 1 / 60.0),
        ({"coil_s": 0.03}, "amplifier.coil_time", 0.03),
        ({"flow_force": 0.1}, "valve.flow_force", 0.1),
    ],
)
def test_what_takes_its_time_or_closes_the_spool_is_that_of_the_diagnosing_rollout(
    own: dict[str, float], path: str, value: float
) -> None:
    """Two formulations: within Runge-Kutta of 20 us there, in closed form over a step here."""
    rig = load_rig("joint_bench", {})
    driving = bench_driving()
    command = random_series(driving, closed=False, seconds=10.0, rng=np.random.default_rng(3))
    times = 0.01 * np.arange(command.size)
    machine = nominal_machine(rig)._replace(concealed=Concealed(**own))
    concealed = play(machine, driving, command).reading
    plain, slow = (
        roll_out(
            rig.with_values(values).records(),
            times,
            command,
            times,
            state=rest_state(rig.records(), np.radians(driving.start_deg)),
            longest_step=1e-4,
        ).signals.reading
        for values in ({}, {path: value})
    )
    assert np.degrees(np.abs(slow - plain)).max() > 0.5
    assert np.degrees(np.abs(slow - concealed)).max() < 0.02


def test_what_the_bench_cannot_conceal_is_refused() -> None:
    with pytest.raises(ValueError, match="no tool"):
        machine = with_effects(
            nominal_machine(load_rig("joint_bench", {})), {"load.payload": {"mass_kg": 1.0, "time_s": 0.0}}
        )
        play(machine, bench_driving(), np.zeros(10))
