"""Recordings that are sampled far faster than a model needs, averaged over blocks of samples.

A rig's integration step resolves the fastest that its model does; over `STEPS` of them nothing that a fit could
learn from is lost, and between two samples a rollout may take long steps. The mean of a block is a low-pass whose
zeros fall on what would be folded (Oppenheim, Schafer, Discrete-Time Signal Processing, 2010, chapter 4): white
noise falls with the root of the block's length. The command is not averaged: its edges stay where they are.
"""

import math

import numpy as np

STEPS = 10
"""Blocks are at most so many integration steps long: 5 ms on a rig that is integrated with 0.5 ms."""

SHORTEST = 3
"""Blocks of fewer samples are not worth it: the recording is kept as it is."""

CURVED = 1.0 / 24.0
"""The mean over a block differs from the value in its middle by curvature times length squared over 24."""


def block_size(time: np.ndarray, longest_step: float) -> int:
    """How many samples of a recording make a block; 1 if it is to be kept as it is.

    Args:
        time: of the samples [s]. # (n,)
        longest_step: of the rig's integration [s].
    """
    if time.size < 2:
        return 1
    size = math.floor(STEPS * longest_step / float(np.median(np.diff(time))) + 1e-6)
    return size if size >= SHORTEST else 1


class Blocks:
    """Blocks of equal duration; the first sample, with which a rollout begins, is one of its own."""

    def __init__(self, time: np.ndarray, size: int) -> None:
        """Sort samples into blocks; blocks without any sample, in gaps, are left out.

        Args:
            time: of the samples [s], rising. # (n,)
            size: samples in a block.
        """
        spacing = float(np.median(np.diff(time)))
        number = np.floor((time - time[0] - 0.5 * spacing) / (size * spacing)).astype(int)
        _, self._block, self._count = np.unique(number, return_inverse=True, return_counts=True)
        self.time = self._sum(time) / self._count  # (blocks,)

    def _sum(self, values: np.ndarray) -> np.ndarray:
        return np.bincount(self._block, weights=values)

    def mean(self, values: np.ndarray) -> np.ndarray:
        """Means of the finite values, NaN where fewer than half are. # (blocks,)."""
        finite = np.isfinite(values)
        known = self._sum(finite.astype(float))
        total = self._sum(np.where(finite, values, 0.0))
        return np.where(2.0 * known >= self._count, total / np.maximum(known, 1.0), np.nan)

    @staticmethod
    def blur(means: np.ndarray) -> np.ndarray:
        """By how much the mean of each block differs from the value in its middle, from the means' curvature."""
        padded = np.concatenate([means[:1], means, means[-1:]])
        return CURVED * np.abs(np.nan_to_num(np.diff(padded, n=2)))
