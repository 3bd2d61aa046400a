"""What each signal counts where no model comes near the noise.

On a real machine something is always left out, and the signals show it very unequally: a pressure with 2 kPa of
noise that rings by 0.3 MPa outweighs everything that an angle could tell, though neither is followed to its noise.
The error of the best model then stands in for the noise: the deviations s_c of the signals' noise become

    s_c max(1, q_c / q),    q = max(FAR, least of all q_c),

q_c the best model's root mean square over s_c. Every signal that is followed worse than the one followed best counts as
if it were followed as well (maximum likelihood with an unknown variance for each signal, one step of iteratively
reweighted least squares; Seber, Wild, Nonlinear Regression, 1989, chapter 2.8). All stays far from the noise, so that
probabilities are made flatter by what is left (`evidence`).
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.effort import FAR
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

UNEQUAL = 2.0
"""Signals are weighed anew if one is followed worse than another by this factor at least."""


def weights_by(bench: Workbench, best: Hypothesis) -> dict[str, float]:
    """Factor for the deviation of every signal's noise, by key; empty where they are followed about equally.

    Args:
        bench: fits, and the training data.
        best: the model that comes nearest.
    """
    squares = squares_of(bench.residuals(best, bench.training, bench.fine), bench.training)
    counted: dict[str, int] = defaultdict(int)
    for experiment in bench.training:
        for channel in experiment.channels:
            counted[channel.key] += experiment.counted_of(channel)
    ratios = {key: (squares[key] / counted[key]) ** 0.5 for key in squares if counted[key]}
    aim = max(FAR, min(ratios.values()))
    if max(ratios.values()) < UNEQUAL * aim:
        return {}
    return {key: max(1.0, ratio / aim) for key, ratio in ratios.items()}


def squares_of(residuals: np.ndarray, experiments: Sequence[Experiment]) -> dict[str, float]:
    """Squared residuals of every signal, by key, from those of all. # residuals: (values,)."""
    squares: dict[str, float] = defaultdict(float)
    place = 0
    for experiment in experiments:
        for channel in experiment.channels:
            own = residuals[place : place + experiment.time.size]
            place += experiment.time.size
            squares[channel.key] += float(own @ own)
    return squares


def weighed(experiments: Sequence[Experiment], weights: dict[str, float]) -> tuple[Experiment, ...]:
    """The same experiments with these factors."""
    return tuple(
        replace(
            experiment,
            channels=tuple(replace(c, widened=weights.get(c.key, 1.0)) for c in experiment.channels),
        )
        for experiment in experiments
    )


def told(weights: dict[str, float]) -> str:
    """The factors in one sentence."""
    listed = ", ".join(f"{key} {factor:.1f} times" for key, factor in weights.items() if factor > 1.0)
    return (
        "no model comes near the noise, and some signals are followed far worse than others: so that each counts, "
        f"the noise was taken as larger than it is ({listed}), and 'times the noise' is said of that"
    )
