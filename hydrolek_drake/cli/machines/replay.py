"""`hydrolek replay`: model against recording."""

from pathlib import Path
from typing import Annotated

import typer

from hydrolek_drake.cli.inputs import refuse_twice, rig_and_recordings, tell_what_looks_wrong
from hydrolek_drake.cli.settings import SeedOption, SetOption


def replay(
    rig: Annotated[str, typer.Argument(metavar="RIG", help="name of a built-in rig, or a rig file")],
    recordings: Annotated[
        list[Path], typer.Argument(metavar="RECORDING", help="files to replay, each by itself")
    ],
    between: Annotated[
        tuple[float, float] | None,
        typer.Option(metavar="START END", help="only this time of the recording [s]"),
    ] = None,
    set_: SetOption = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="folder for page, picture, numbers and signals"),
    ] = None,
    seed: SeedOption = None,
) -> None:
    """Drive a rig's model with a recorded command and compare it with what was measured."""
    from rich.console import Console

    from hydrolek_drake.cli.output import console

    output, progress = console(), Console(stderr=True)
    folders = _folders(recordings, out)
    loaded, (read,) = rig_and_recordings(rig, set_, recordings)

    from hydrolek_drake.replay import compare
    from hydrolek_drake.replay import replay as run_replay
    from hydrolek_drake.replay.table import signal_table

    with progress.status("checking (the first time, the physics is compiled: some 10 s)"):
        tell_what_looks_wrong(loaded, read, output, clocks=False)  # the report does
    for path, recording in zip(recordings, read, strict=True):
        with progress.status(f"replaying {path} (the first time, the physics is compiled: some 10 s)"):
            replayed = run_replay(loaded, recording, between)
            comparisons = compare(replayed)
        if len(recordings) > 1:
            output.print(f"{path}", style="bold", markup=False)
        for comparison in comparisons:
            output.print(comparison.sentence(), markup=False, soft_wrap=True)
        for note in replayed.notes:
            output.print(f"note: {note}", markup=False, soft_wrap=True)
        for finding in replayed.recording.findings:
            output.print(f"recording: {finding.message}", markup=False, soft_wrap=True)
        output.print()
        output.print(signal_table(comparisons))
        if folders:
            from hydrolek_drake.replay.report import write_report

            with progress.status("writing the report"):
                page = write_report(replayed, comparisons, folders[path])
            output.print(f"\nreport: {page}", markup=False, soft_wrap=True)
        if path is not recordings[-1]:
            output.print()


def _folders(recordings: list[Path], out: Path | None) -> dict[Path, Path]:
    """Where each recording's report goes: `out` itself for one, else folders named after the recordings."""
    refuse_twice(recordings)
    if out is None:
        return {}
    if len(recordings) == 1:
        return {recordings[0]: out}
    names = [path.stem for path in recordings]
    if len(set(names)) < len(names):
        names = ["_".join([path.absolute().parent.name, path.stem]) for path in recordings]
    if len(set(names)) < len(names):
        names = [f"{number}_{name}" for number, name in enumerate(names, start=1)]
    return {path: out / name for path, name in zip(recordings, names, strict=True)}
