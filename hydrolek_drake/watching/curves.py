"""What is kept of a recording to be drawn."""

import numpy as np

from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.replay.display import display_factor
from hydrolek_drake.watching.settings import POINTS


def curves_of(experiment: Experiment, nominal: Fit, best: Fit | None) -> dict[str, list[float]]:
    """What is drawn of the first joint's position: means over blocks of the recording."""
    position, count = experiment.channels[0], experiment.time.size
    edges = np.unique(np.linspace(0, count, min(POINTS, count) + 1).astype(int))[:-1]
    sizes = np.diff([*edges, count])

    def means(values: np.ndarray) -> list[float]:
        return [float(f"{v:.4g}") for v in np.add.reduceat(np.nan_to_num(values[:count]), edges) / sizes]

    shown = {
        "time": [float(f"{v:.6g}") for v in experiment.time[edges]],
        "command": means(experiment.command_at_samples),
        "measured": means(display_factor(position.unit) * position.measured),
        "nominal": means(nominal.residuals),
    }
    if best is not None:
        shown["best"] = means(best.residuals)
    return shown
