"""Signals to write and read back, and writers for the formats that the package only reads."""

import numpy as np
import pytest

JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


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
def write_joint_states():
    """Writes (topic, stamp [ns] or None, log time [ns], names, position, velocity, effort) as MCAP."""

    def write(path, messages, datatype="sensor_msgs/msg/JointState"):
        from mcap_ros2.writer import Writer

        with path.open("wb") as stream, Writer(stream) as writer:
            schema = writer.register_msgdef(datatype, JOINT_STATE)
            for topic, stamp, logged, names, position, velocity, effort in messages:
                sec, nanosec = divmod(stamp or 0, 10**9)
                writer.write_message(
                    topic=topic,
                    schema=schema,
                    log_time=logged,
                    message={
                        "header": {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""},
                        "name": names,
                        "position": position,
                        "velocity": velocity,
                        "effort": effort,
                    },
                )
        return path

    return write
