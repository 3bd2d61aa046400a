"""What a run leaves in its folder: signals, picture, page, 3-D replay, and what was run."""

import errno
import json
import os
from pathlib import Path
from typing import Any

from hydrolek_drake import __version__
from hydrolek_drake.files import results_folder, write_whole
from hydrolek_drake.recordings import write_signals
from hydrolek_drake.replay.picture import plots_png
from hydrolek_drake.runs.page import page
from hydrolek_drake.runs.panels import overview
from hydrolek_drake.runs.running import ScenarioRun
from hydrolek_drake.runs.signals import named_signals
from hydrolek_drake.runs.summary import JointSummary, sentence


def prepare_folder(folder: Path) -> None:
    """Make the folder before anything is computed for it.

    Raises:
        InputError: it cannot be made or written to.
    """
    with results_folder(folder):
        if not os.access(folder, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))


def write_run(
    done: ScenarioRun, joints: tuple[JointSummary, ...], folder: Path, replay3d: str | None
) -> Path:
    """Write `signals.parquet`, `run.json`, `signals.png`, `replay3d.html` and `simulate.html`, each when complete.

    Args:
        done: the run.
        joints: its summary.
        folder: made if it is not there.
        replay3d: stand-alone page of the 3-D replay, or None.

    Returns:
        The page's path.

    Raises:
        InputError: the folder cannot be written to.
    """
    title = f"{done.scenario.name}: {done.scenario.title}"
    with results_folder(folder):
        write_signals(folder / "signals.parquet", done.run.time, *named_signals(done))
        write_whole(folder / "run.json", json.dumps(as_json(done, joints), indent=1).encode())
        write_whole(folder / "signals.png", plots_png(overview(done), title, sentence(done, joints)))
        if replay3d is not None:
            write_whole(folder / "replay3d.html", replay3d.encode())
        write_whole(folder / "simulate.html", page(done, joints, replay3d is not None).encode())
    return folder / "simulate.html"


def as_json(done: ScenarioRun, joints: tuple[JointSummary, ...]) -> dict[str, Any]:
    """What was run and what came out, in SI units."""
    scenario = done.scenario
    return {
        "schema": 1,
        "version": __version__,
        "scenario": scenario.name,
        "title": scenario.title,
        "content": scenario.tree,
        "rig": scenario.rig.name,
        "held": scenario.rig.held,
        "seed": done.seed,
        "sentence": sentence(done, joints),
        "interrupted": done.run.interrupted,
        "seconds_simulated": float(done.run.time[-1]),
        "seconds": done.seconds,
        "joints": {
            joint.joint: {
                "unit": joint.unit,
                "start": joint.start,
                "end": joint.end,
                "lowest": joint.lowest,
                "highest": joint.highest,
                "highest_pressure_Pa": joint.pressure,
                "seconds_at_stops": joint.at_stops,
                "movement_at_rest": joint.rest_movement,
            }
            for joint in joints
        },
    }
