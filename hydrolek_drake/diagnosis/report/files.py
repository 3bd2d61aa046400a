"""What a diagnosis leaves in its folder: report, page, fitted rig, residuals."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import yaml

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.report.as_json import as_json
from hydrolek_drake.diagnosis.report.page import page
from hydrolek_drake.diagnosis.report.panels import after, before, columns
from hydrolek_drake.diagnosis.report.words import headline
from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_whole
from hydrolek_drake.recordings import write_signals
from hydrolek_drake.replay.confirmation import Confirmation
from hydrolek_drake.replay.picture import plots_png


def write_report(diagnosis: Diagnosis, folder: Path, confirmed: Sequence[Confirmation] = ()) -> Path:
    """Write `report.json`, `.html`, `.png`, `rig_fitted.yaml` and `residuals_*.parquet`, each when complete.

    Bad data leave only the first two. `next_experiment.csv` is the command of a proposed recording.

    Args:
        diagnosis: the outcome.
        folder: where; made if it is missing.
        confirmed: the fitted rig on the Drake Diagram, where that was run.

    Returns:
        Path of the page.

    Raises:
        InputError: the folder cannot be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tree = as_json(diagnosis) | {"diagram": [each.as_json() for each in confirmed]}
        if diagnosis.bench is not None:
            rig = diagnosis.fitted_rig().as_tree()
            write_whole(folder / "rig_fitted.yaml", yaml.safe_dump(rig, sort_keys=False, allow_unicode=True))
            _write_residuals(diagnosis, folder)
            title = f"Diagnosis of {diagnosis.rig.name}"
            write_whole(folder / "report.png", plots_png(columns(diagnosis), title, headline(diagnosis)))
        if diagnosis.proposal is not None:
            joint = diagnosis.bench.training[0].joint if diagnosis.bench else "joint"
            write_signals(
                folder / "next_experiment.csv",
                diagnosis.proposal.time,
                {f"{joint}.command": diagnosis.proposal.command},
                {f"{joint}.command": "V"},
            )
        write_whole(folder / "report.html", page(diagnosis, confirmed))
        write_whole(folder / "report.json", json.dumps(tree, indent=1, allow_nan=False))
    except OSError as error:
        raise InputError(f"--out {folder}: cannot write there: {error.strerror or error}") from None
    return folder / "report.html"


def _write_residuals(diagnosis: Diagnosis, folder: Path) -> None:
    """One file a recording: what was measured, and what is left before and after."""
    assert diagnosis.bench is not None
    sides = {"train": diagnosis.bench.training, "holdout": diagnosis.held_out}
    for side, experiments in sides.items():
        for number, experiment in enumerate(experiments, start=1):
            without, enlarged = before(diagnosis, experiment), after(diagnosis, experiment)
            signals: dict[str, np.ndarray] = {f"{experiment.joint}.command": experiment.command_at_samples}
            units = {f"{experiment.joint}.command": "V"}
            counts = f"{experiment.joint}.counts"  # in the errors that are told: of held-out data some blocks chose
            signals[counts], units[counts] = experiment.used.astype(float), "1"
            for channel in experiment.channels:
                told = {
                    "measured": channel.measured,
                    "before": channel.measured - getattr(without, channel.model),
                    "after": channel.measured - getattr(enlarged, channel.model),
                }
                for name, values in told.items():
                    signals[f"{channel.key}_{name}"] = values
                    units[f"{channel.key}_{name}"] = channel.unit
            path = folder / f"residuals_{side}_{number}_{experiment.joint}.parquet"
            write_signals(path, experiment.time, signals, units)
