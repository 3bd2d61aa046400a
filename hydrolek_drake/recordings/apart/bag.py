"""Any numeric field of any message of a ROS bag, by rosbags."""

import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.apart.found import Asked, Found

STAMPED, LOGGED = "time_s", "log_time_s"
"""Endings of a topic's two times [ns]: of its messages' header, and of their arrival at the recorder."""

_LONGEST_SEQUENCE = 200
"""Elements of an array that may be signals; images, maps and clouds have more."""

_GLANCE = 10
"""Messages of a topic after which it is known whether it holds anything that is asked for; the first may be empty."""

_NO_SIGNALS = ("header", "layout")
_NAMING = ("name", "names", "joint_names")
"""Fields that name the elements of the other arrays of a message, as in sensor_msgs/JointState."""

_UNITS_OF_JOINT_STATE = {"position": "angle_rad", "velocity": "rate_rad_per_s", "effort": "effort_Nm"}
_JOINT_STATE = "sensor_msgs/msg/JointState"
_COMMAND_ENDINGS = ("command", "commands")
_FIELDS_WITH_UNIT = {("sensor_msgs/msg/FluidPressure", "fluid_pressure"): "_Pa"}
"""What the message type says about a field that alone is a signal."""

_FIELDS_ALONE = ("data",)
"""Fields whose topic has the signal's name: `std_msgs/Float64` on /arm/command_V."""


class _Topic(NamedTuple):
    name: str
    kind: str
    connections: list[Any]


def load(asked: Asked) -> None:
    """Load the package that reads."""
    import rosbags.highlevel  # noqa: F401


def read(path: Path, asked: Asked) -> Iterator[Found]:
    """Fields of all topics of a bag: a folder, or a file of MCAP, sqlite3 or ROS 1.

    A column is `/topic.field`, `/topic.field[2]` or, where the message names its elements,
    `/topic.field[joint]`. Each topic is a group, with the times `/topic.log_time_s` and, where its messages
    have stamps, `/topic.time_s`, in whole nanoseconds. Only topics of which a column is asked for are
    decoded; of the others the names are given.
    """
    from rosbags.highlevel import AnyReader
    from rosbags.highlevel.anyreader import AnyReaderError
    from rosbags.typesys import Stores, get_typestore

    reader = AnyReader(_files(path), default_typestore=get_typestore(Stores.LATEST))
    try:
        reader.open()
    except (AnyReaderError, FileNotFoundError) as error:
        raise ValueError(str(error)) from None
    try:
        topics = [
            _Topic(name, str(info.msgtype), info.connections)
            for name, info in reader.topics.items()
            if info.msgtype
        ]
        for topic in topics:
            yield from _of_topic(reader, topic, asked)
    finally:
        reader.close()


def _files(path: Path) -> list[Path]:
    """What rosbags opens: a folder with its metadata, or the files of a folder without."""
    if path.is_file():
        return [path]
    if (path / "metadata.yaml").exists():
        return [path]
    for ending in ("*.mcap", "*.db3", "*.bag"):
        if files := sorted(path.glob(ending)):
            return files
    raise InputError(
        "is a folder without a bag: neither metadata.yaml nor a file .mcap, .db3 or .bag is in it"
    )


def _of_topic(reader: Any, topic: _Topic, asked: Asked) -> Iterator[Found]:
    if topic.kind not in reader.typestore.fielddefs:
        yield Found((f"{topic.name} ({topic.kind}, whose definition is not in the bag)",), None, topic.name)
        return
    names: dict[str, tuple[str, ...]] = {}
    series: dict[str, list[tuple[int, float]]] = defaultdict(list)
    stamps: list[int] = []
    logged: list[int] = []
    wanted = any(name.startswith((f"{topic.name}.", f"{topic.name.lstrip('/')}.")) for name in asked.mapped)
    for index, (_, time, data) in enumerate(reader.messages(connections=topic.connections)):
        message = reader.deserialize(data, topic.kind)
        logged.append(time)
        stamps.append(_stamp(message))
        for field, alias, value in _fields(message):
            if field not in names:
                names[field] = _names(topic, field, alias)
                wanted = wanted or asked.wants(names[field])
            series[field].append((index, value))
        if not wanted and index >= _GLANCE:
            break
    if not wanted:
        yield from (Found(each, None, topic.name) for each in names.values())
        return
    groups: dict[bytes, str] = {np.arange(len(logged)).tobytes(): topic.name}
    for field, pairs in series.items():
        messages = np.array([index for index, _ in pairs])
        group = groups.setdefault(messages.tobytes(), f"{topic.name}.{field}")
        yield Found(names[field], np.array([value for _, value in pairs]), group)
    for indices, group in groups.items():
        messages = np.frombuffer(indices, dtype=int)
        yield Found((f"{group}.{LOGGED}",), np.array(logged, dtype=np.int64)[messages], group)
        if any(stamps):
            yield Found((f"{group}.{STAMPED}", STAMPED), np.array(stamps, dtype=np.int64)[messages], group)


