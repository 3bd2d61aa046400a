"""Recordings of ROS 2: MCAP, SQLite, and bags as folders."""

import functools
import sqlite3
import tempfile
from contextlib import closing
from pathlib import Path
from typing import Any

import bags
import numpy as np

from fuzzing.byte_damage import damaged
from fuzzing.reading import read, seeds_of
from fuzzing.strange_columns import ROWS
from fuzzing.target import Input, Target


def _bag_files(messages: list[tuple[Any, ...]], **options: Any) -> dict[str, bytes]:
    """Files of a bag by their names."""
    with tempfile.TemporaryDirectory() as place:
        folder = bags.write_bag(Path(place) / "bag", messages, **options)
        return {file.name: file.read_bytes() for file in folder.iterdir()}


def _one_file(files: dict[str, bytes]) -> bytes:
    return next(data for name, data in files.items() if name != "metadata.yaml")


def _good_messages() -> list[tuple[Any, ...]]:
    messages = []
    for i in range(ROWS):
        at = i * 10**7 + 1
        state = bags.joint_state(at, ["j", "k"], [0.01 * i, 1.0], [0.0, 1.0])
        messages.append(("/joint_states", bags.JOINT_STATE, at, state))
        messages.append(("/valve", bags.VALVE, at, bags.valve(at, 0.1 * i, [1.0, i], i)))
        if i % 4 == 0:
            messages.append(("/j/command_V", bags.FLOAT64, at, bags.number(0.5)))
    return messages


def _strange_message(number: int, rng: np.random.Generator) -> tuple[Any, ...]:
    def values() -> list[float]:
        return [float(rng.choice([0.0, 1.0, np.nan, np.inf, 1e300])) for _ in range(rng.integers(0, 3))]

    at = int(rng.choice([number * 10**7, 0, 2**31 * 10**9 - 1, 5]))
    logged = int(rng.choice([number * 10**7, 0, 2**62]))
    names = [str(rng.choice(["j", "k", "", "a.b", "\n", "x" * 300])) for _ in range(rng.integers(0, 3))]
    kind, fields = (
        (bags.JOINT_STATE, bags.joint_state(at, names, values(), values())),
        (bags.FLOAT64S, bags.numbers(values())),
        (bags.FLUID_PRESSURE, bags.pressure(at, float(rng.choice([0.0, np.nan, 1e300])))),
    )[rng.integers(3)]
    topic = str(rng.choice(["/a", "/b/command", "/j/pressure_a", "é", "/" + "x" * 200]))
    return f"{topic}{kind[-5:]}", kind, logged, fields


@functools.cache
def _mcap_files() -> list[bytes]:
    packed = ({}, {"compression": "storage"})
    return [_one_file(_bag_files(_good_messages(), **options)) for options in packed]


def _mcap(rng: np.random.Generator) -> Input:
    files = _mcap_files()
    if rng.random() < 0.2:
        messages = [_strange_message(i, rng) for i in range(int(rng.integers(0, 20)))]
        return Input("run.mcap", _one_file(_bag_files(messages)))
    return Input("run.mcap", damaged(files[rng.integers(len(files))], files, rng))


@functools.cache
def _db3_files() -> list[bytes]:
    return [_one_file(_bag_files(_good_messages(), storage="sqlite3"))]


def _db3(rng: np.random.Generator) -> Input:
    files = _db3_files()
    if rng.random() < 0.2:
        return Input("run.db3", _hostile_database(files[0], rng))
    return Input("run.db3", damaged(files[rng.integers(len(files))], files, rng))


def _hostile_database(good: bytes, rng: np.random.Generator) -> bytes:
    """A database whose content is of another kind than its tables say, or whose tables have no end."""
    changes = (
        "UPDATE messages SET data = 'text'",
        "UPDATE messages SET data = randomblob(100000)",
        "UPDATE messages SET timestamp = 'soon'",
        "UPDATE topics SET type = 'std_msgs/msg/Nothing'",
        "UPDATE topics SET name = x'ff'",
        "UPDATE message_definitions SET encoded_message_definition = 'float64[999999999] data'",
        "UPDATE message_definitions SET encoded_message_definition = '" + "(" * 2000 + "'",
        "DROP TABLE messages; CREATE VIEW messages AS WITH RECURSIVE n(id) AS "
        "(SELECT 1 UNION ALL SELECT id + 1 FROM n) SELECT id, 1 AS topic_id, id AS timestamp, x'00' AS data FROM n",
    )
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "run.db3"
        path.write_bytes(good)
        with closing(sqlite3.connect(path)) as database:
            database.execute("PRAGMA writable_schema = ON")
            database.executescript("PRAGMA ignore_check_constraints = ON;" + str(rng.choice(changes)))
            database.commit()
        return path.read_bytes()


@functools.cache
def _bag() -> dict[str, bytes]:
    return _bag_files(_good_messages(), storage="sqlite3", compression="file")


def _beside_metadata(folder: Path) -> None:
    """Puts the files of a good bag where damaged metadata will be put."""
    (folder / "bag").mkdir(exist_ok=True)
    for name, data in _bag().items():
        (folder / "bag" / name).write_bytes(data)


def _folder(rng: np.random.Generator) -> Input:
    good = _bag()
    name = str(rng.choice([*good, "metadata.yaml"]))
    return Input(f"bag/{name}", damaged(good[name], [good["metadata.yaml"]], rng))


def _bag_seeds() -> list[Input]:
    return [Input("bag/metadata.yaml", _bag()["metadata.yaml"])]


TARGETS = (
    Target("mcap", _mcap, read, seeds_of("run.mcap", _mcap_files)),
    Target("db3", _db3, read, seeds_of("run.db3", _db3_files)),
    Target("bag", _folder, read, _bag_seeds, _beside_metadata),
)
