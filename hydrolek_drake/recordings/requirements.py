"""What a computation needs from a recording, said before it starts."""

import re
from collections.abc import Iterable, Mapping

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.recording import Recording


def require(
    recording: Recording,
    keys: Iterable[str],
    *,
    complete: Iterable[str] = (),
    units: Mapping[str, str] | None = None,
) -> None:
    """Check that a recording has the signals that are needed.

    Args:
        recording: The recording.
        keys: Signals that must be there; they may have NaN stretches.
        complete: Signals that must be there in every sample, such as a command that is to be replayed.
        units: SI unit that a signal must have, where its quantity allows several.

    Raises:
        InputError: A signal is missing, has another unit, or has a NaN although it must be complete.
    """
    complete = tuple(complete)
    for key in (*keys, *complete):
        if key not in recording.signals:
            raise InputError(_missing(recording, key))
    for key, unit in (units or {}).items():
        if key in recording.signals and recording.units[key] != unit:
            raise InputError(
                f"{recording.source}: signal {key} is in {recording.units[key]}; {unit} is needed"
            )
    for key in complete:
        gone = np.isnan(recording.signals[key])
        if gone.any():
            raise InputError(
                f"{recording.source}: signal {key} has no value at {recording.time[gone.argmax()]:.9g} s "
                f"({int(gone.sum())} of {gone.size} samples); it is needed in every sample, so cut the "
                "recording to a part that has it"
            )


def _missing(recording: Recording, key: str) -> str:
    unused = f" and the unused columns {', '.join(recording.ignored)}" if recording.ignored else ""
    example = recording.ignored[0] if recording.ignored else "NAME"
    if not re.fullmatch(r"[\w./-]+", example):  # brackets mean something within a mapping in one line
        example = f'"{example}"'
    return (
        f"{recording.source}: signal {key} is missing; the file has {', '.join(sorted(recording.signals))}"
        f"{unused}; "
        f"if it is there under another name, map it in the rig: 'recording: {{columns: {{{example}: {key}_<unit>}}}}'"
    )
