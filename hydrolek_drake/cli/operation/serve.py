"""`hydrolek serve`: the controllers' end of the link, with the simulated machine or a user's own behind it."""

from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.cli.settings import SetOption, parse_settings
from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from hydrolek_drake.rigs import Rig
    from hydrolek_drake.teleop.controllers.adapter import Arms


def serve(
    port: Annotated[int | None, typer.Option(min=0, max=65535, help="of the link; 6340 if not given")] = None,
    host: Annotated[str, typer.Option(help="address to listen at")] = "127.0.0.1",
    token: Annotated[
        str | None,
        typer.Option(
            envvar="HYDROLEK_LINK_TOKEN",
            help="what a client must send first; on a network a new one is made if none is given (better by the "
            "variable)",
        ),
    ] = None,
    adapter: Annotated[
        str | None,
        typer.Option(metavar="MODULE:NAME|FILE.py:NAME", help="your own machine in place of a simulated one"),
    ] = None,
    plant: Annotated[
        str, typer.Option(help="full: both arms with their hydraulics; simple: a stand-in without any")
    ] = "full",
    rig: Annotated[str, typer.Option(help="of the full plant, a name or a file")] = "hydrolek",
    controller: Annotated[
        str, typer.Option(help="of the full plant, a name of `hydrolek control bench`")
    ] = "feedforward",
    settings: SetOption = None,
    seed: Annotated[int, typer.Option(min=0, help="of the sensors' noise")] = 1,
) -> None:
    """Serve the controllers' end of the link until Ctrl-C: set points in, measured joints out.

    Whatever ends it closes the valves.
    """
    import logging
    import signal
    import threading

    from hydrolek_drake.cli.output import console as output
    from hydrolek_drake.teleop.access import SHORTEST_TOKEN, is_loopback, new_token

    logging.getLogger("drake").setLevel(logging.WARNING)
    if plant not in ("full", "simple"):
        raise InputError(f"serve: --plant {plant} is unknown; choose full or simple")
    if token is not None and (len(token) < SHORTEST_TOKEN or not token.isascii() or len(token.split()) != 1):
        raise InputError(f"serve: --token must be one word of at least {SHORTEST_TOKEN} plain characters")
    if settings and (plant == "simple" or adapter is not None):
        raise InputError("serve: --set is the full plant's; leave it out")
    if token is None and not is_loopback(host):
        token = new_token()
    parsed = parse_settings(settings)
    machine_rig = None
    if adapter is None and plant == "full":
        from hydrolek_drake.rigs import load_rig

        machine_rig = load_rig(rig, parsed)

    for each in (signal.SIGTERM, signal.SIGINT):  # a service manager's stop closes the valves, too
        signal.signal(each, _interrupt)

    from hydrolek_drake.teleop.controllers.adapter import load_adapter
    from hydrolek_drake.teleop.controllers.serving import Clock, Pacer, serve_arms
    from hydrolek_drake.teleop.link.server import SetpointServer

    arms = None if adapter is None else load_adapter(adapter)
    if arms is None:
        with output().status("starting the plant"):
            arms = _simulated(machine_rig, controller, seed)
    try:
        server = SetpointServer(arms.measured(), port=port, host=host, token=token)
    except BaseException:
        arms.close()
        raise
    output().print(
        f"the link listens at {host}:{server.port}; Ctrl-C closes the valves and ends it",
        markup=False,
        soft_wrap=True,
    )
    if token is not None:
        output().print(f"its clients send TOKEN {token}", markup=False, soft_wrap=True)
    pacer = None if adapter is not None else Pacer(server, arms.period, 1.0)
    serve_arms(
        arms,
        server,
        wait=Clock(arms.period).wait if pacer is None else pacer.wait,
        pace=None if pacer is None else pacer.pace,
        ended=threading.Event(),
    )


def _interrupt(*_: object) -> None:
    """End it, once: a second signal must not keep the valves from being closed."""
    import signal

    for each in (signal.SIGTERM, signal.SIGINT):
        signal.signal(each, signal.SIG_IGN)
    raise KeyboardInterrupt


def _simulated(rig: "Rig | None", controller: str, seed: int) -> "Arms":
    from hydrolek_drake.workcell.scene import home_posture

    if rig is None:
        from hydrolek_drake.teleop.controllers.arms_end import SimpleArms

        return SimpleArms(home_posture())
    from hydrolek_drake.teleop.controllers.hydraulic_arms import HydraulicArms
    from hydrolek_drake.teleop.controllers.hydraulic_end import HydraulicEnd

    return HydraulicEnd(HydraulicArms(home_posture(), rig=rig, controller=controller, seed=seed))
