"""Somebody else's unit: what it shows, and what it does under commands, found in a process of its own."""

import contextlib
import importlib.util
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.fmu import child
from hydrolek_drake.fmu.exporting import EXTRA

AT_MOST_S = 300.0
"""How long a unit may take unless told otherwise."""

DESCRIBING_S = 60.0
"""How long its description may take to read, which takes a second."""


@dataclass(frozen=True)
class Shown:
    """A variable of a unit.

    Attributes:
        name: as the unit has it.
        unit: that it states, or "".
        causality: input, output, parameter, local ...
        number: whether it is a single real number.
        start: value before anything is given, or "".
        description: for people.
    """

    name: str
    unit: str
    causality: str
    number: bool
    start: str
    description: str


@dataclass(frozen=True)
class Unit:
    """What a unit says about itself.

    Attributes:
        path: of its file.
        fmi: version.
        name: of the model.
        tool: that made it.
        platforms: that it is built for.
        step_size: that it suggests [s]; None if it does not.
        variables: by name.
    """

    path: Path
    fmi: str
    name: str
    tool: str
    platforms: tuple[str, ...]
    step_size: float | None
    variables: dict[str, Shown]


def read_unit(path: Path) -> Unit:
    """What a unit says about itself; nothing of it runs.

    Raises:
        InputError: it is missing, damaged, of another version of FMI, or not for co-simulation.
    """
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        _ask(folder, path, {"task": "describe"}, DESCRIBING_S)
        told = json.loads((folder / child.DESCRIBED).read_text())
    variables = {each["name"]: Shown(**each) for each in told.pop("variables")}
    platforms = tuple(told.pop("platforms"))
    step = told.pop("step_size")
    return Unit(
        path,
        step_size=None if step is None else float(step),
        platforms=platforms,
        variables=variables,
        **told,
    )


def play(
    unit: Unit,
    commands: Mapping[str, np.ndarray],
    outputs: Sequence[str],
    step: float,
    *,
    start: Mapping[str, float] | None = None,
    at_most: float = AT_MOST_S,
) -> dict[str, np.ndarray]:
    """Run a unit through commands, from time 0 on.

    Args:
        unit: it.
        commands: variable -> values, each held over a step. # (n,) each
        outputs: variables that are wanted.
        step: communication step [s].
        start: variable -> value before it begins.
        at_most: time limit [s].

    Returns:
        Values of the outputs at the beginning of each step. # (n,) each

    Raises:
        InputError: it crashes, hangs, says that it failed, or is built for other platforms.
    """
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        np.save(folder / child.COMMANDS, np.array(list(commands.values()), dtype=float).T)
        asked = {
            "task": "play",
            "inputs": list(commands),
            "outputs": list(outputs),
            "step": step,
            "start": dict(start or {}),
        }
        _ask(folder, unit.path, asked, at_most)
        done = np.load(folder / child.PLAYED, allow_pickle=False)
    return {name: done[:, place] for place, name in enumerate(outputs)}


def _ask(folder: Path, path: Path, asked: dict[str, Any], at_most: float) -> None:
    """Let a process of its own answer; what it leaves running when the time is up is ended with it."""
    if importlib.util.find_spec("fmpy") is None:
        raise InputError(f"FMUs are run by a package that is not installed: pip install '{EXTRA}'")
    if not path.is_file():
        raise InputError(f"{path} does not exist" if not path.exists() else f"{path} is no file")
    (folder / child.ASKED).write_text(json.dumps({**asked, "unit": str(path.absolute())}))
    unpacked = folder / "unpacked"
    unpacked.mkdir()
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(place or os.getcwd() for place in sys.path),
        "PYTHONSAFEPATH": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "TMPDIR": str(unpacked),
    }
    with (folder / "printed").open("wb") as printed:
        process = subprocess.Popen(
            [sys.executable, "-m", "hydrolek_drake.fmu.child", str(folder)],
            stdin=subprocess.DEVNULL,
            stdout=printed,
            stderr=subprocess.STDOUT,
            env=environment,
            start_new_session=True,
        )
        try:
            status = process.wait(at_most)
        except subprocess.TimeoutExpired:
            raise InputError(
                f"{path}: it did not end within {at_most:g} s and was ended; --at-most gives it longer"
            ) from None
        finally:
            _end(process)
    if status == child.REFUSED:
        raise InputError(f"{path}: {(folder / child.SAID).read_text()}")
    if status != 0:
        raise InputError(f"{path}: it crashed ({_how(status)})")


def _end(process: "subprocess.Popen[bytes]") -> None:
    with contextlib.suppress(OSError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _how(status: int) -> str:
    with contextlib.suppress(ValueError):
        return signal.Signals(-status).name
    return f"exit status {status}"
