"""`hydrolek simulate`: run a scenario on its Drake diagram."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.cli.settings import parse_settings
from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from hydrolek_drake.runs.running import ScenarioRun
    from hydrolek_drake.scenarios.scenario import Scenario
    from hydrolek_drake.visualization.station_view import StationView

_INTERRUPTED = 130


def simulate(
    scenario: Annotated[
        str | None,
        typer.Argument(metavar="SCENARIO", help="name of a scenario in diagrams, or a scenario file"),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="PATH=VALUE",
            help="of the scenario: 'scenario.duration=5 s'; or of its rig: 'supply.pressure=12 MPa'",
        ),
    ] = None,
    meshcat: Annotated[
        bool,
        typer.Option("--meshcat", help="show it in the browser in real time, and stay until Ctrl-C"),
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="folder for signals, plots, page and 3-D replay"),
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="of random commands and sensor noise")] = None,
) -> int:
    """Build the diagram that a scenario names and run it."""
    from rich.console import Console

    from hydrolek_drake.cli.output import console
    from hydrolek_drake.scenarios.scenario import load_scenario, scenario_files

    if scenario is None:
        raise InputError(f"simulate: name a scenario: {', '.join(scenario_files())}; or give a file")
    output, progress = console(), Console(stderr=True)
    loaded = load_scenario(scenario, parse_settings(set_))

    from hydrolek_drake.runs.report import prepare_folder, write_run
    from hydrolek_drake.runs.summary import sentence, summarize
    from hydrolek_drake.runs.table import joint_table

    if out is not None:
        prepare_folder(out)
    view = _view(output, meshcat) if meshcat or out is not None else None
    done = _run(loaded, seed, view, meshcat, progress)
    if len(done.run.time) < 2:
        return _INTERRUPTED
    joints = summarize(done)
    page = None
    if out is not None:  # before anything is printed: a reader such as `head` may close the pipe
        with progress.status("writing the report"):
            page = write_run(done, joints, out, None if view is None else view.static_html())
    output.print(sentence(done, joints), markup=False, soft_wrap=True)
    output.print()
    output.print(joint_table(joints))
    if page is not None:
        output.print(f"\nreport: {page}", markup=False, soft_wrap=True)
    if done.run.interrupted:
        return _INTERRUPTED
    if meshcat:
        _stay(output)
    return 0


def _view(output: "Console", served: bool) -> "StationView":
    import logging

    from pydrake.geometry import Meshcat, MeshcatParams

    from hydrolek_drake.visualization.station_view import StationView

    logging.getLogger("drake").setLevel(logging.WARNING)  # it would announce the view that only writes a file
    view = StationView(Meshcat(MeshcatParams(host="localhost", show_stats_plot=served)))
    if served:
        output.print(
            f"open {view.meshcat.web_url()} in a browser on this machine", markup=False, soft_wrap=True
        )
    return view


def _run(
    loaded: "Scenario", seed: int | None, view: "StationView | None", live: bool, progress: "Console"
) -> "ScenarioRun":
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from hydrolek_drake.runs.running import run_scenario

    with Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.1f} of {task.total:.1f} s"),
        TimeRemainingColumn(),
        console=progress,
        transient=True,
    ) as bar:
        task = bar.add_task(
            f"{loaded.name} (the first time, the physics is compiled: some 10 s)", total=loaded.duration
        )
        return run_scenario(
            loaded,
            seed=seed,
            view=view,
            realtime_rate=1.0 if live else 0.0,
            on_progress=lambda time: bar.update(task, completed=time, description=loaded.name),
        )


def _stay(output: "Console") -> None:
    import time

    output.print("the view stays open, with a time slider, until Ctrl-C", soft_wrap=True)
    try:
        while True:
            time.sleep(1.0)
    except KeyboardInterrupt:
        return
