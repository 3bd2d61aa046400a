"""The process in which somebody else's unit runs: it may crash or hang, and then only that ends.

The command line has a folder with what is asked, `asked.json`; the answer is put there. Whatever the unit prints is
caught by the parent.
"""

import contextlib
import json
import resource
import sys
import zipfile
from collections import deque
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

REFUSED = 3
"""Exit status where `SAID` tells in one line what is wrong with the unit."""

ASKED, COMMANDS, SAID, DESCRIBED, PLAYED = (
    "asked.json",
    "commands.npy",
    "said.txt",
    "described.json",
    "played.npy",
)

MEMORY, WRITTEN = 16_000_000_000, 4_000_000_000
"""Bytes of addresses, and of each file that it writes: units may hold whole simulators."""

_FLOATS = ("Real", "Float32", "Float64")
_ERROR = 3
"""The least status of FMI that is a failure."""


class Refused(Exception):
    """What is wrong with a unit."""


def main() -> None:
    """Describe a unit, or run it."""
    folder = Path(sys.argv[1])
    asked = json.loads((folder / ASKED).read_text())
    for kind, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_FSIZE, WRITTEN)):
        _, hard = resource.getrlimit(kind)
        with contextlib.suppress(ValueError, OSError):  # not every system has every limit
            resource.setrlimit(kind, (most if hard < 0 else min(most, hard), hard))
    try:
        description = _described(asked["unit"])
        if asked["task"] == "play":
            _play(asked, description, folder)
        else:
            (folder / DESCRIBED).write_text(json.dumps(_told(asked["unit"], description)))
    except Refused as refusal:
        _refuse(folder, str(refusal))
    except Exception as error:  # a parser met with bytes that nobody foresaw, or a unit that says it failed
        _refuse(folder, str(error) or type(error).__name__)


def _refuse(folder: Path, why: str) -> None:
    (folder / SAID).write_text(" ".join(why.split())[:300])
    sys.exit(REFUSED)


def _described(unit: str) -> Any:
    """What the unit says about itself, if it can take a machine's place."""
    from fmpy import read_model_description

    if not zipfile.is_zipfile(unit):
        raise Refused("it is no FMU, which is a zip file")
    with zipfile.ZipFile(unit) as archive:
        if "modelDescription.xml" not in archive.namelist():
            raise Refused("it is no FMU: there is no modelDescription.xml in it")
        version = ElementTree.fromstring(archive.read("modelDescription.xml")).get("fmiVersion", "")
    if not version.startswith(("2.", "3.")):
        raise Refused(f"it is of FMI {version}; 2 and 3 are read")
    description = read_model_description(unit, validate=False)
    if description.coSimulation is None:
        raise Refused(
            "it is for model exchange only; export it for co-simulation, which brings its own solver"
        )
    return description


def _told(unit: str, description: Any) -> dict[str, Any]:
    from fmpy import supported_platforms

    experiment = description.defaultExperiment
    return {
        "fmi": description.fmiVersion,
        "name": description.modelName,
        "tool": description.generationTool or "",
        "platforms": supported_platforms(unit),
        "step_size": getattr(experiment, "stepSize", None),
        "variables": [
            {
                "name": each.name,
                "unit": each.unit or getattr(each.declaredType, "unit", None) or "",
                "causality": each.causality or "local",
                "number": each.type in _FLOATS and not each.dimensions,
                "start": each.start if isinstance(each.start, str) else "",
                "description": each.description or "",
            }
            for each in description.modelVariables
        ],
    }


def _play(asked: dict[str, Any], description: Any, folder: Path) -> None:
    """Run the unit through its commands and write what its outputs were at each of their times."""
    from fmpy import platform, platform_tuple, simulate_fmu, supported_platforms

    there = supported_platforms(asked["unit"])
    if platform not in there:
        built = ", ".join(there) or "no platform at all"
        raise Refused(f"it is built for {built}; this machine is {platform} ({platform_tuple})")
    commands = np.load(folder / COMMANDS)
    names, step = asked["inputs"], float(asked["step"])
    series = np.zeros(len(commands), [("time", float), *((name, float) for name in names)])
    series["time"] = step * np.arange(len(commands))
    for place, name in enumerate(names):
        series[name] = commands[:, place]
    complaints: deque[str] = deque(maxlen=1)

    def log(*told: Any) -> None:
        """Takes environment, instance (FMI 2 only), status, category, message."""
        status, message = told[-3], told[-1]
        if status >= _ERROR and message:
            complaints.append(
                message.decode(errors="replace") if isinstance(message, bytes) else str(message)
            )

    try:
        done = simulate_fmu(
            asked["unit"],
            validate=False,
            start_time=0.0,
            stop_time=float(series["time"][-1]),
            output_interval=step,
            fmi_type="CoSimulation",
            start_values=asked["start"],
            input=series,
            output=asked["outputs"],
            remote_platform=None,
            logger=log,
            debug_logging=True,
        )
    except Exception as error:
        told = [line for each in complaints for line in each.splitlines() if line.strip()]
        raise Refused(f"it failed: {told[-1] if told else error}") from None
    if len(done) < len(series):
        raise Refused(f"it ended by itself at {done['time'][-1]:.6g} s of {series['time'][-1]:.6g} s")
    np.save(folder / PLAYED, np.array([done[name] for name in asked["outputs"]], dtype=float).T)


if __name__ == "__main__":
    main()
