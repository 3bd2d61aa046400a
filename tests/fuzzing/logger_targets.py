"""Recordings of data loggers: TDMS of LabVIEW, and MDF."""

import functools
import io
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from fuzzing.byte_damage import damaged
from fuzzing.reading import read, seeds_of
from fuzzing.strange_columns import good_columns, strange_columns
from fuzzing.target import Input, Target


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
    columns = good_columns(rng)

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
        return Input("run.tdms", _tdms_bytes(strange_columns(rng, alike=False), rng, int(rng.integers(1, 4))))
    return Input("run.tdms", damaged(files[rng.integers(len(files))], files, rng))


@functools.cache
def _mdf_files() -> list[bytes]:
    from asammdf import MDF, Signal

    columns = good_columns(np.random.default_rng(1))
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


TARGETS = (
    Target("tdms", _tdms, read, seeds_of("run.tdms", _tdms_files)),
    Target("mdf", _mdf, read, seeds_of("run.mf4", _mdf_files)),
)
