"""In which condition of the machine the error is large, told from the model's own movement."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.replay.noise import samples_in, smoothed
from hydrolek_drake.replay.spans import SMOOTHING_S
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.rollout import Signals

AT_REST = 0.02
"""A joint slower than this fraction of its largest speed stands still."""

AFTER_REVERSAL_S = 0.3
"""How long after a change of direction counts as just after it."""

NEAR_END = 0.1
"""The last tenth of the travel, at either end."""

HIGH_COMMAND = 0.8
"""A command above this fraction of the largest one recorded is high."""

TELLING = 0.15
"""A condition is named if its share of the error exceeds its share of the time by this much."""


@dataclass(frozen=True)
class Condition:
    """How much of the error falls into one condition.

    Attributes:
        name: in words that fit after "largest".
        of_error: share of the squared error.
        of_time: share of the time.
    """

    name: str
    of_error: float
    of_time: float

    @property
    def excess(self) -> float:
        """How much larger its share of the error is than its share of the time."""
        return self.of_error - self.of_time


def conditions_of(rig: Rig, joint: str, command: np.ndarray, signals: Signals) -> dict[str, np.ndarray]:
    """Condition in words -> when it holds, from model signals and command.

    Returns:
        One truth value per sample for each condition. # (n,)
    """
    time, velocity, position = signals.time, np.nan_to_num(signals.velocity), signals.position
    fastest = float(np.abs(velocity).max())
    direction = np.where(np.abs(velocity) > AT_REST * fastest, np.sign(velocity), 0.0)
    lower, upper = (rig.value(f"joints.{joint}.load.{name}") for name in ("lower_stop", "upper_stop"))
    margin = NEAR_END * (upper - lower)
    drive = np.abs(command - rig.value(f"joints.{joint}.command.neutral"))
    return {
        "at rest": direction == 0.0,
        "while moving in the positive direction": direction > 0.0,
        "while moving in the negative direction": direction < 0.0,
        "just after a reversal": _after_reversal(time, direction),
        "near the lower end": position < lower + margin,
        "near the upper end": position > upper - margin,
        "at high command": drive > HIGH_COMMAND * max(float(drive.max()), np.finfo(float).tiny),
    }


def _after_reversal(time: np.ndarray, direction: np.ndarray) -> np.ndarray:
    moving = np.flatnonzero(direction)
    turned = moving[1:][np.diff(direction[moving]) != 0.0]
    if not turned.size:
        return np.zeros(time.size, dtype=bool)
    last = np.searchsorted(time[turned], time, side="right") - 1
    return (last >= 0) & (time - time[turned][np.maximum(last, 0)] < AFTER_REVERSAL_S)


def shares(time: np.ndarray, error: np.ndarray, conditions: dict[str, np.ndarray]) -> tuple[Condition, ...]:
    """Share of squared error and of time for every condition, the most telling first.

    Args:
        time: [s]; samples count by the time that they stand for. # (n,)
        error: residual, or its growth; NaN where unknown. # (n,)
        conditions: when each holds. # (n,) each
    """
    finite = np.isfinite(error)
    weight = np.where(finite, np.gradient(time), 0.0)
    squared = weight * np.where(finite, error, 0.0) ** 2
    if not squared.sum() > 0.0:
        return ()
    found = (
        Condition(
            name, float(squared[holds].sum() / squared.sum()), float(weight[holds].sum() / weight.sum())
        )
        for name, holds in conditions.items()
    )
    return tuple(sorted(found, key=lambda condition: -condition.excess))


def growth(time: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Change of the smoothed residual over about the smoothing time, centred.

    A position integrates what goes wrong: its error is large long after the cause has gone, but it grows
    only while the cause acts.

    Args:
        time: [s]. # (n,)
        residual: NaN where unknown. # (n,)
    """
    width = samples_in(SMOOTHING_S, time)
    mean = smoothed(residual, width)
    half = (width + 1) // 2
    change = np.full(time.size, np.nan)
    if time.size > 2 * half:
        change[half:-half] = mean[2 * half :] - mean[: -2 * half]
    return change
