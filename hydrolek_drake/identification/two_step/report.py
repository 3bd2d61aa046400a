"""What `hydrolek identify two-step` says and writes: errors, parameters, and pictures like figures 4.19 to 4.23."""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from hydrolek_drake.files import write_results
from hydrolek_drake.identification.two_step.estimate import STAGES, Stage, TwoStep
from hydrolek_drake.identification.two_step.settings import two_step_data
from hydrolek_drake.rigs import Rig

DRAWN = {STAGES[1]: "#7570b3", STAGES[3]: "#1b6ca8", STAGES[4]: "#d95f02"}
"""Stages in the picture, and their colours."""


def sentences(found: TwoStep) -> list[str]:
    """What ended at an end of its range, and what that means."""
    lines = []
    for stage in found.stages:
        if stage.at_end:
            short = ", ".join(path.removeprefix(f"joints.{found.joint}.") for path in stage.at_end)
            lines.append(f"{stage.name}: at an end of its range: {short}")
    if found.interrupted:
        lines.append("interrupted: the steps that were finished are given")
    return lines


def as_json(found: TwoStep, machine: Rig | None = None) -> dict[str, Any]:
    """Errors and parameters of every stage; those of the machine beside them where it was simulated."""
    content: dict[str, Any] = {
        "joint": found.joint,
        "noise_deg": found.noise_deg,
        "interrupted": found.interrupted,
        "stages": [
            {
                "name": stage.name,
                "fitted_deg": stage.fitted_deg,
                "held_out_deg": stage.held_deg,
                "evaluations": stage.evaluations,
                "values": stage.values,
                "at_end_of_range": list(stage.at_end),
            }
            for stage in found.stages
        ],
        "table_4_1": {
            name: {"path": f"joints.{found.joint}.{row['path']}", "value": found.rig.value(str(row["path"]))}
            for name, row in two_step_data()["table_4_1"].items()
        },
    }
    if machine is not None:
        paths = [path for path in found.stages[-1].values if path in machine.entries]
        content["machine"] = {path: machine.value(path) for path in paths}
    return content


def relative_errors(stage: Stage, machine: Rig) -> np.ndarray:
    """|value / machine's - 1| of every parameter that a stage fitted and the machine has. # (n,)."""
    pairs = [(value, machine.value(path)) for path, value in stage.values.items() if path in machine.entries]
    return np.array([abs(value / true - 1.0) for value, true in pairs])


def write_report(found: TwoStep, folder: Path, machine: Rig | None = None) -> list[Path]:
    """Write `two_step_<joint>.json`, its picture and the rig that was found, each when complete."""
    contents: dict[str, bytes] = {
        f"two_step_{found.joint}.json": (json.dumps(as_json(found, machine), indent=1) + "\n").encode(),
        f"two_step_{found.joint}.png": picture(found),
        f"rig_{found.joint}.yaml": yaml.safe_dump(
            found.rig.as_tree(), sort_keys=False, allow_unicode=True
        ).encode(),
    }
    return write_results(folder, contents)


def picture(found: TwoStep) -> bytes:
    """Measured and simulated angle, figures 4.19 to 4.23, and what is between them beneath.

    Shows the last recording: one that nothing was fitted to, where there is one.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 5.2), layout="constrained")
    angles, misses = figure.subplots(2, 1, sharex=True, height_ratios=[2.0, 1.0])
    experiment = found.experiments[-1]
    measured = np.degrees(experiment.channels[0].measured)
    angles.plot(experiment.time, measured, color="#bbbbbb", linewidth=3.5, label="measured")
    for stage in found.stages:
        if stage.name not in DRAWN:
            continue
        colour, angle = DRAWN[stage.name], stage.angles_deg[-1]
        angles.plot(experiment.time, angle, color=colour, linewidth=0.9, label=stage.name)
        if stage.name != STAGES[1]:
            misses.plot(experiment.time, measured - angle, color=colour, linewidth=0.8)
    angles.set_ylabel("angle [deg]")
    angles.legend(fontsize=8, ncols=4, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    misses.set(xlabel="time [s]", ylabel="measured - model\n[deg]")
    for axis in (angles, misses):
        axis.grid(alpha=0.25)
    kind = "validation" if found.held else "estimation"
    figure.suptitle(f"{found.joint}: set-point following over the range of motion, {kind}", fontsize=10)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=100)
    return data.getvalue()
