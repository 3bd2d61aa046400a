"""Recordings that come with the project and, where they are there, those that are kept beside it."""

import json
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.recordings import read_recording, require

BENCH = Path(__file__).parents[1] / "data" / "bench"
LABELS = {label["id"]: label for label in json.loads((BENCH / "practice_labels.json").read_text())}
SHARED = Path(__file__).resolve().parents[3] / "shared" / "recordings"

shared = [
    pytest.mark.shared_recordings,
    pytest.mark.skipif(not SHARED.is_dir(), reason="no folder ../shared/recordings beside the repository"),
]
EMPS_MAT = {"t": "time_s", "qm": "axis.position_m", "qg": "axis.reference_m", "vir": "axis.command_V"}
EMPS_CSV = {
    "position_m": "axis.position_m",
    "position_reference_m": "axis.reference_m",
    "command_V": "axis.command_V",
}


def test_all_fourteen_pairs_are_here():
    assert sorted(LABELS) == [f"practice_{i:02d}" for i in range(1, 15)]
    assert sorted(path.parent.name for path in BENCH.glob("*/train.csv")) == sorted(LABELS)


@pytest.mark.parametrize(("part", "samples"), [("train", 4000), ("holdout", 3000)])
@pytest.mark.parametrize("machine", sorted(LABELS))
def test_bench_pair_reads_clean(machine, part, samples):
    recording = read_recording(BENCH / machine / f"{part}.csv")
    pressures = ["joint.pressure_a", "joint.pressure_b"] if LABELS[machine]["pressures"] else []
    require(recording, ["joint.angle", *pressures], complete=["joint.command"], units={"joint.command": "V"})
    assert len(recording.signals) == 2 + len(pressures)
    assert recording.findings == () and recording.ignored == ()
    np.testing.assert_allclose(recording.time, 0.01 * np.arange(samples), atol=1e-9)
    # End stops at -10.3 and 65.6 deg; the sensor may add its own error of a few degrees.
    assert np.all(np.abs(np.rad2deg(recording.signal("joint.angle")) - 27.65) < 45)
    assert np.all(np.abs(recording.signal("joint.command")) <= 10)


class TestShared:
    pytestmark = shared

    @pytest.mark.parametrize(
        ("mat", "text"), [("DATA_EMPS", "emps_estimation"), ("DATA_EMPS_PULSES", "emps_test_pulses")]
    )
    def test_emps_mat_equals_csv(self, mat, text):
        first = read_recording(SHARED / "emps" / f"{mat}.mat", EMPS_MAT)
        second = read_recording(SHARED / "emps" / f"{text}.csv", EMPS_CSV)
        np.testing.assert_allclose(first.time, second.time, atol=1e-9)
        for key in ("axis.position", "axis.reference", "axis.command"):
            np.testing.assert_allclose(first.signal(key), second.signal(key), rtol=1e-8, atol=1e-12)
        assert first.findings == () and second.findings == ()

    @pytest.mark.parametrize("side", ["A", "B"])
    def test_festo_mat_equals_csv_block_averages(self, side):
        """The CSV holds means of 10 samples at 10 kHz to six digits; 1 V is 1 MPa and 0.02 m."""
        folder = SHARED / "servo_hydraulic_cylinder_festo_tp511"
        name = {"A": "cap", "B": "rod"}[side]
        raw = read_recording(
            folder / f"m_find_b_p{side}_5V_sample_1.mat",
            {
                "t": "time_s",
                "w_verdadero2": "cylinder.command_V",
                "poloha_bez_filtr2": "cylinder.pot_V",
                "pressure_bez_filtr1": "cylinder.pressure_a_MPa",
            },
        )
        averaged = read_recording(
            folder / "steps_5V_repeat1_1khz.csv",
            {
                "command_V": "cylinder.command_V",
                f"position_run{side}_m": "cylinder.position_m",
                f"pressure_{name}_side_run{side}_MPa": "cylinder.pressure_a_MPa",
            },
        )
        rows = averaged.time.size

        def means(values):
            return values[: 10 * rows].reshape(rows, 10).mean(axis=1)

        six_digits = {"rtol": 1e-5, "atol": 1e-9}
        np.testing.assert_allclose(means(raw.time), averaged.time, atol=1e-9)
        np.testing.assert_allclose(
            0.02 * means(raw.signal("cylinder.pot")), averaged.signal("cylinder.position"), **six_digits
        )
        np.testing.assert_allclose(
            means(raw.signal("cylinder.pressure_a")), averaged.signal("cylinder.pressure_a"), **six_digits
        )

    def test_festo_position_sensor_saturates(self):
        """The description of the set: position reads 9.9988 V at the outer stop."""
        path = SHARED / "servo_hydraulic_cylinder_festo_tp511" / "m_find_b_pA_5V_sample_1.mat"
        recording = read_recording(path, {"t": "time_s", "poloha_bez_filtr2": "cylinder.pot_V"})
        (found,) = recording.findings
        assert found.kind == "saturated" and "9.99878 V" in found.message

    def test_tank_level_sensor_saturates_at_10_volt(self):
        """The description of the set: level sensor saturating at 10 V."""
        path = SHARED / "cascaded_tanks" / "cascaded_tanks.csv"
        recording = read_recording(
            path, {"pump_estimation_V": "tank.command_V", "level_estimation_V": "tank.pot_V"}
        )
        (found,) = recording.findings
        assert found.kind == "saturated" and "largest value 10 V" in found.message

    def test_crane_command_is_known_from_5_to_32_seconds(self):
        path = SHARED / "patu_crane" / "patu_crane_100hz.csv"
        recording = read_recording(path, {"U1_V": "lift.command_V", "lift_boom_angle_deg": "lift.angle_deg"})
        (found,) = recording.findings
        np.testing.assert_allclose(found.spans, [(0, 4.99), (32.01, 40)], atol=1e-9)
        require(recording.between(5, 32), ["lift.angle"], complete=["lift.command"])
