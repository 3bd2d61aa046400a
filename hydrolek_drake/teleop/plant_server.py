"""The controllers' end with the full hydraulic plant: a process of its own that keeps to the clock.

Started by `plant_process.PlantProcess` with its settings as one JSON argument. Writes one line of JSON when it is
ready, or what is wrong, and ends when its standard input is closed, that is with the console.
"""

import gc
import json
import logging
import signal
import sys
import threading
import time
from dataclasses import replace
from typing import Any

import numpy as np
from pydrake.geometry import Box, Cylinder, Meshcat, MeshcatParams, Rgba
from pydrake.math import RigidTransform, RotationMatrix

from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.hydraulic_arms import HydraulicArms
from hydrolek_drake.teleop.link import SetpointServer
from hydrolek_drake.visualization.station_view import StationView
from hydrolek_drake.workcell.pipe import Pipe, make_pipe, workcell_entries
from hydrolek_drake.workcell.table import Table

_PACE_WINDOW = 20  # samples over which the pace is measured


class Pacer:
    """Keeps a plant to the clock, one sample for each message while messages come.

    A controller that took a sample without a new set point would see the machine's target stand still and then jump.
    On a busy computer the plant therefore waits for a message that is late, for `plant.patience`; without a client it
    does not.

    Args:
        server: Whose messages are waited for.
        realtime_rate: Simulated seconds a second.
    """

    def __init__(self, server: SetpointServer, realtime_rate: float) -> None:
        self._server, self._period = server, sample_s() / realtime_rate
        entries = teleop_entries("plant")
        self._lead, self._lag = entries["lead"] / realtime_rate, entries["lag"] / realtime_rate
        self._patience, self._followed = entries["patience"] / realtime_rate, False
        self._due = time.monotonic()
        self._began = [self._due]

    def wait(self) -> None:
        """Return when the next sample is to be simulated: at a message, or when none comes in time."""
        late = self._due + (self._patience if self._followed else 0.5 * self._period)
        self._followed = self._server.message_came.wait(timeout=max(0.0, late - time.monotonic()))
        self._server.message_came.clear()
        time.sleep(max(0.0, self._due - self._lead - time.monotonic()))
        now = time.monotonic()
        self._due = max(self._due + self._period, now - self._lag)
        self._began = [*self._began[-_PACE_WINDOW:], now]

    def pace(self) -> float:
        """Simulated seconds a second over the last samples."""
        took = self._began[-1] - self._began[0]
        return (len(self._began) - 1) * sample_s() / took if took > 0.0 else 1.0


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
    server = SetpointServer(posture, port=0, realtime_rate=settings["realtime_rate"])
    arms.advance()  # compiles what is not yet compiled
    server.report(arms.measured(), arms.signals())
    print(json.dumps({"port": server.port, "view": meshcat.port() if meshcat else None}), flush=True)
    ended = threading.Event()
    threading.Thread(target=_until_input_ends, args=(ended,), daemon=True).start()
    gc.freeze()  # what exists now stays; collections then take no time
    pacer = Pacer(server, settings["realtime_rate"])
    try:
        while not ended.is_set():
            pacer.wait()
            order = server.order()
            if not order.valves_open:
                arms.advance()
            elif order.deflection is not None:
                arms.advance(deflection=order.deflection)
            else:
                arms.advance(order.desired)
            signals = replace(arms.signals(), pace=pacer.pace())
            server.report(arms.measured(), signals)
            if meshcat is not None and pipe is not None and table is not None:
                put_pipe(meshcat, pipe.at(signals.pipe_place))
    finally:
        server.close()


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
    """Run with the settings of the first argument."""
    logging.getLogger("drake").setLevel(logging.WARNING)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the console's, which then closes our input
    try:
        serve(json.loads(sys.argv[1]))
    except InputError as error:
        print(json.dumps({"error": str(error)}), flush=True)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