def _stamp(message: Any) -> int:
    """Time of a message's header, or its own stamp [ns]; 0 where it has none."""
    stamp: Any = getattr(getattr(message, "header", message), "stamp", None)
    return stamp.sec * 1_000_000_000 + stamp.nanosec if hasattr(stamp, "nanosec") else 0


def _fields(message: Any, prefix: str = "", alias: str = "") -> Iterator[tuple[str, str, float]]:
    """Every number in a message: its place, the same by index instead of by name, and the value."""
    fields = {name: value for name, value in vars(message).items() if name not in _NO_SIGNALS}
    labels = next((fields[name] for name in _NAMING if isinstance(fields.get(name), list)), None)
    for name, value in fields.items():
        place, other = f"{prefix}{name}", f"{alias}{name}"
        if isinstance(value, (bool, int, float, np.number)):
            yield place, other, float(value)
        elif isinstance(value, (list, np.ndarray)) and 0 < len(value) <= _LONGEST_SEQUENCE:
            yield from _elements(place, other, value, labels)
        elif hasattr(value, "__msgtype__"):
            yield from _fields(value, f"{place}.", f"{other}.")


def _elements(
    place: str, alias: str, values: Any, labels: list[Any] | None
) -> Iterator[tuple[str, str, float]]:
    if isinstance(values[0], str):
        return
    if not labels or not isinstance(labels[0], str):
        labels = [str(index) for index in range(len(values))]
    elif len(labels) != len(values):
        raise InputError(f"a message has {len(labels)} names and {len(values)} of {place}; write one each")
    if isinstance(values, np.ndarray):  # by far the most, and faster as plain numbers
        for index, (label, value) in enumerate(zip(labels, values.tolist(), strict=True)):
            yield f"{place}[{label}]", f"{alias}[{index}]", value
        return
    for index, (label, value) in enumerate(zip(labels, values, strict=True)):
        if hasattr(value, "__msgtype__"):
            yield from _fields(value, f"{place}[{label}].", f"{alias}[{index}].")
        elif isinstance(value, (bool, int, float)):
            yield f"{place}[{label}]", f"{alias}[{index}]", float(value)


def _names(topic: _Topic, field: str, alias: str) -> tuple[str, ...]:
    """Names of a field: with its topic, without the leading slash, and those of the contract that its type says."""
    names = [f"{root}.{place}" for root in (topic.name, topic.name.lstrip("/")) for place in (field, alias)]
    dotted = ".".join(topic.name.strip("/").split("/")[-2:])
    if topic.kind == _JOINT_STATE and (parts := re.fullmatch(r"(\w+)\[(.+)\]", field)):
        which, joint = parts.groups()
        if topic.name.rstrip("/").endswith(_COMMAND_ENDINGS):
            implied = {"position": "command_V"}.get(which)
        else:
            implied = _UNITS_OF_JOINT_STATE.get(which)
        names += [f"{joint}.{implied}"] if implied else []
    elif field in _FIELDS_ALONE:
        names.append(dotted)
    elif unit := _FIELDS_WITH_UNIT.get((topic.kind, field)):
        names += [dotted + unit, dotted] if not dotted.endswith(unit) else [dotted]
    return tuple(dict.fromkeys(names))
