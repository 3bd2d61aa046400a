"""`hydrolek watch`: what changed on a machine since its healthy reference."""

import contextlib
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.cli.inputs import refuse_twice
from hydrolek_drake.cli.settings import SeedOption, SetOption, parse_settings
from hydrolek_drake.errors import InputError
from hydrolek_drake.watching.listing import listed

if TYPE_CHECKING:
    from hydrolek_drake.identification.search.cluster_jobs import ClusterJobs

ALARM = 3
"""Exit status where there is an alarm."""

PAGE_PORT = 6351
"""Of the page of `--live`: next to those of the link and of a stream."""


def _cluster(address: str | None) -> "contextlib.AbstractContextManager[ClusterJobs | None]":
    """A cluster that evaluates recordings, if one is named."""
    if address is None:
        return contextlib.nullcontext()
    from hydrolek_drake.identification.search.cluster_jobs import ClusterJobs

    return ClusterJobs(address)


def watch(
    rig: Annotated[str, typer.Argument(metavar="RIG", help="name of a built-in rig, or a rig file")],
    reference: Annotated[
        list[Path], typer.Argument(metavar="REFERENCE", help="recordings of the healthy machine")
    ],
    recordings: Annotated[
        list[Path] | None,
        typer.Option(metavar="FOLDER|FILE", help="later recordings: files, or folders of them (repeatable)"),
    ] = None,
    live: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|FOLDER|tcp://HOST:PORT",
            help="in place of --recordings: follow a file or bag that grows, a folder in which recordings appear, or "
            "listen for a stream; until Ctrl-C",
        ),
    ] = None,
    port: Annotated[
        int | None,
        typer.Option(min=0, max=65535, help="of the page of --live, on this machine; 6351 if not given"),
    ] = None,
    foxglove: Annotated[
        int | None,
        typer.Option(min=0, max=65535, metavar="PORT", help="with --live: publish for Foxglove there (8765)"),
    ] = None,
    token: Annotated[
        str | None,
        typer.Option(
            envvar="HYDROLEK_LINK_TOKEN",
            help="with --live: what a sender over a network must show first; a new one is made if none is given",
        ),
    ] = None,
    idle: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", help="with --live: end once nothing has come for so long"),
    ] = None,
    drift: Annotated[
        list[str] | None,
        typer.Option(
            metavar="[NAME=]SHARE",
            help="how far the machine's own numbers may drift between recordings (standard deviation, in ranges): "
            "0.02 for all, load=0.1 for some (repeatable)",
        ),
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="what changes between recordings of the healthy machine and is fitted to each anew: an effect such as "
            "load.payload, or a number with a range such as cylinder.viscous_friction (repeatable)",
        ),
    ] = None,
    limit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="EFFECT=SIZE",
            help="forecast when an effect reaches this size, in SI or with a unit (repeatable)",
        ),
    ] = None,
    false_alarms: Annotated[
        float, typer.Option(help="probability of any false alarm in the whole series")
    ] = 0.01,
    workers: Annotated[
        int | None, typer.Option(min=1, help="threads; as many as there are cores by default")
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="evaluate recordings on an existing Dask cluster, one on each worker, such as tcp://host:8786",
        ),
    ] = None,
    set_: SetOption = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="folder for table and page, and to go on from")
    ] = None,
    seed: SeedOption = None,
) -> None:
    """Evaluate what differs from the healthy machine in each recording; exit status 3 is an alarm.

    The same command goes on where an earlier one ended: what was evaluated is not evaluated again.
    """
    from hydrolek_drake.cli.output import console, progress

    if not 0.0 < false_alarms < 1.0:
        raise InputError(f"--false-alarms {false_alarms:g}: a probability between 0 and 1 is needed")
    refuse_twice(reference)
    drifts = dict(_drift(each) for each in drift or [])
    if (live is None) == (not recordings):
        raise InputError("watch: give either --recordings or --live")
    if cluster is not None and (live is not None or workers is not None):
        raise InputError(
            "--cluster is for --recordings on other computers: no --live, no --workers beside it"
        )
    if live is not None and changes:
        raise InputError("--changes is for --recordings: a stream's innovations are judged as they come")
    given = {"--port": port, "--foxglove": foxglove, "--idle": idle}
    for name, value in given.items():
        if live is None and value is not None:
            raise InputError(f"{name} is an option of --live")
    if idle is not None and not 0.0 < idle < math.inf:
        raise InputError(f"--idle {idle:g}: a number of seconds above zero is needed")
    files = listed(recordings or [], reference)

    from hydrolek_drake.rigs import load_rig

    loaded = load_rig(rig, parse_settings(set_))
    output = console()

    from hydrolek_drake.watching.limits import limits_of

    limits = limits_of(limit or [], loaded)
    for path in reference:
        if not path.exists():
            raise InputError(f"reference {path}: no such file")

    from hydrolek_drake.watching.alarms import AlarmRule

    if live is not None:
        from hydrolek_drake.cli.diagnosis.watch_live import watch_live
        from hydrolek_drake.watching.live.running import Options

        rule = AlarmRule(false_alarms)
        options = Options(live, out, drifts, rule, PAGE_PORT if port is None else port, foxglove, token, idle)
        if watch_live(loaded, reference, options, limits):
            raise typer.Exit(ALARM)
        return
    from hydrolek_drake.watching.results import write_watch
    from hydrolek_drake.watching.watch import watch as run_watch
    from hydrolek_drake.watching.words import sentences

    with progress("starting") as tell, _cluster(cluster) as jobs:
        watched = run_watch(
            loaded,
            reference,
            files,
            folder=out,
            drift=drifts,
            changes=tuple(changes or ()),
            rule=AlarmRule(false_alarms),
            cores=workers,
            cluster=jobs,
            say=lambda text: tell(f"{text} ..."),
        )
        told = sentences(watched, limits)
        written = [] if out is None else write_watch(watched, out, limits)
    for line in told:
        output.print(line, markup=False, soft_wrap=True)
    if written:
        output.print(f"\npage: {written[-1]}", markup=False, soft_wrap=True)
    if watched.alarm is not None:
        raise typer.Exit(ALARM)


def _drift(text: str) -> tuple[str, float]:
    """Name, or nothing for all, and drift."""
    name, _, number = text.rpartition("=")
    try:
        share = float(number)
    except ValueError:
        share = -1.0
    if not 0.0 <= share < 10.0:
        raise InputError(f"--drift {text}: write a share of the range such as 0.02, or NAME=SHARE")
    return name.strip(), share
