"""Innovations in blocks, and what blocks of a healthy machine look like, by its reference recordings.

Of the innovations of a channel over their root mean square in the reference, z, a block has the mean m and the mean
square q. In the reference blocks have Var m = s^2, and q the mean 1 and some variance. Blocks that follow one another
are alike where the drive is: what counts for sums of many is the long-run variance, (1 + r) / (1 - r) times that of
one, with the correlation r of neighbours (Box, Jenkins, Reinsel, Time Series Analysis, 1994, chapter 3). It is known
from n blocks, and bounded by chi squared with n - 1 degrees of freedom.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2, norm

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording
from hydrolek_drake.recordings.clock import gap_follows, usual_interval
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.kernel import PULLED
from hydrolek_drake.watching.live.observing import Observer, Response
from hydrolek_drake.watching.live.samples import Samples, by_joint
from hydrolek_drake.watching.live.settings import (
    BLOCK_S,
    LEAST_BLOCKS,
    LOST,
    PULL_S,
    SETTLED,
    SURE,
    WHOLE,
)

_SPEED_S = 0.1
"""Speeds are told by differences over so long, in which a joint that moves passes its sensor's noise."""

_REACHED = 0.95
"""Share of the samples below what counts as reached."""

_MOST_ALIKE = 0.9
"""Correlation of neighbouring blocks that is believed at most: of a few dozen, more cannot be told."""


@dataclass(frozen=True)
class Block:
    """Innovations of one block, in units of what the reference gives.

    Attributes:
        begin: [s].
        end: [s].
        mean: of each joint and quantity; NaN where too little was measured. # (joints, 3)
        square: mean squares. # (joints, 3)
    """

    begin: float
    end: float
    mean: np.ndarray
    square: np.ndarray


class Blocks:
    """Innovations gathered in blocks."""

    def __init__(self, scale: np.ndarray, interval: float) -> None:
        """Prepare.

        Args:
            scale: root mean squares of the reference's innovations. # (joints, 3)
            interval: usual one between samples [s].
        """
        self._scale = scale
        self._least = WHOLE * BLOCK_S / interval
        self.restart()

    def restart(self) -> None:
        """Forget the block that was begun."""
        self._begin: float | None = None
        self._sums = np.zeros((3, *self._scale.shape))

    def add(self, time: float, innovations: np.ndarray) -> Block | None:
        """Take innovations, # (joints, 3); the block that is complete with them, if one is."""
        done = None
        if self._begin is None:
            self._begin = time
        elif time - self._begin >= BLOCK_S:
            done = self._done(time)
            self._begin, self._sums = time, np.zeros_like(self._sums)
        z = innovations / self._scale
        known = np.isfinite(z)
        z = np.where(known, z, 0.0)
        self._sums += np.stack([known.astype(float), z, z * z])
        return done

    def _done(self, end: float) -> Block:
        assert self._begin is not None
        count, total, squares = self._sums
        enough = count >= self._least
        count = np.where(enough, count, np.nan)
        return Block(self._begin, end, total / count, squares / count)


@dataclass(frozen=True)
class Healthy:
    """What innovations of a healthy machine are like.

    Attributes:
        joints: in the order of the rows.
        response: how joints follow their commands.
        scale: root mean square of innovations of `kernel.PULLED`; NaN where nothing was measured. # (joints, 3)
        deviation: standard deviation of a block's mean, of sums over many blocks, bounded from above. # (joints, 3)
        square: mean of a block's mean square, bounded from above. # (joints, 3)
        shape: of the gamma distribution of mean squares, k = mean^2 / variance, bounded from below. # (joints, 3)
    """

    joints: tuple[str, ...]
    response: Response
    scale: np.ndarray
    deviation: np.ndarray
    square: np.ndarray
    shape: np.ndarray

    @property
    def interval(self) -> float:
        """Usual one between samples [s]."""
        return self.response.interval


