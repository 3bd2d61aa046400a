"""A recording is read, written and read again; and the good files that a target begins with."""

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from fuzzing.target import Input
from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording, write_recording

_MAPPING = {
    "t": "time_s",
    "q": "j.angle_deg",
    "u": "j.command_V",
    "x": "ignore",
    "/valve.pressures[1]": "j.pressure_b_bar",
}


def read(path: Path) -> str:
    """What became of a file: `read`, or `not written`; one that is refused raises `InputError`."""
    recording = read_recording(path, _MAPPING)
    with tempfile.TemporaryDirectory() as folder:
        try:
            written = write_recording(recording, Path(folder) / "again.csv")
        except InputError:
            return "not written"
        again = read_recording(written)
    assert np.array_equal(again.time, recording.time), "what was written of it is another recording"
    return "read"


def seeds_of(name: str, files: Callable[[], list[bytes]]) -> Callable[[], list[Input]]:
    """Of a target: these files under a name."""
    return lambda: [Input(name, data) for data in files()]
