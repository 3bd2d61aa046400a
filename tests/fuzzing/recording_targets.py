"""Recordings in each format: good files of several kinds, and damage to their content and to their bytes."""

import functools
import importlib.util
import io
import sqlite3
import tempfile
import warnings
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import bags
import numpy as np

from fuzzing.byte_damage import damaged
from fuzzing.target import Input, Target
from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording, write_recording

_ROWS = 40
_MAPPING = {
    "t": "time_s",
    "q": "j.angle_deg",
    "u": "j.command_V",
    "x": "ignore",
    "/valve.pressures[1]": "j.pressure_b_bar",
}
_NAMES = (
    "time_s", "time_ms", "time", "t", "q", "u", "j.command_V", "j.angle_deg", "j.angle_rad", "j.angle",
    "j.pressure_a_MPa", "supply.pressure_bar", "j.effort_Nm", "j.force_1", "j.command_percent",
    "j.angle_deg_per_s", "k.position_mm", "x", "", " ", ".", "j.", ".angle_deg", "j..angle_deg",
    "j.angle_m^9^9", "j.angle_9**9**9", "j.command_V/V*V", "a" * 300, "é.angle_deg", "j.angle_(deg",
    "j.angle_\x00deg", "a,b.angle_deg", "=j.angle_deg", '"', "=1+1", "time_parsec", "time_s ", "TIME_S",
    "j.reference_V", "j.pot_1",
)  # fmt: skip
_CELLS = (
    "", " ", "0", "1", "-1", "1e300", "-1e300", "1e999", "nan", "NaN", "inf", "-inf", "1,5", "1.5", "1;2", "x",
    "1_0", "0x10", "٣", "1e", ".", "-", "+", "1 2", '"', '"1"', "'1", "1" * 400, "\x00", "é", "=1+1", "#",
    "# 1", "1e-320", "TRUE", "None", "2026-11-27T12:00:00", "12:00:00", "\t", "1\r2", "\u2028", "\ufeff1", "−1",
    "1 ", "01.02.2024",
)  # fmt: skip


def _columns(rng: np.random.Generator) -> dict[str, np.ndarray]:
    time = 12.5 + np.cumsum(rng.uniform(0.0095, 0.0105, _ROWS))
    return {
        "time_s": time,
        "j.command_V": np.sign(np.sin(3 * time)) * 4.25,
        "j.angle_deg": 25 + 10 * np.sin(time),
        "j.pressure_a_MPa": 5 + np.cos(2 * time),
    }


def _strange_values(rng: np.random.Generator, rows: int) -> np.ndarray:
    """Numbers that a column may hold, of any type that NumPy has for them."""
    edges = [0.0, -0.0, 1.0, -1.0, 1e300, -1e300, 5e-324, np.inf, -np.inf, np.nan, 2.0**53, 1e-9]
    match rng.integers(8):
        case 0:
            return rng.choice(edges, rows)
        case 1:
            return np.full(rows, rng.choice(edges))
        case 2:
            return rng.integers(-(2**62), 2**62, rows)
        case 3:
            return rng.integers(0, 2, rows).astype(bool)
        case 4:
            return np.sort(rng.choice(edges[:7], rows))
        case 5:
            return np.cumsum(rng.uniform(-0.1, 1.0, rows)).astype(rng.choice(["f4", "f2", "i1", "u8", "i4"]))
        case 6:
            return np.arange(rows)[:: int(rng.choice([-1, 1]))]
        case _:
            return rng.normal(size=rows) * 10.0 ** rng.uniform(-300, 300)


def _strange_columns(rng: np.random.Generator, *, alike: bool = True) -> dict[str, np.ndarray]:
    """Columns with names and values that nobody meant; with some that are good, as often as not."""
    rows = int(rng.choice([0, 1, 2, 3, _ROWS]))
    good = _columns(rng) if rng.random() < 0.8 else {}
    columns = {name: values[:rows] for name, values in good.items() if rng.random() < 0.8}
    for _ in range(rng.integers(0, 4)):
        own = rows if alike or rng.random() < 0.7 else int(rng.integers(0, 50))
        columns[str(rng.choice(_NAMES))] = _strange_values(rng, own)
    for name in list(columns):
        if rng.random() < 0.15:
            columns[name] = _strange_values(rng, rows)
    return columns


