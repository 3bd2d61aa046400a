"""Signals to write and read back, and writers for the formats that the package only reads."""

import shutil

import bags
import numpy as np
import pytest


@pytest.fixture
def columns():
    """Columns as a file holds them: 200 samples with uneven steps that start at 12.5 s."""
    rng = np.random.default_rng(7)
    time = 12.5 + np.cumsum(rng.uniform(0.0095, 0.0105, 200))
    return {
        "time_s": time,
        "right_j2.command_V": np.sign(np.sin(3 * time)) * 4.25,
        "right_j2.angle_deg": 25 + 10 * np.sin(time) + rng.normal(0, 0.05, time.size),
        "right_j2.pressure_a_MPa": 5 + np.cos(2 * time) + rng.normal(0, 0.02, time.size),
    }


@pytest.fixture
def check_same(columns):
    """Asserts that a recording holds the numbers of `columns` in SI."""

    def check(recording):
        assert set(recording.signals) == {"right_j2.command", "right_j2.angle", "right_j2.pressure_a"}
        same = {"rtol": 1e-14, "atol": 0}  # one rounding of the unit conversion
        np.testing.assert_allclose(recording.time, columns["time_s"], **same)
        np.testing.assert_allclose(
            recording.signal("right_j2.command"), columns["right_j2.command_V"], **same
        )
        np.testing.assert_allclose(
            recording.signal("right_j2.angle"), np.deg2rad(columns["right_j2.angle_deg"]), **same
        )
        np.testing.assert_allclose(
            recording.signal("right_j2.pressure_a"), 1e6 * columns["right_j2.pressure_a_MPa"], **same
        )
        assert recording.units == {
            "right_j2.command": "V",
            "right_j2.angle": "rad",
            "right_j2.pressure_a": "Pa",
        }
        assert recording.findings == ()

    return check


@pytest.fixture
def write_lines(tmp_path):
    """Writes text to a file and returns its path."""

    def write(text, name="bad.csv"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


@pytest.fixture
def write_bag():
    """Writes (topic, message type, log time [ns], fields of the message) as a ROS 2 bag and returns its folder."""
    return bags.write_bag


@pytest.fixture
def write_joint_states(tmp_path):
    """Writes (topic, stamp [ns] or None, log time [ns], names, position, velocity, effort) as one file of MCAP."""

    def write(path, messages):
        folder = tmp_path / "joint_states"
        shutil.rmtree(folder, ignore_errors=True)
        states = [
            (topic, bags.JOINT_STATE, logged, bags.joint_state(stamp, *fields))
            for topic, stamp, logged, *fields in messages
        ]
        bags.write_bag(folder, states)
        shutil.move(folder / "joint_states.mcap", path)
        shutil.rmtree(folder)
        return path

    return write
