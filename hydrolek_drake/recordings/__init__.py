"""Recordings of commands and sensors: reading, checking, resampling, writing."""

from hydrolek_drake.recordings.columns import parse_column
from hydrolek_drake.recordings.finding import Finding
from hydrolek_drake.recordings.reading import read_recording
from hydrolek_drake.recordings.recording import Recording
from hydrolek_drake.recordings.requirements import require
from hydrolek_drake.recordings.writing import write_recording, write_signals

__all__ = [
    "Finding",
    "Recording",
    "parse_column",
    "read_recording",
    "require",
    "write_recording",
    "write_signals",
]