def _csv_text(columns: dict[str, np.ndarray], rng: np.random.Generator) -> str:
    """Text with a separator, quotes and line ends of many kinds."""
    separator = str(rng.choice([",", ",", ",", ",", ",", ";", "\t", "|", " "]))
    end = str(rng.choice(["\n", "\n", "\r\n", "\r"]))
    decimal = str(rng.choice([".", ".", ".", ".", ","]))
    rows = [[*columns]]
    rows += [
        [str(value).replace(".", decimal) for value in row] for row in zip(*columns.values(), strict=False)
    ]
    for _ in range(rng.integers(0, 4)):
        row = rows[rng.integers(len(rows))]
        if row and rng.random() < 0.8:
            row[rng.integers(len(row))] = str(rng.choice(_CELLS))
        elif rng.random() < 0.5:
            row.append(str(rng.choice(_CELLS)))
        else:
            rows.insert(
                int(rng.integers(len(rows))), [str(rng.choice(["# note", "", " ", '"', "\x1a", ",,,"]))]
            )
    return end.join(separator.join(row) for row in rows) + (end if rng.random() < 0.9 else "")


def _csv(rng: np.random.Generator) -> Input:
    name = str(rng.choice(["run.csv", "run.csv", "run.tsv", "run.txt", "run.dat"]))
    columns = _columns(rng) if rng.random() < 0.5 else _strange_columns(rng)
    data = _csv_text(columns, rng).encode(
        str(rng.choice(["utf-8", "utf-8", "utf-8", "utf-8-sig", "utf-16", "cp1252"])), "replace"
    )
    if rng.random() < 0.3:
        data = damaged(data, [_csv_seeds()[0].data], rng)
    return Input(name, data)


def _csv_seeds() -> list[Input]:
    columns = _columns(np.random.default_rng(1))
    lines = [
        ",".join(columns),
        *(",".join(map(repr, map(float, row))) for row in zip(*columns.values(), strict=True)),
    ]
    text = "\n".join(lines) + "\n"
    decimal_comma = text.replace(",", ";").replace(".", ",").replace("j,", "j.")
    return [
        Input("run.csv", text.encode()),
        Input("run.tsv", text.replace(",", "\t").encode()),
        Input("run.txt", decimal_comma.encode("utf-16")),
    ]


def _parquet_bytes(columns: dict[str, Any], **options: Any) -> bytes:
    import pyarrow
    from pyarrow import parquet

    arrays = {name: pyarrow.array(values) for name, values in columns.items()}
    stream = io.BytesIO()
    parquet.write_table(pyarrow.table(arrays), stream, **options)
    return stream.getvalue()


