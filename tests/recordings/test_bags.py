"""Bags of ROS: any numeric field of any message, in every way that recorders keep them."""

import bags
import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording

MS = 10**6
T0 = 1_700_000_000_000 * MS


def crane(stamped=True, count=200):
    """A joint at 100 Hz, its command at 50 Hz without a stamp, pressures and a valve of its own kind."""
    messages = []
    for i in range(count):
        at = T0 + i * 10 * MS
        stamp = at if stamped else None
        angle, speed = float(np.sin(0.1 * i)), float(np.cos(0.1 * i))
        messages.append(
            (
                "/joint_states",
                bags.JOINT_STATE,
                at + MS,
                bags.joint_state(stamp, ["boom"], [angle], [speed], [1.0]),
            )
        )
        messages.append(("/boom/pressure_a", bags.FLUID_PRESSURE, at + MS, bags.pressure(stamp, 1e5 * i)))
        messages.append(("/tank/levels", bags.FLOAT64S, at + MS, bags.numbers([1.0, 0.5 * i])))
        messages.append(("/valve", bags.VALVE, at + MS, bags.valve(stamp, 0.01 * i, [i, 2 * i], 3 * i)))
        messages.append(("/log", bags.TEXT, at + MS, lambda store: {"data": "hello"}))
        if i % 2 == 0:
            messages.append(("/boom/command", bags.FLOAT64, at + MS, bags.number(0.1 * i)))
    return messages


MAPPED = {
    "/boom/command.data": "boom.command_V",
    "/tank/levels.data[1]": "supply.pressure_bar",
    "valve.pressures[1]": "boom.pressure_b_kPa",
    "/valve.coil.current_mA": "boom.current_mA",
}


@pytest.mark.parametrize(
    ("storage", "compression", "parts"),
    [
        ("mcap", "none", 1),
        ("mcap", "storage", 3),
        ("mcap", "message", 1),
        ("sqlite3", "none", 2),
        ("sqlite3", "file", 2),
        ("sqlite3", "message", 1),
    ],
)
def test_any_field_of_any_message(tmp_path, storage, compression, parts):
    folder = bags.write_bag(tmp_path / "run", crane(), storage=storage, compression=compression, parts=parts)
    recording = read_recording(folder, MAPPED)
    i = np.arange(200)
    np.testing.assert_allclose(recording.signal("boom.angle"), np.sin(0.1 * i), rtol=1e-15)
    np.testing.assert_allclose(recording.signal("boom.rate"), np.cos(0.1 * i), rtol=1e-15)
    np.testing.assert_allclose(recording.signal("boom.command"), 0.1 * (i - i % 2), rtol=1e-12)
    np.testing.assert_allclose(recording.signal("boom.pressure_a"), 1e5 * i, rtol=1e-15)  # by its type
    np.testing.assert_allclose(recording.signal("boom.pressure_b"), 2e3 * i, rtol=1e-12)
    np.testing.assert_allclose(recording.signal("boom.current"), 3e-3 * i, rtol=1e-12)
    np.testing.assert_allclose(recording.signal("supply.pressure"), 0.5e5 * i, rtol=1e-12)
    np.testing.assert_allclose(np.diff(recording.time), 0.01, atol=1e-6)
    assert "/valve.opening_mm" in recording.ignored


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_files_of_a_bag_alone_and_without_its_metadata(tmp_path, storage):
    folder = bags.write_bag(tmp_path / "run", crane(), storage=storage, parts=2)
    files = sorted(file for file in folder.iterdir() if file.name != "metadata.yaml")
    first = read_recording(files[0], MAPPED)
    assert first.time.size == 100
    (folder / "metadata.yaml").unlink()
    whole = read_recording(folder, MAPPED)
    assert whole.time.size == 200
    np.testing.assert_array_equal(whole.signal("boom.angle")[:100], first.signal("boom.angle"))


