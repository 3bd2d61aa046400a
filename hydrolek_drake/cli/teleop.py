"""`hydrolek teleop`: the operator's console in the browser."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from hydrolek_drake.teleop.machine import Machine
    from hydrolek_drake.teleop.session import OperatorSession

_Vector = tuple[float, float, float]


def teleop(
    port: Annotated[int, typer.Option(min=0, max=65535, help="of the page; 0 for any free one")] = 8080,
    camera: Annotated[str, typer.Option(help="sim, live, or a folder of frames")] = "sim",
    host: Annotated[str, typer.Option(help="address to serve the page at")] = "127.0.0.1",
    controllers: Annotated[
        str | None,
        typer.Option(metavar="HOST:PORT", help="controllers' end of the link; simulated if not given"),
    ] = None,
    pipe_point: Annotated[
        _Vector | None, typer.Option(metavar="X Y Z", help="simulated pipe, world, m")
    ] = None,
    pipe_axis: Annotated[
        _Vector | None, typer.Option(metavar="X Y Z", help="simulated pipe's axis, world")
    ] = None,
    light: Annotated[float, typer.Option(min=0.0, max=1.0, help="of the simulated room")] = 1.0,
    flip: Annotated[bool, typer.Option(help="mirror a live camera's pictures back")] = False,
    seed: Annotated[int, typer.Option(min=0, help="of the camera's noise and the path planner")] = 1,
) -> None:
    """Serve the console: picture and edges, four clicks, confirmation, progress, stop."""
    import asyncio
    import logging

    from hydrolek_drake.cli.output import console as output
    from hydrolek_drake.teleop.console import Console
    from hydrolek_drake.teleop.machine import Machine
    from hydrolek_drake.workcell.scene import home_posture

    logging.getLogger("drake").setLevel(logging.WARNING)
    machine = Machine(home_posture(), controllers=_address(controllers))
    try:
        session = _session(camera, machine, pipe_point, pipe_axis, light, flip, seed)
    except BaseException:
        machine.close()
        raise

    async def serve() -> None:
        console = Console(session, port=port, host=host)
        try:
            output().print(
                f"open http://{host}:{console.port} in a browser; Ctrl-C ends it",
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
    point: _Vector | None,
    axis: _Vector | None,
    light: float,
    flip: bool,
    seed: int,
) -> "OperatorSession":
    import numpy as np

    from hydrolek_drake.teleop.session import OperatorSession
    from hydrolek_drake.vision.frames import FolderSource, LiveCamera

    if camera == "sim":
        from hydrolek_drake.workcell.pipe import make_pipe
        from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect

        pipe = make_pipe(point, axis)
        return OperatorSession(
            lambda: SimulatedKinect(pipe, np.random.default_rng(seed), brightness=light),
            machine,
            seed=seed,
            stand=lambda source, angles: source.stand(angles),  # type: ignore[attr-defined]
        )
    if point is not None or axis is not None:
        raise InputError("teleop: --pipe-point and --pipe-axis are the simulated camera's; leave them out")
    if camera == "live":
        return OperatorSession(lambda: LiveCamera(flipped=flip), machine, seed=seed)
    return OperatorSession(lambda: FolderSource(Path(camera)), machine, seed=seed)


def _address(text: str | None) -> tuple[str, int] | None:
    if text is None:
        return None
    host, colon, port = text.rpartition(":")
    if not (colon and host and port.isdigit()):
        raise InputError(f"teleop: --controllers {text} is no HOST:PORT, such as 192.168.0.5:6340")
    return host, int(port)
