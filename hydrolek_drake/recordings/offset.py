"""By how much one clock is ahead of another, from a command and the motion that follows it."""

from typing import NamedTuple

import numpy as np

from hydrolek_drake.recordings.clock import usual_interval
from hydrolek_drake.recordings.resampling import held

OVERLAP, OVERLAP_OF_ONE_TIME = 0.5, 0.75
"""Share of the shorter of two records that they must have in common at a lag; more where they have time in
common as they are, since it is then likely that their clocks agree."""

LONGEST_ANSWER = 1.0
"""No machine answers its command later than this [s]; none answers before it."""

HALF_EXPLAINED = float(np.sqrt(0.5))
"""Correlation from which a command explains more than half of how a speed varies."""

SURELY, CLEARLY_BETTER = 0.85, 0.1
"""Clocks are called apart where a correlation is at least so high, and exceeds all at lags that a machine may
have by so much."""

REVERSALS = 4
"""Changes of direction without which one lag is hardly told from another."""

SPEED_OVER = 0.1
"""Time over which speeds are formed [s], so that noise does not drown them."""

_MOST_SAMPLES = 100_000


class Offset(NamedTuple):
    """How a response lies after its command.

    Attributes:
        lag: By how much it follows [s]; negative where it comes before.
        correlation: Of command and speed at this lag, without sign.
        plausible: A machine may be so.
    """

    lag: float
    correlation: float
    plausible: bool


def overlap(a: np.ndarray, b: np.ndarray) -> float:
    """Time that two records have in common, as a share of the shorter one."""
    shorter = min(a[-1] - a[0], b[-1] - b[0])
    common = min(a[-1], b[-1]) - max(a[0], b[0])
    return float(common / shorter) if shorter > 0.0 else float(common >= 0.0)


def offset_from_data(
    command_time: np.ndarray,
    command: np.ndarray,
    time: np.ndarray,
    response: np.ndarray,
    *,
    is_rate: bool,
) -> Offset | None:
    """The lag at which a command explains best how fast something moves.

    The correlation coefficient of the command, held, and of the response's speed is taken at every lag at
    which they have half of the shorter record in common (all at once, by the Fourier transform of values,
    squares and where there are any). Its sign does not matter: polarity is the rig's.

    Args:
        command_time: Strictly increasing [s]. # (m,)
        command: Held between its samples. # (m,)
        time: Strictly increasing [s]. # (n,)
        response: A position, or a rate or pressure. # (n,)
        is_rate: The response is no position, so that it and not its slope follows the command.

    Returns:
        None where no lag explains more than half of the variance, the motion tells too little, or there is nothing to
        compare.
    """
    shorter = min(command_time[-1] - command_time[0], time[-1] - time[0])
    share = OVERLAP_OF_ONE_TIME if overlap(command_time, time) > 0.0 else OVERLAP
    step = max(
        min(usual_interval(time), SPEED_OVER / 2),
        (command_time[-1] - command_time[0] + time[-1] - time[0]) / _MOST_SAMPLES,
    )
    if not shorter > 10.0 * step:
        return None
    driven = held(command_time, command, np.arange(command_time[0], command_time[-1], step))
    at = np.arange(time[0], time[-1], step)
    good = np.isfinite(response)
    if good.sum() < 3:
        return None
    motion = np.interp(at, time[good], response[good])
    width = max(round(SPEED_OVER / step), 1)
    if not is_rate:
        motion = (motion[width:] - motion[:-width]) / (width * step)
        at = at[: motion.size] + 0.5 * width * step
    lags, correlation = _correlations(driven, motion, round(share * shorter / step))
    if not lags.size:
        return None
    seconds = lags * step + (at[0] - command_time[0])
    size = np.abs(correlation)
    best = int(np.argmax(size))
    possible = (seconds >= -step) & (seconds <= LONGEST_ANSWER)
    if possible.any():
        inside = int(np.flatnonzero(possible)[np.argmax(size[possible])])
        if size[inside] >= size[best] - CLEARLY_BETTER or size[best] < SURELY:
            best = inside
    if size[best] < HALF_EXPLAINED or (not possible[best] and _reversals(motion) < REVERSALS):
        return None
    return Offset(float(seconds[best]), float(size[best]), bool(possible[best]))


def _reversals(speed: np.ndarray) -> int:
    moving = speed[np.abs(speed) > 0.05 * np.max(np.abs(speed))]
    return int(np.count_nonzero(np.diff(np.sign(moving))))


def _correlations(a: np.ndarray, b: np.ndarray, least: int) -> tuple[np.ndarray, np.ndarray]:
    """Pearson's coefficient of a[i] and b[i + lag] for every lag with at least so many pairs.

    Returns:
        Lags in samples # (k,), and coefficients; 0 where one of them does not vary # (k,).
    """
    size = 1 << (a.size + b.size - 1).bit_length()
    have_a, have_b = np.isfinite(a), np.isfinite(b)
    # means and sizes drop out of the coefficient; large ones would only cost digits
    a, b = _standard(a, have_a), _standard(b, have_b)

    def products(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        both = np.fft.irfft(np.conj(np.fft.rfft(x, size)) * np.fft.rfft(y, size), size)
        return np.concatenate([both[size - a.size + 1 :], both[: b.size]])

    mask_a, mask_b = have_a.astype(float), have_b.astype(float)
    pairs = np.round(products(mask_a, mask_b))
    lags = np.arange(1 - a.size, b.size)
    enough = pairs >= max(least, 3)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean_a, mean_b = products(a, mask_b) / pairs, products(mask_a, b) / pairs
        spread_a = products(a * a, mask_b) / pairs - mean_a**2
        spread_b = products(mask_a, b * b) / pairs - mean_b**2
        together = products(a, b) / pairs - mean_a * mean_b
        varies = (spread_a > 1e-6) & (spread_b > 1e-6)
        coefficient = np.where(varies, together / np.sqrt(spread_a * spread_b), 0.0)
    return lags[enough], np.clip(coefficient[enough], -1.0, 1.0)


def _standard(values: np.ndarray, have: np.ndarray) -> np.ndarray:
    if not have.any():
        return np.zeros(values.size)
    centred = np.where(have, values - values[have].mean(), 0.0)
    spread = float(np.sqrt(np.mean(centred[have] ** 2)))
    return centred / spread if spread > 0.0 and np.isfinite(spread) else np.zeros(values.size)
