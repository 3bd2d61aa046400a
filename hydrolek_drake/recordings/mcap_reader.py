"""MCAP files and ROS 2 bags with `sensor_msgs/JointState` topics."""

import io
from collections import defaultdict
from contextlib import redirect_stderr
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.clock import ordered
from hydrolek_drake.recordings.finding import Finding
from hydrolek_drake.recordings.resampling import held, linear
from hydrolek_drake.recordings.table import Column, Table

_JOINT_STATE = ("sensor_msgs/msg/JointState", "sensor_msgs/JointState")
_SENSOR_FIELDS = {"position": "angle_rad", "velocity": "rate_rad_per_s", "effort": "effort_Nm"}
_COMMAND_FIELDS = {"position": "command_V"}
_COMMAND_ENDINGS = ("command", "commands")


class _Sample(NamedTuple):
    stamp: float  # header stamp [s]
    logged: float  # log time [s]
    message: Any


class _Series(NamedTuple):
    topic: str
    time: np.ndarray
    values: np.ndarray

    @property
    def is_command(self) -> bool:
        return _is_command(self.topic)


def read_mcap(path: Path) -> Table:
    """Read all JointState topics of an MCAP file.

    A joint's position, velocity and effort become `<joint>.angle_rad`, `.rate_rad_per_s` and `.effort_Nm`; on
    a topic whose name ends in `command` or `commands` its position is `<joint>.command_V`. A joint that is on
    several topics gets columns named `<topic>/<joint>.<quantity>_<unit>`, to be chosen from by a mapping.

    Time is the header stamp or, where a topic leaves it empty, the log time of every topic. Sensors are put
    on all times of the sensor topics (straight lines between their samples), commands are held.

    Raises:
        InputError: No such topic, no summary (recorder was killed), or stamps that run backwards.
    """
    samples = _samples(path)
    unstamped = any(all(sample.stamp == 0 for sample in topic) for topic in samples.values())
    findings: list[Finding] = []
    series: dict[str, list[_Series]] = defaultdict(list)
    for topic, messages in samples.items():
        time = np.array([sample.logged if unstamped else sample.stamp for sample in messages])
        keep, duplicate = ordered(time, f"{path}: time of topic {topic}", lambda i: f"message {i + 1}")
        if duplicate:
            findings.append(duplicate)
        kept = [sample.message for sample, wanted in zip(messages, keep, strict=True) if wanted]
        for name, one in _joint_series(path, topic, time[keep], kept).items():
            series[name].append(one)

    everything = [one for several in series.values() for one in several]
    if not everything:
        return Table(())
    sensors = [one for one in everything if not one.is_command] or everything
    time = np.unique(np.concatenate([one.time for one in sensors]))
    columns = [Column(("time_s",), time)]
    for name, several in series.items():
        for one in several:
            values = (held if one.is_command else linear)(one.time, one.values, time)
            columns.append(Column((name if len(several) == 1 else f"{one.topic}/{name}",), values))
    return Table(tuple(columns), findings=tuple(findings))


def mcap_of_bag(folder: Path) -> Path:
    """The MCAP file of a ROS 2 bag folder.

    Raises:
        InputError: The folder holds none or several.
    """
    files = sorted(folder.glob("*.mcap"))
    if len(files) == 1:
        return files[0]
    if not files:
        raise InputError(
            f"{folder} is a folder without an .mcap file; convert the bag with 'ros2 bag convert'"
        )
    raise InputError(
        f"{folder} holds {len(files)} .mcap files ({', '.join(file.name for file in files[:5])}); "
        "name one of them"
    )


def _samples(path: Path) -> dict[str, list[_Sample]]:
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    # The parser of message definitions prints what it cannot read, before it raises.
    with path.open("rb") as stream, redirect_stderr(io.StringIO()):
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        if summary is None:
            raise InputError(
                f"{path} has no summary: its recorder was not stopped properly; run 'mcap recover'"
            )
        kinds = {
            channel.topic: schema.name
            for channel in summary.channels.values()
            if (schema := summary.schemas.get(channel.schema_id))
        }
        topics = [topic for topic, kind in kinds.items() if kind in _JOINT_STATE]
        if not topics:
            has = ", ".join(f"{topic} ({kind})" for topic, kind in sorted(kinds.items())) or "no topics"
            raise InputError(f"{path} has no topic of sensor_msgs/msg/JointState; it has {has}")
        samples: dict[str, list[_Sample]] = defaultdict(list)
        for _, channel, message, content in reader.iter_decoded_messages(topics=topics):
            stamp = content.header.stamp
            samples[channel.topic].append(
                _Sample(stamp.sec + stamp.nanosec / 1e9, message.log_time / 10**9, content),
            )
    return samples


def _is_command(topic: str) -> bool:
    return topic.rstrip("/").endswith(_COMMAND_ENDINGS)


def _joint_series(path: Path, topic: str, time: np.ndarray, messages: list[Any]) -> dict[str, _Series]:
    """Samples of each joint and field on one topic; a message may leave out joints and fields."""
    samples: dict[str, list[tuple[float, float]]] = defaultdict(list)
    fields = _COMMAND_FIELDS if _is_command(topic) else _SENSOR_FIELDS
    for moment, message in zip(time, messages, strict=True):
        for field, column in fields.items():
            values = getattr(message, field)
            if len(values) not in (0, len(message.name)):
                raise InputError(
                    f"{path}: topic {topic} at {moment:.9g} s has {len(message.name)} names "
                    f"and {len(values)} of {field}; write one each"
                )
            for joint, value in zip(message.name, values, strict=False):
                samples[f"{joint}.{column}"].append((moment, value))
    return {
        name: _Series(topic, np.array([t for t, _ in pairs]), np.array([value for _, value in pairs]))
        for name, pairs in samples.items()
    }
