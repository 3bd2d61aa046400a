"""Starts the full hydraulic plant beside the console and ends it with the console."""

import contextlib
import json
import select
import subprocess
import sys
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.access import new_token
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.workcell.pipe import Pipe
from hydrolek_drake.workcell.table import Table

_GOODBYE = 5.0  # s that the process may take to end


class PlantProcess:
    """A process of its own that simulates both arms in real time and listens as the controllers' end of the link.

    It does not share the console's interpreter, so that pictures and path planning do not hold up the valves.

    Args:
        posture: Joints `right_j1` ... `left_j7` at first, in rad, shape (14,).
        controller: Name in the catalogue of controllers.
        rig: The machine, a name or a file.
        settings: Parameters of the rig, as `--set` takes them.
        seed: Of the sensors' noise.
        pipe: What the grippers may touch, and the browser view shows.
        table: What the pipe stands on, if it is loose.
        meshcat: Whether Drake's browser view is served.
        host: Address at which it is.
        realtime_rate: Simulated seconds a second.

    Attributes:
        port: Of the link, on this machine.
        token: What the link asks for.
        view_port: Of the browser view, or None.

    Raises:
        InputError: What the plant says is wrong with these, or that it does not start.
    """

    def __init__(
        self,
        posture: ArrayLike,
        *,
        controller: str = "feedforward",
        rig: str = "hydrolek",
        settings: Mapping[str, str] | None = None,
        seed: int = 1,
        pipe: Pipe | None = None,
        table: Table | None = None,
        meshcat: bool = False,
        host: str = "127.0.0.1",
        realtime_rate: float = 1.0,
    ) -> None:
        self.token = new_token()
        content = {
            "token": self.token,
            "posture_deg": np.degrees(np.asarray(posture, dtype=float)).tolist(),
            "controller": controller,
            "rig": rig,
            "settings": dict(settings or {}),
            "seed": seed,
            "pipe": None
            if pipe is None
            else {
                "point": pipe.point.tolist(),
                "axis": pipe.axis.tolist(),
                "radius": pipe.radius,
                "length": pipe.length,
            },
            "table": None
            if table is None
            else {"top": table.top.tolist(), "size": table.size.tolist(), "thickness": table.thickness},
            "meshcat": meshcat,
            "host": host,
            "realtime_rate": realtime_rate,
        }
        self._process = subprocess.Popen(
            [sys.executable, "-m", "hydrolek_drake.teleop.controllers.plant_server"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        try:
            assert (
                self._process.stdin is not None
            )  # it is a pipe; not an argument, which every user could read
            with contextlib.suppress(BrokenPipeError):  # told below
                self._process.stdin.write(json.dumps(content).encode() + b"\n")
                self._process.stdin.flush()
            answer = self._first_line()
        except BaseException:
            self.close()
            raise
        self.port: int = answer["port"]
        self.view_port: int | None = answer["view"]

    def running(self) -> bool:
        """Whether the process lives."""
        return self._process.poll() is None

    def close(self) -> None:
        """End the process; its valves close with the link."""
        process = self._process
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                with contextlib.suppress(BrokenPipeError):  # it ended before it had read its settings
                    stream.close()
        try:
            process.wait(_GOODBYE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def _first_line(self) -> dict[str, Any]:
        patience, output = teleop_entries("plant")["start"], self._process.stdout
        assert output is not None  # it is a pipe
        if not select.select([output], [], [], patience)[0]:
            raise InputError(f"teleop: the hydraulic plant did not start within {patience:g} s")
        line = output.readline()
        try:
            answer = json.loads(line)
        except ValueError:
            raise InputError(
                "teleop: the hydraulic plant broke down at its start; its last words are above"
            ) from None
        if "error" in answer:
            raise InputError(answer["error"])
        return dict(answer)