def healthy_of(
    rig: Rig, joints: Sequence[str], recordings: Sequence[Recording], lost: float = LOST, seed: int = 1
) -> Healthy:
    """What the reference recordings give when the observer follows them.

    Args:
        rig: with the values of the model that was fitted to them.
        joints: that are observed; each recording drives all of them.
        recordings: of the healthy machine.
        lost: share of the samples that are left out, as a link may lose them.
        seed: of which ones.

    Raises:
        InputError: fewer than `LEAST_BLOCKS` blocks, or the model cannot follow a recording.
    """
    rng = np.random.default_rng(seed)
    interval = float(np.median([usual_interval(recording.time) for recording in recordings]))
    whole = [_innovations(rig, joints, recording, 0.0, rng, None) for recording in recordings]
    scale = _root_mean_square(whole)
    response = Response(interval, _speeds(rig, joints, recordings) / scale[:, 0])
    told = [_innovations(rig, joints, recording, lost, rng, response) for recording in recordings]
    scale = _root_mean_square(told)
    runs = [_blocks(scale, interval, *each) for each in told]
    number = sum(len(run) for run in runs)
    if number < LEAST_BLOCKS:
        raise InputError(
            f"the reference is too short for --live: {number} blocks of {BLOCK_S:g} s are left once the observer has "
            f"settled, and {LEAST_BLOCKS} are needed; give longer recordings, or more of them"
        )
    means = [np.array([block.mean for block in run]) for run in runs if run]
    squares = [np.array([block.square for block in run]) for run in runs if run]
    variance = _long_run(means, np.zeros(scale.shape))
    level = _mean(np.concatenate(squares))
    spread = _long_run(squares, level)
    bound = (number - 1) / chi2.ppf(1.0 - SURE, number - 1)
    high = level + norm.ppf(SURE) * np.sqrt(spread / number)
    return Healthy(
        tuple(joints), response, scale, np.sqrt(variance * bound), high, high**2 / (spread * bound)
    )


def _root_mean_square(told: Sequence[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Of innovations, NaN where there are none. # (joints, 3)."""
    scale = np.sqrt(_mean(np.concatenate([innovations for _, innovations in told]) ** 2))
    return np.where(scale > 0.0, scale, np.nan)


def _speeds(rig: Rig, joints: Sequence[str], recordings: Sequence[Recording]) -> np.ndarray:
    """Speed for a volt: what a joint reaches, over the largest commands. # (joints,)."""
    fast, large = [], []
    for recording in recordings:
        values = by_joint(rig, joints, Samples.of(recording))
        steps = max(round(_SPEED_S / usual_interval(recording.time)), 1)
        moved = np.abs(values[steps:, :, 1] - values[:-steps, :, 1])
        passed = (recording.time[steps:] - recording.time[:-steps])[:, None]
        fast.append(np.nanquantile(moved / passed, _REACHED, axis=0))
        neutral = [rig.value(f"joints.{joint}.command.neutral") for joint in joints]
        large.append(np.nanquantile(np.abs(values[:, :, 0] - neutral), _REACHED, axis=0))
    return np.asarray(np.max(fast, axis=0) / np.maximum(np.max(large, axis=0), np.finfo(float).tiny))


def _innovations(
    rig: Rig,
    joints: Sequence[str],
    recording: Recording,
    lost: float,
    rng: np.random.Generator,
    response: Response | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Times and innovations of a recording, from where the observer has settled. # (k,), (k, joints, 3)."""
    keep = rng.random(recording.time.size) >= lost
    values = by_joint(rig, joints, Samples.of(recording))[keep]
    time = recording.time[keep]
    gaps = np.concatenate([[False], gap_follows(recording.time)])[keep]
    observer = Observer(rig, joints, response)
    times, found, settled = [], [], np.inf
    for now, row, gap in zip(time.tolist(), values, gaps, strict=True):
        if gap:
            observer.restart()
        told = observer.step(now, row)
        if told is None:
            settled = now + SETTLED * PULL_S
        elif now >= settled:
            times.append(now)
            found.append(np.where(observer.sure[:, None], told, np.nan))
    return np.array(times), np.reshape(found, (-1, len(joints), len(PULLED)))


def _blocks(scale: np.ndarray, interval: float, times: np.ndarray, innovations: np.ndarray) -> list[Block]:
    gathered = Blocks(scale, interval)
    found = (gathered.add(time, each) for time, each in zip(times.tolist(), innovations, strict=True))
    return [block for block in found if block is not None]


def _long_run(runs: Sequence[np.ndarray], about: np.ndarray) -> np.ndarray:
    """Variance about a value, times what correlation of neighbours adds in sums of many. # (joints, 3)."""
    off = [run - about for run in runs]
    variance = _mean(np.concatenate(off) ** 2)
    pairs = [run[1:] * run[:-1] for run in off]
    alike = np.clip(_mean(np.concatenate(pairs)) / variance, 0.0, _MOST_ALIKE)
    return np.asarray(variance * (1.0 + alike) / (1.0 - alike))


def _mean(values: np.ndarray) -> np.ndarray:
    """Mean of the values that are known, NaN where none is. # (n, joints, 3) -> (joints, 3)."""
    known = np.isfinite(values)
    count = known.sum(axis=0)
    return np.asarray(np.where(known, values, 0.0).sum(axis=0) / np.where(count, count, np.nan))
