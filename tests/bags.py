"""Bags of ROS as recorders write them: by rosbags, in MCAP or sqlite3, compressed or split."""

from pathlib import Path

import numpy as np
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

JOINT_STATE = "sensor_msgs/msg/JointState"
FLUID_PRESSURE = "sensor_msgs/msg/FluidPressure"
FLOAT64 = "std_msgs/msg/Float64"
FLOAT64S = "std_msgs/msg/Float64MultiArray"
TEXT = "std_msgs/msg/String"
VALVE = "crane_msgs/msg/Valve"
VALVE_DEFINITION = (
    "std_msgs/Header header\nfloat64 opening_mm\nfloat32[2] pressures\nValveCoil coil\nstring note\n"
)
COIL, COIL_DEFINITION = "crane_msgs/msg/ValveCoil", "uint16 current_mA\n"


def types():
    """Types of ROS and some that only this bag knows."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(COIL_DEFINITION, COIL))
    store.register(get_types_from_msg(VALVE_DEFINITION, VALVE))
    return store


def stamp(store, nanoseconds):
    """A header with a stamp, or an empty one."""
    sec, rest = divmod(nanoseconds or 0, 10**9)
    time = store.types["builtin_interfaces/msg/Time"](sec=sec, nanosec=rest)
    return store.types["std_msgs/msg/Header"](stamp=time, frame_id="")


def joint_state(stamped, names, position, velocity=(), effort=()):
    """Fields of a JointState."""
    return lambda store: {
        "header": stamp(store, stamped),
        "name": list(names),
        **{
            name: np.array(values, dtype=float)
            for name, values in (("position", position), ("velocity", velocity), ("effort", effort))
        },
    }


def pressure(stamped, pascal):
    """Fields of a FluidPressure."""
    return lambda store: {"header": stamp(store, stamped), "fluid_pressure": pascal, "variance": 0.0}


def number(value):
    """Fields of a Float64."""
    return lambda store: {"data": float(value)}


def numbers(values):
    """Fields of a Float64MultiArray."""
    return lambda store: {
        "layout": store.types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0),
        "data": np.array(values, dtype=float),
    }


def valve(stamped, opening_mm, pressures, current_mA):
    """Fields of a message that no other program knows."""
    return lambda store: {
        "header": stamp(store, stamped),
        "opening_mm": opening_mm,
        "pressures": np.array(pressures, dtype=np.float32),
        "coil": store.types[COIL](current_mA=current_mA),
        "note": "x",
    }


def write_bag(folder: Path, messages, *, storage="mcap", compression="none", parts=1):
    """Write messages, in the order of their log times, as a bag; as several files if it is to be split."""
    messages = sorted(messages, key=lambda message: message[2])
    if parts == 1:
        return _write(folder, messages, storage, compression)
    import yaml

    folder.mkdir()
    files, counts, whole = [], 0, None
    for part, some in enumerate(np.array_split(np.arange(len(messages)), parts)):
        one = folder.with_name(f"{folder.name}_{part}")
        _write(one, [messages[index] for index in some], storage, compression)
        said = yaml.safe_load((one / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
        for file in said["relative_file_paths"]:
            (one / file).rename(folder / file)
            files.append(file)
        counts += said["message_count"]
        whole = whole or said
    whole |= {"relative_file_paths": files, "message_count": counts}
    (folder / "metadata.yaml").write_text(yaml.safe_dump({"rosbag2_bagfile_information": whole}))
    return folder


def _write(folder, messages, storage, compression):
    store = types()
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin[storage.upper()])
    writer.set_compression(CompressionMode[compression.upper()], CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for topic, kind, logged, fields in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            content = store.types[kind](**fields(store))
            writer.write(connections[topic], logged, store.serialize_cdr(content, kind))
    return folder