def test_a_bag_of_ros_1(tmp_path):
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    kind = "std_msgs/msg/Float64MultiArray"
    layout = store.types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    with Writer(tmp_path / "run.bag") as writer:
        connection = writer.add_connection("/rig", kind, typestore=store)
        for i in range(20):
            message = store.types[kind](layout=layout, data=np.array([i, 2.0 * i]))
            writer.write(connection, T0 + i * 10 * MS, store.serialize_ros1(message, kind))
    mapping = {"/rig.data[0]": "j.command_V", "/rig.data[1]": "j.angle_rad"}
    recording = read_recording(tmp_path / "run.bag", mapping)
    np.testing.assert_array_equal(recording.signal("j.angle"), 2.0 * np.arange(20))


def test_names_that_need_no_mapping(tmp_path):
    messages = []
    for i in range(20):
        at = T0 + i * 10 * MS
        messages.append(("/rig/boom/command_V", bags.FLOAT64, at, bags.number(i)))
        messages.append(("/rig/boom/angle_deg", bags.FLOAT64, at, bags.number(i)))
    recording = read_recording(bags.write_bag(tmp_path / "run", messages))
    np.testing.assert_allclose(recording.signal("boom.angle"), np.deg2rad(np.arange(20.0)), rtol=1e-14)
    np.testing.assert_array_equal(recording.signal("boom.command"), np.arange(20.0))


def test_a_command_without_a_unit_is_refused_with_what_to_map(tmp_path):
    messages = [("/boom/command", bags.FLOAT64, T0 + i * MS, bags.number(i)) for i in range(9)]
    with pytest.raises(
        InputError, match=r"'boom.command' has no unit; write for example boom.command_V, or map"
    ):
        read_recording(bags.write_bag(tmp_path / "run", messages))


def test_joints_of_several_programs_on_one_topic_have_clocks_of_their_own(tmp_path):
    messages = []
    for i in range(50):
        at = T0 + i * 10 * MS
        messages.append(("/joint_states", bags.JOINT_STATE, at, bags.joint_state(at, ["boom"], [float(i)])))
        late = at + 5 * MS
        messages.append(
            ("/joint_states", bags.JOINT_STATE, late, bags.joint_state(late, ["grip"], [i + 0.5]))
        )
    recording = read_recording(bags.write_bag(tmp_path / "run", messages))
    assert recording.time.size == 50
    np.testing.assert_array_equal(recording.signal("boom.angle"), np.arange(50.0))
    np.testing.assert_allclose(recording.signal("grip.angle")[1:], np.arange(1.0, 50.0), atol=1e-4)
    (told,) = [finding for finding in recording.findings if finding.kind == "resampled"]
    assert "grip.angle" in told.message and "straight lines" in told.message


def test_sensors_decide_the_times_and_a_command_is_held(tmp_path, write_joint_states):
    messages = [("/joint_states", t * MS, t * MS, ["j"], [t / 10]) for t in range(1000, 1100, 10)]
    messages += [("/slow_states", t * MS, t * MS, ["k"], [t / 10]) for t in range(1000, 1100, 20)]
    messages += [("/command", t * MS, t * MS, ["j"], [t / 1000]) for t in (1015, 1055)]
    recording = read_recording(write_joint_states(tmp_path / "run.mcap", messages))
    np.testing.assert_allclose(recording.time, np.arange(1.0, 1.095, 0.01), rtol=1e-12)
    nan = np.nan  # before the first command it is not known
    np.testing.assert_array_equal(recording.signal("j.command"), [nan, nan] + 4 * [1.015] + 4 * [1.055])
    np.testing.assert_allclose(recording.signal("k.angle"), [*np.arange(100.0, 108.5, 1), nan], rtol=1e-12)


