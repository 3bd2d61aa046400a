"""Recordings of MATLAB: MAT-files up to version 7, and those of version 7.3, which are HDF5."""

import functools
import importlib.util
import io
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from fuzzing.byte_damage import damaged
from fuzzing.reading import read, seeds_of
from fuzzing.strange_columns import good_columns, strange_columns
from fuzzing.target import Input, Target


def _mat_bytes(content: dict[str, Any], *, compressed: bool = False) -> bytes:
    import scipy.io

    stream = io.BytesIO()
    scipy.io.savemat(stream, content, do_compression=compressed)
    return stream.getvalue()


@functools.cache
def _mat_files() -> list[bytes]:
    import scipy.sparse

    columns = good_columns(np.random.default_rng(1))
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
        columns = strange_columns(rng, alike=False)
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

    columns = good_columns(np.random.default_rng(1))
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
        return Input("run.mat", _hdf5_user_block(strange_columns(rng, alike=False)))
    return Input("run.mat", damaged(files[rng.integers(len(files))], files, rng))


def _timetables(version: str) -> list[bytes]:
    """A file of MATLAB with a timetable; none where Python is too old for the package that writes it."""
    if importlib.util.find_spec("matio") is None:
        return []
    import matio
    import pandas

    columns = good_columns(np.random.default_rng(1))
    time = pandas.Index(pandas.to_timedelta(columns["time_s"], unit="s").round("ms"), name="Time")
    table = pandas.DataFrame({"q": columns["j.angle_deg"], "u": columns["j.command_V"]}, index=time)
    with tempfile.TemporaryDirectory() as place, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = Path(place) / "run.mat"
        matio.save_to_mat(str(path), {"log": table}, version=version)
        return [path.read_bytes()]


TARGETS = (
    Target("mat", _mat, read, seeds_of("run.mat", _mat_files)),
    Target("mat73", _mat73, read, seeds_of("run.mat", _hdf5_files)),
)