@functools.cache
def _parquet_files() -> list[bytes]:
    import pyarrow

    columns: dict[str, Any] = dict(_columns(np.random.default_rng(1)))
    stamped = {
        "time": (1e9 * columns["time_s"]).astype("datetime64[ns]"),
        "j.angle_deg": columns["j.angle_deg"],
    }
    odd = columns | {
        "list": pyarrow.array([[1.0]] * _ROWS),
        "text": pyarrow.array(["a"] * _ROWS),
        "some": pyarrow.array([None, 1.0] * (_ROWS // 2)),
        "kind": pyarrow.array(["a", "b"] * (_ROWS // 2)).dictionary_encode(),
        "bytes": pyarrow.array([b"\x00"] * _ROWS),
        "struct": pyarrow.array([{"a": 1}] * _ROWS),
    }
    return [
        _parquet_bytes(columns, compression="none", use_dictionary=False),
        _parquet_bytes(columns, compression="snappy"),
        _parquet_bytes(columns, compression="gzip", data_page_version="2.0", row_group_size=10),
        _parquet_bytes(stamped, compression="none"),
        _parquet_bytes(odd, compression="none", write_page_checksum=True),
    ]


def _parquet(rng: np.random.Generator) -> Input:
    files = _parquet_files()
    if rng.random() < 0.3:
        columns: dict[str, Any] = dict(_strange_columns(rng))
        for name in list(columns):
            if rng.random() < 0.1:
                columns[name] = [str(rng.choice(_CELLS)) for _ in columns[name]]
        return Input("run.parquet", _parquet_bytes(columns))
    return Input("run.parquet", damaged(files[rng.integers(len(files))], files, rng))


def _tdms_bytes(columns: dict[str, np.ndarray], rng: np.random.Generator, segments: int = 1) -> bytes:
    from nptdms import ChannelObject, RootObject, TdmsWriter

    stream = io.BytesIO()
    with TdmsWriter(stream) as writer:
        for part in range(segments):
            objects = []
            for name, values in columns.items():
                kind = values.dtype if values.dtype.kind in "iufM" and values.dtype != np.float16 else "f8"
                pieces = np.array_split(np.asarray(values).astype(kind), segments)
                properties: dict[str, Any] = {}
                if rng.random() < 0.3:
                    properties["wf_increment"] = float(rng.choice([0.01, 0.01, 0.0, -1.0, np.nan, 1e300]))
                if rng.random() < 0.2:
                    properties["wf_start_offset"] = (
                        rng.choice([0.0, np.inf, 1e300]) if rng.random() < 0.8 else "x"
                    )
                objects.append(
                    ChannelObject(
                        str(rng.choice(["j", "g", ""])), name or "unnamed", pieces[part], properties
                    )
                )
            writer.write_segment([RootObject({"made": "here"}), *objects])
    return stream.getvalue()


@functools.cache
def _tdms_files() -> list[bytes]:
    rng = np.random.default_rng(3)
    columns = _columns(rng)

    class Plain:  # no strange properties
        random = staticmethod(lambda: 1.0)
        choice = staticmethod(lambda options: options[0])

    waveform = {name: values for name, values in columns.items() if name != "time_s"}
    from nptdms import ChannelObject, TdmsWriter

    stream = io.BytesIO()
    with TdmsWriter(stream) as writer:
        objects = [
            ChannelObject("g", name, values, {"wf_increment": 0.01}) for name, values in waveform.items()
        ]
        writer.write_segment(objects)
    plain: Any = Plain()
    return [_tdms_bytes(columns, plain), _tdms_bytes(columns, plain, 4), stream.getvalue()]


def _tdms(rng: np.random.Generator) -> Input:
    files = _tdms_files()
    if rng.random() < 0.25:
        return Input(
            "run.tdms", _tdms_bytes(_strange_columns(rng, alike=False), rng, int(rng.integers(1, 4)))
        )
    return Input("run.tdms", damaged(files[rng.integers(len(files))], files, rng))


def _mat_bytes(content: dict[str, Any], *, compressed: bool = False) -> bytes:
    import scipy.io

    stream = io.BytesIO()
    scipy.io.savemat(stream, content, do_compression=compressed)
    return stream.getvalue()


@functools.cache
def _mat_files() -> list[bytes]:
    import scipy.sparse

    columns = _columns(np.random.default_rng(1))
    log = {
        "time_s": columns["time_s"],
        "j": {"angle_deg": columns["j.angle_deg"], "command_V": columns["j.command_V"]},
    }
    odd = {
        "log": log,
        "text": "made here",
        "cells": np.array([1.0, "a", np.arange(3)], dtype=object),
        "sparse": scipy.sparse.eye(5).tocsc(),
        "complex": np.array([1 + 2j, 3.0]),
        "flags": np.array([True, False]),
        "whole": np.arange(5, dtype=np.int16),
        "empty": np.zeros((0, 0)),
        "table": np.ones((3, 4)),
    }
    return [
        _mat_bytes({"log": log}),
        _mat_bytes(odd),
        _mat_bytes({"log": log}, compressed=True),
        *_timetables("v7"),
    ]


def _mat(rng: np.random.Generator) -> Input:
    files = _mat_files()
    if rng.random() < 0.2:
        columns = _strange_columns(rng, alike=False)
        names = [
            name if name.isidentifier() and len(name) < 32 else f"v{i}" for i, name in enumerate(columns)
        ]
        values = [
            np.asarray(each) if each.dtype != np.float16 else each.astype("f4") for each in columns.values()
        ]
        content: dict[str, Any] = dict(zip(names, values, strict=True))
        if rng.random() < 0.5:
            content = {"log": content}
        return Input("run.mat", _mat_bytes(content, compressed=bool(rng.random() < 0.5)))
    return Input("run.mat", damaged(files[rng.integers(len(files))], files, rng))


@functools.cache
def _hdf5_files() -> list[bytes]:
    import h5py

    columns = _columns(np.random.default_rng(1))
    plain = {name.replace(".", "/"): values for name, values in columns.items()}
    stream = io.BytesIO()
    with h5py.File(stream, "w", userblock_size=512) as file:
        for name, values in plain.items():
            file.create_dataset(name, data=values[None, :], chunks=(1, 10), compression="gzip")
        file.create_dataset("text", data="a")
        file.create_dataset("some", data=np.array([b"a", b"b"]))
        file.create_dataset("#refs#/a", data=np.arange(5.0))
        file["log"] = h5py.SoftLink("/j")
        file["loop"] = h5py.SoftLink("/loop")
        file["time_s"].attrs["MATLAB_class"] = np.bytes_("double")
    stream.seek(0)
    stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\x00\x02IM")
    return [stream.getvalue(), _hdf5_user_block(plain), *_timetables("v7.3")]


def _hdf5_user_block(columns: dict[str, Any]) -> bytes:
    import h5py

    stream = io.BytesIO()
    with h5py.File(stream, "w", userblock_size=512) as file:
        for name, values in columns.items():
            place = name.replace("\x00", "").strip("./")
            if place and place not in file:
                try:
                    file.create_dataset(place, data=np.atleast_2d(values))
                except (
                    ValueError,
                    TypeError,
                ):  # a group of that name, or a part of the name is a value already
                    continue
    stream.seek(0)
    stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\x00\x02IM")
    return stream.getvalue()


def _mat73(rng: np.random.Generator) -> Input:
    files = _hdf5_files()
    if rng.random() < 0.2:
        return Input("run.mat", _hdf5_user_block(_strange_columns(rng, alike=False)))
    return Input("run.mat", damaged(files[rng.integers(len(files))], files, rng))


def _bag_files(messages: list[tuple[Any, ...]], **options: Any) -> dict[str, bytes]:
    """Files of a bag by their names."""
    with tempfile.TemporaryDirectory() as place:
        folder = bags.write_bag(Path(place) / "bag", messages, **options)
        return {file.name: file.read_bytes() for file in folder.iterdir()}


def _one_file(files: dict[str, bytes]) -> bytes:
    return next(data for name, data in files.items() if name != "metadata.yaml")


def _good_messages() -> list[tuple[Any, ...]]:
    messages = []
    for i in range(_ROWS):
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


@functools.cache
def _mdf_files() -> list[bytes]:
    from asammdf import MDF, Signal

    columns = _columns(np.random.default_rng(1))
    time = columns.pop("time_s")
    files = []
    for version, options in (("4.10", {}), ("4.10", {"compression": 2}), ("3.30", {})):
        with tempfile.TemporaryDirectory() as place, MDF(version=version) as file:
            for name, values in columns.items():
                file.append([Signal(values, time, unit="V", name=name)])
            saved = file.save(Path(place) / "run.mf4", overwrite=True, **options)
            files.append(Path(saved).read_bytes())
    return files


def _mdf(rng: np.random.Generator) -> Input:
    files = _mdf_files()
    return Input("run.mf4", damaged(files[rng.integers(len(files))], files, rng))


def _timetables(version: str) -> list[bytes]:
    """A file of MATLAB with a timetable; none where Python is too old for the package that writes it."""
    if importlib.util.find_spec("matio") is None:
        return []
    import matio
    import pandas

    columns = _columns(np.random.default_rng(1))
    time = pandas.Index(pandas.to_timedelta(columns["time_s"], unit="s").round("ms"), name="Time")
    table = pandas.DataFrame({"q": columns["j.angle_deg"], "u": columns["j.command_V"]}, index=time)
    with tempfile.TemporaryDirectory() as place, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = Path(place) / "run.mat"
        matio.save_to_mat(str(path), {"log": table}, version=version)
        return [path.read_bytes()]


def _read(path: Path) -> str:
    recording = read_recording(path, _MAPPING)
    with tempfile.TemporaryDirectory() as folder:
        try:
            written = write_recording(recording, Path(folder) / "again.csv")
        except InputError:
            return "not written"
        again = read_recording(written)
    assert np.array_equal(again.time, recording.time), "what was written of it is another recording"
    return "read"


def _seeds(name: str, files: Callable[[], list[bytes]]) -> Callable[[], list[Input]]:
    return lambda: [Input(name, data) for data in files()]


def _bag_seeds() -> list[Input]:
    return [Input("bag/metadata.yaml", _bag()["metadata.yaml"])]


TARGETS = (
    Target("csv", _csv, _read, _csv_seeds),
    Target("parquet", _parquet, _read, _seeds("run.parquet", _parquet_files)),
    Target("tdms", _tdms, _read, _seeds("run.tdms", _tdms_files)),
    Target("mat", _mat, _read, _seeds("run.mat", _mat_files)),
    Target("mat73", _mat73, _read, _seeds("run.mat", _hdf5_files)),
    Target("mcap", _mcap, _read, _seeds("run.mcap", _mcap_files)),
    Target("db3", _db3, _read, _seeds("run.db3", _db3_files)),
    Target("bag", _folder, _read, _bag_seeds, _beside_metadata),
    Target("mdf", _mdf, _read, _seeds("run.mf4", _mdf_files)),
)