def test_stamps_of_another_clock_are_moved_to_the_recorders_where_a_topic_has_none(tmp_path):
    """The sensor's computer is 40 s behind; a message takes 2 to 5 ms to the recorder."""
    rng = np.random.default_rng(1)
    messages = []
    for i in range(300):
        at = T0 + i * 10 * MS
        took = round((0.002 + 0.003 * rng.random() * (i > 0)) * 1e9)
        state = bags.joint_state(at - 40_000 * MS, ["boom"], [float(i)])
        messages.append(("/joint_states", bags.JOINT_STATE, at + took, state))
        messages.append(("/boom/command_V", bags.FLOAT64, at, bags.number(i)))
    recording = read_recording(bags.write_bag(tmp_path / "run", messages))
    np.testing.assert_allclose(recording.time - T0 / 1e9, 0.002 + 0.01 * np.arange(300), atol=1e-6)
    np.testing.assert_array_equal(recording.signal("boom.command"), np.arange(300.0))
    assert any("moved: /joint_states by 40.002 s" in finding.message for finding in recording.findings)


def test_a_simulated_clock_at_half_speed_gives_way_to_times_of_arrival(tmp_path):
    messages = []
    for i in range(100):
        at = T0 + i * 20 * MS
        messages.append(
            ("/joint_states", bags.JOINT_STATE, at, bags.joint_state(i * 10 * MS + 1, ["j"], [float(i)]))
        )
        messages.append(("/j/command_V", bags.FLOAT64, at, bags.number(i)))
    recording = read_recording(bags.write_bag(tmp_path / "run", messages))
    np.testing.assert_allclose(np.diff(recording.time), 0.02, atol=1e-6)


def test_a_joint_on_two_topics_is_chosen_by_the_mapping(tmp_path, write_joint_states):
    messages = [("/a", i * 10 * MS + 1, i, ["j"], [float(i)]) for i in range(20)]
    messages += [("/b", i * 10 * MS + 1, i, ["j"], [2.0 * i]) for i in range(20)]
    path = write_joint_states(tmp_path / "run.mcap", messages)
    with pytest.raises(InputError, match=r"'/a.position\[j\]' and '/b.position\[j\]' both hold j.angle"):
        read_recording(path)
    for name in ("/b.position[j]", "/b.position[0]", "b.position[0]"):
        recording = read_recording(path, {name: "j.angle_rad"})
        np.testing.assert_array_equal(recording.signal("j.angle"), 2 * np.arange(20.0))


@pytest.mark.parametrize(
    ("messages", "says"),
    [
        ([], "no time column; it needs time_s .* it has no columns"),
        ([("/chat", bags.TEXT, T0, lambda store: {"data": "hello"})], "no time column"),
        (
            [
                ("/s", bags.JOINT_STATE, n, bags.joint_state(t, ["j"], [1.0]))
                for n, t in enumerate([10, 30, 20])
            ],
            "column '/s.time_s' runs backwards in message 3",
        ),
        (
            [("/s", bags.JOINT_STATE, t, bags.joint_state(t, ["j", "k"][:t], [1.0])) for t in (1, 2)],
            "a message has 2 names and 1 of position; write one each",
        ),
    ],
)
def test_bad_content(tmp_path, messages, says):
    with pytest.raises(InputError, match=says) as refused:
        read_recording(bags.write_bag(tmp_path / "run", messages))
    assert str(refused.value).isprintable() and "run" in str(refused.value)


def test_folders_that_are_no_bag(tmp_path):
    with pytest.raises(InputError, match=r"is a folder without a bag: neither metadata.yaml nor"):
        read_recording(tmp_path)
    folder = bags.write_bag(tmp_path / "run", crane(count=3), parts=2)
    next(folder.glob("*.mcap")).unlink()
    with pytest.raises(InputError, match="files are missing"):
        read_recording(folder)


def test_a_bag_that_unpacks_to_far_more_than_it_is_is_refused(tmp_path):
    """300 MB of zeros in a few kB."""
    from backports import zstd

    folder = bags.write_bag(tmp_path / "run", crane(count=3), storage="sqlite3", compression="file")
    packed = next(folder.glob("*.zstd"))
    with zstd.open(packed, "wb") as stream:
        for _ in range(30):
            stream.write(bytes(10_000_000))
    with pytest.raises(InputError, match="cannot be read") as refused:
        read_recording(folder)
    assert str(refused.value).isprintable()
