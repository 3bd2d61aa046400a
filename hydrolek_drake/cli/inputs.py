"""What commands are given, read and checked before anything is loaded that computes."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hydrolek_drake.cli.settings import parse_settings
from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from hydrolek_drake.recordings import Recording
    from hydrolek_drake.rigs import Rig


def refuse_twice(recordings: Sequence[Path], why: str = "") -> None:
    """Check that no recording is given twice.

    Args:
        recordings: paths as given.
        why: what is wrong with it, if that needs to be said.

    Raises:
        InputError: one is.
    """
    for path in recordings:
        if recordings.count(path) > 1:
            raise InputError(f"recording {path} is given twice{why}")


def chosen(option: str, value: str, choices: Sequence[str]) -> None:
    """Check an option that is one of a few words.

    Raises:
        InputError: it is none of them.
    """
    if value not in choices:
        raise InputError(f"--{option} {value}: unknown; choose {', '.join(choices)}")


def rig_and_recordings(
    rig: str, settings: list[str] | None, *groups: Sequence[Path] | None
) -> "tuple[Rig, list[list[Recording]]]":
    """A rig with `--set`, and groups of recordings by its column names.

    Raises:
        InputError: what is wrong with any of them.
    """
    from hydrolek_drake.recordings import read_recording
    from hydrolek_drake.rigs import load_rig

    loaded = load_rig(rig, parse_settings(settings))
    read = [
        [read_recording(path, loaded.columns, dead_time=loaded.dead_time) for path in group or []]
        for group in groups
    ]
    from hydrolek_drake.checking.clock import refuse_other_clock

    for group in read:
        for recording in group:
            refuse_other_clock(loaded, recording)
    return loaded, read


def tell_of_clocks(recording: "Recording", console: "Console") -> None:
    """Say how signals with clocks of their own were put on one."""
    for finding in recording.findings:
        if finding.kind in ("offset", "resampled"):
            console.print(f"{recording.source}: {finding.message}", markup=False, soft_wrap=True)


def tell_what_looks_wrong(
    rig: "Rig", recordings: "Sequence[Recording]", console: "Console", *, clocks: bool = True
) -> None:
    """Say before anything long what looks wrong about a machine's numbers and recordings, as `hydrolek rig check` does.

    Args:
        rig: the machine.
        recordings: of it.
        console: where to say it.
        clocks: also say what was done to signals with clocks of their own.
    """
    from hydrolek_drake.checking.recording_checks import check_recording
    from hydrolek_drake.checking.rig_checks import at_a_glance

    for complaint in at_a_glance(rig):
        console.print(f"looks wrong: rig {rig.name}: {complaint.sentence()}", markup=False, soft_wrap=True)
    for recording in recordings:
        if clocks:
            tell_of_clocks(recording, console)
        for complaint in check_recording(rig, recording):
            if complaint.wrong:
                console.print(
                    f"looks wrong: {recording.source}: {complaint.sentence()}", markup=False, soft_wrap=True
                )
