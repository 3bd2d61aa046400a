"""Global screening by elementary effects (Morris 1991; Campolongo, Cariboni, Saltelli 2007)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

LEVELS = 4
"""Of the grid; with steps of LEVELS / (2 (LEVELS - 1)) every level is equally likely."""


@dataclass(frozen=True)
class ElementaryEffects:
    """Change of the output when a parameter moves over its range.

    Attributes:
        mean_size: mu*, mean of the effects' size; how much a parameter matters. # (parameters, outputs)
        deviation: sigma, standard deviation of the effects: how much that depends on the other
            parameters, or is not linear. # (parameters, outputs)
    """

    mean_size: np.ndarray
    deviation: np.ndarray


def trajectory(parameters: int, rng: np.random.Generator) -> np.ndarray:
    """A walk through the unit cube in which each parameter moves once. # (parameters + 1, parameters)."""
    step = LEVELS / (2.0 * (LEVELS - 1))
    start = rng.integers(LEVELS // 2, size=parameters) / (LEVELS - 1)
    rising = rng.random(parameters) < 0.5
    points = np.tile(np.where(rising, start, start + step), (parameters + 1, 1))
    for row, i in enumerate(rng.permutation(parameters), start=1):
        points[row:, i] += step if rising[i] else -step
    return points


def elementary_effects(
    outputs: Callable[[Sequence[np.ndarray]], Sequence[np.ndarray]],
    summary: Callable[[np.ndarray], np.ndarray],
    parameters: int,
    trajectories: int,
    rng: np.random.Generator,
    progress: Callable[[int], None] = lambda done: None,
) -> ElementaryEffects:
    """mu* and sigma of an output that may be a whole signal.

    Args:
        outputs: places in the unit cube -> signal at each, NaN where it has no value. # (n,)
        summary: size of a signal, such as its rms in each segment. # (..., n) -> (..., outputs)
        parameters: how many.
        trajectories: r; the cost is r (parameters + 1) evaluations.
        rng: draws the trajectories.
        progress: told after each trajectory how many are done.
    """
    effects: list[np.ndarray] = []
    for number in range(trajectories):
        points = trajectory(parameters, rng)
        signals = np.array(outputs(list(points)))
        moved = np.diff(points, axis=0)
        which = np.argmax(np.abs(moved), axis=1)
        change = np.diff(signals, axis=0) / moved[np.arange(parameters), which][:, None]
        ordered = np.empty_like(change)
        ordered[which] = change
        effects.append(ordered)
        progress(number + 1)
    all_effects = np.array(effects)  # (r, parameters, n)
    told = np.isfinite(all_effects).all(axis=2, keepdims=True)  # what diverged counts neither way
    counted = np.maximum(told.sum(axis=0), 1)
    all_effects = np.where(told, all_effects, 0.0)
    about_mean = np.where(told, all_effects - all_effects.sum(axis=0) / counted, 0.0)
    squares = (about_mean**2).sum(axis=0) / np.maximum(counted - 1, 1)
    return ElementaryEffects(
        mean_size=summary(all_effects).sum(axis=0) / counted, deviation=summary(np.sqrt(squares))
    )
