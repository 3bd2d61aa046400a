"""`hydrolek teleop`: the operator's console in the browser."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.cli.settings import SetOption, parse_settings
from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from hydrolek_drake.teleop.machine import Machine
    from hydrolek_drake.teleop.session import OperatorSession
    from hydrolek_drake.workcell.pipe import Pipe
    from hydrolek_drake.workcell.table import Table

_Vector = tuple[float, float, float]


def teleop(
    port: Annotated[int, typer.Option(min=0, max=65535, help="of the page; 0 for any free one")] = 8080,
    camera: Annotated[
        str,
        typer.Option(help="sim, live (OpenNI), realsense, a recording of one (.db3), or a folder of frames"),
    ] = "sim",
    host: Annotated[str, typer.Option(help="address to serve the page at")] = "127.0.0.1",
    allow_host: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="further name under which the page is reached; repeatable"),
    ] = None,
    token: Annotated[
        str | None,
        typer.Option(
            envvar="HYDROLEK_TOKEN",
            help="what control of the page needs; a new one each time if not given (better by the variable)",
        ),
    ] = None,
    controllers: Annotated[
        str | None,
        typer.Option(metavar="HOST:PORT", help="controllers' end of the link; simulated if not given"),
    ] = None,
    link_token: Annotated[
        str | None,
        typer.Option(
            envvar="HYDROLEK_LINK_TOKEN",
            help="of the controllers' end, if it asks for one (see `hydrolek serve`)",
        ),
    ] = None,
    plant: Annotated[
        str, typer.Option(help="full: both arms with their hydraulics; simple: a stand-in without any")
    ] = "full",
    controller: Annotated[
        str, typer.Option(help="of the full plant, a name of `hydrolek control bench`")
    ] = "feedforward",
    settings: SetOption = None,
    view: Annotated[
        bool | None,
        typer.Option(
            "--view/--no-view",
            help="Drake's 3-D view of the full plant beside the pictures; it knows no token, so that it is shown by "
            "itself only to this machine",
        ),
    ] = None,
    pipe_point: Annotated[
        _Vector | None, typer.Option(metavar="X Y Z", help="simulated pipe, world, m")
    ] = None,
    pipe_axis: Annotated[
        _Vector | None, typer.Option(metavar="X Y Z", help="simulated pipe's axis, world")
    ] = None,
    stand: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="stand.json of `hydrolek stand --out`: the simulated pipe as its best place has it",
        ),
    ] = None,
    loose: Annotated[
        bool, typer.Option("--loose", help="simulated pipe stands loose on a table, for pick and place")
    ] = False,
    light: Annotated[float, typer.Option(min=0.0, max=1.0, help="of the simulated room")] = 1.0,
    flip: Annotated[bool, typer.Option(help="mirror a live camera's pictures back")] = False,
    out: Annotated[
        Path | None, typer.Option(help="folder for trials.csv: times and NASA-TLX ratings")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="of camera, sensors and path planner")] = 1,
) -> None:
    """Serve the console: pictures, four clicks, confirmation, progress, stop, charts, joystick."""
    import asyncio
    import logging

    from hydrolek_drake.cli.output import console as output
    from hydrolek_drake.teleop.access import SHORTEST_TOKEN, is_loopback, page_address
    from hydrolek_drake.teleop.trial import TrialLog

    logging.getLogger("drake").setLevel(logging.WARNING)
    if plant not in ("full", "simple"):
        raise InputError(f"teleop: --plant {plant} is unknown; choose full or simple")
    address, trials = _address(controllers), TrialLog(out)
    if token is not None and len(token) < SHORTEST_TOKEN:
        raise InputError(
            f"teleop: --token has {len(token)} characters; take at least {SHORTEST_TOKEN}, or leave it out"
        )
    if link_token is not None and address is None:
        raise InputError("teleop: --link-token belongs to --controllers HOST:PORT; leave it out")
    if settings and (plant == "simple" or address is not None):
        raise InputError("teleop: --set is the full plant's; leave it out")
    place = None
    if stand is not None:
        if camera != "sim" or loose or pipe_point is not None or pipe_axis is not None:
            raise InputError(
                "teleop: --stand says where the simulated camera's pipe is; leave the others out"
            )
        from hydrolek_drake.standing.place_file import read_place

        place = read_place(stand)
    _check_camera(camera, pipe_point, pipe_axis, loose)

    from hydrolek_drake.teleop.console.server import Console
    from hydrolek_drake.teleop.controllers.plant_process import PlantProcess
    from hydrolek_drake.teleop.machine import Machine
    from hydrolek_drake.workcell.pipe import make_pipe
    from hydrolek_drake.workcell.scene import home_posture
    from hydrolek_drake.workcell.table import make_loose_pipe, make_table

    table = make_table() if loose else None
    pipe = None
    if camera == "sim":
        pipe = make_pipe(pipe_point, pipe_axis) if table is None else make_loose_pipe(table)
        if place is not None:
            pipe = place[0].pipe_seen(place[1])
    process = None
    if plant == "full" and address is None:
        with output().status("starting the hydraulic plant: step tests of all joints"):
            process = PlantProcess(
                home_posture(),
                controller=controller,
                settings=parse_settings(settings),
                seed=seed,
                pipe=pipe,
                table=table,
                meshcat=is_loopback(host) if view is None else view,
                host=host,
            )
    machine = Machine(
        home_posture(),
        controllers=address,
        token=link_token,
        plant=process,
        pipe=None if table is None else pipe,
        table=table,
    )
    try:
        session = _session(camera, machine, pipe, table, light, flip, seed)
    except BaseException:
        machine.close()
        raise

    async def serve() -> None:
        console = Console(
            session,
            port=port,
            host=host,
            allowed_hosts=tuple(allow_host or ()),
            token=token,
            view_port=None if process is None else process.view_port,
            trials=trials,
        )
        try:
            output().print(
                f"open {page_address(host, console.port, console.token)} in a browser; Ctrl-C ends it",
                markup=False,
                soft_wrap=True,
            )
            if not is_loopback(host):
                output().print(
                    "from other machines: by this machine's address, or a name given by --allow-host; "
                    "docs/guides/teleop.md says what is protected, and how to add TLS",
                    markup=False,
                    soft_wrap=True,
                )
            await console.run()
        finally:
            console.close()

    try:
        asyncio.run(serve())
    finally:
        machine.close()
        session.close()


def _session(
    camera: str,
    machine: "Machine",
    pipe: "Pipe | None",
    table: "Table | None",
    light: float,
    flip: bool,
    seed: int,
) -> "OperatorSession":
    import numpy as np

    from hydrolek_drake.teleop.session import OperatorSession
    from hydrolek_drake.vision.sources import camera_source

    if camera == "sim":
        from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect, as_machine_stands

        return OperatorSession(
            lambda: SimulatedKinect(pipe, np.random.default_rng(seed), brightness=light, table=table),
            machine,
            seed=seed,
            stand=as_machine_stands,
        )
    return OperatorSession(lambda: camera_source(camera, flipped=flip), machine, seed=seed)


def _check_camera(camera: str, point: _Vector | None, axis: _Vector | None, loose: bool) -> None:
    """Refuse what would be refused only after the plant has been started."""
    from hydrolek_drake.vision.sources import camera_source

    if camera != "sim" and (point is not None or axis is not None):
        raise InputError("teleop: --pipe-point and --pipe-axis are the simulated camera's; leave them out")
    if loose and (camera != "sim" or point is not None or axis is not None):
        raise InputError(
            "teleop: --loose puts the simulated camera's pipe on the table; leave the others out"
        )
    if camera != "sim":
        camera_source(camera).close()


def _address(text: str | None) -> tuple[str, int] | None:
    if text is None:
        return None
    host, colon, port = text.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    if not (colon and host and port.isdecimal() and len(port) < 6 and 0 < int(port) < 65536):
        raise InputError(f"teleop: --controllers {text} is no HOST:PORT, such as 192.168.0.5:6340")
    return host, int(port)
