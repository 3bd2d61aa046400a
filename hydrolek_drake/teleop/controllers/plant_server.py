"""The controllers' end with the full hydraulic plant: a process of its own that keeps to the clock.

Started by `plant_process.PlantProcess`, which writes the settings as a line of JSON to its standard input. Writes one
line of JSON when it is ready, or what is wrong, and ends when its standard input is closed, that is with the console.
"""

import gc
import json
import logging
import signal
import sys
import threading
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Box, Cylinder, Meshcat, MeshcatParams, Rgba
from pydrake.math import RigidTransform, RotationMatrix

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.teleop.controllers.hydraulic_arms import HydraulicArms
from hydrolek_drake.teleop.controllers.hydraulic_end import HydraulicEnd
from hydrolek_drake.teleop.controllers.serving import Pacer, serve_arms
from hydrolek_drake.teleop.link.server import SetpointServer
from hydrolek_drake.visualization.station_view import StationView
from hydrolek_drake.workcell.pipe import Pipe, make_pipe, workcell_entries
from hydrolek_drake.workcell.table import Table

Array = NDArray[np.float64]


def serve(settings: dict[str, Any]) -> None:
    """Build the plant, announce its port, and simulate until standard input ends.

    Args:
        settings: As `PlantProcess` writes them.

    Raises:
        InputError: Something in the settings is wrong.
    """
    posture = np.radians(settings["posture_deg"])
    meshcat = (
        Meshcat(MeshcatParams(host=settings["host"], show_stats_plot=False)) if settings["meshcat"] else None
    )
    view = None if meshcat is None else StationView(meshcat)
    pipe = None if settings["pipe"] is None else make_pipe(**settings["pipe"])
    table = None if settings["table"] is None else _table(settings["table"])
    if meshcat is not None and pipe is not None:
        show_pipe(meshcat, pipe, table)
    arms = HydraulicArms(
        posture,
        rig=load_rig(settings["rig"], settings["settings"]),
        controller=settings["controller"],
        seed=settings["seed"],
        pipe=pipe,
        table=table,
        visualize=None if view is None else view.add,
    )
    if meshcat is not None:
        near = workcell_entries()["view"]  # nearer than the whole machine, which the view shows otherwise
        meshcat.SetCameraPose(np.array(near["eye"]), np.array(near["target"]))
    end = HydraulicEnd(arms)
    server = SetpointServer(posture, port=0, realtime_rate=settings["realtime_rate"], token=settings["token"])
    arms.advance()  # compiles what is not yet compiled
    server.report(end.measured(), end.signals())
    print(json.dumps({"port": server.port, "view": meshcat.port() if meshcat else None}), flush=True)
    ended = threading.Event()
    threading.Thread(target=_until_input_ends, args=(ended,), daemon=True).start()
    gc.freeze()  # what exists now stays; collections then take no time
    pacer = Pacer(server, end.period, settings["realtime_rate"])

    def follow() -> None:
        if meshcat is not None and pipe is not None and table is not None:
            put_pipe(meshcat, pipe.at(arms.pipe_place()))

    serve_arms(end, server, wait=pacer.wait, pace=pacer.pace, ended=ended, after=follow)


def show_pipe(meshcat: Meshcat, pipe: Pipe, table: Table | None) -> None:
    """The pipe in the browser view, and what it stands on."""
    colour = workcell_entries()["pipe"]["colour"]
    meshcat.SetObject("/pipe", Cylinder(pipe.radius, pipe.length), Rgba(*colour, 1.0))
    put_pipe(meshcat, pipe)
    if table is not None:
        board = Box(*table.size, table.thickness)
        meshcat.SetObject("/table", board, Rgba(*workcell_entries()["table"]["colour"], 1.0))
        meshcat.SetTransform("/table", RigidTransform(table.top - [0.0, 0.0, 0.5 * table.thickness]))


def put_pipe(meshcat: Meshcat, pipe: Pipe) -> None:
    """Where the pipe is now."""
    meshcat.SetTransform("/pipe", RigidTransform(RotationMatrix(pipe.rotation()), pipe.point))


def _table(sizes: dict[str, Any]) -> Table:
    return Table(np.array(sizes["top"]), np.array(sizes["size"]), float(sizes["thickness"]))


def _until_input_ends(ended: threading.Event) -> None:
    while sys.stdin.readline():
        pass
    ended.set()


def main() -> int:
    """Run with the settings of standard input's first line."""
    logging.getLogger("drake").setLevel(logging.WARNING)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the console's, which then closes our input
    try:
        serve(json.loads(sys.stdin.readline()))
    except InputError as error:
        print(json.dumps({"error": str(error)}), flush=True)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
