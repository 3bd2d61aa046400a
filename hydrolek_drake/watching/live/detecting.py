"""Since when innovations are no longer those of a healthy machine: a sequential test with a bound for all times.

For a block with mean m of standard deviation s, and mean square q about a level a with the shape k of a gamma
distribution, the likelihood ratios of a changed machine against the healthy one are

    L = exp(c m / s - c^2 / 2)                        mean moved by c standard deviations
    L = exp(k (1 - 1 / d) q / a - k ln d)             mean square d times as large

whose means over a healthy machine's blocks are one. A change may begin with any block n, with the weight
w(n) = 1 / (n (n + 1)); the weights sum to one. The evidence for all of these together,

    A(n) = L(n) (A(n - 1) + w(n)),

stays, with the weights still to come, a non-negative martingale that begins at one: it ever exceeds 1 / p with a
probability of p at most, however long the watch lasts (Ville, Etude critique de la notion de collectif, 1939). It is
the procedure of Shiryaev and Roberts (Theory of Probability and its Applications 8, 1963; Technometrics 8, 1966) with
weights, as those of the watch's recordings are. Means over alternatives are martingales as well; of channels and
statistics each is granted an equal part of the false alarms (Bonferroni). Evidence of a block above `MOST_NATS` is not
counted, which only lowers A.
"""

import math

import numpy as np

from hydrolek_drake.watching.live.blocks import Block, Healthy
from hydrolek_drake.watching.live.settings import MOST_NATS, SHIFTS, SPREADS

STATISTICS = ("mean", "mean square")


class ChangeDetector:
    """The test of all channels.

    Attributes:
        threshold: of the logarithm of the evidence.
        evidence: its logarithm by statistic, joint and quantity; NaN where nothing is measured. # (2, joints, 3)
        since: beginning of the block from which on the evidence has grown to where it is [s]. # (2, joints, 3)
        alarmed: time of the first alarm [s], None for none.
        first: statistic, joint and quantity that gave it, by their places.
    """

    def __init__(self, healthy: Healthy, false_alarms: float) -> None:
        """Prepare.

        Args:
            healthy: what blocks of the healthy machine are like.
            false_alarms: probability of any alarm of a healthy machine, however long it is watched.
        """
        self._healthy = healthy
        known = np.isfinite(healthy.deviation) & (healthy.deviation > 0.0) & (healthy.shape > 0.0)
        self._known = known
        self.threshold = math.log(len(STATISTICS) * max(int(known.sum()), 1) / false_alarms)
        shifts = np.array([sign * shift for shift in SHIFTS for sign in (1.0, -1.0)])
        self._shifts, self._spreads = shifts[:, None, None], np.array(SPREADS)[:, None, None]
        shape = known.shape
        self._logs = [np.full((n, *shape), -np.inf) for n in (len(shifts), len(SPREADS))]
        self._number = 0
        self.evidence = np.where(known, -np.inf, np.nan)[None].repeat(2, axis=0)
        self.since = np.full((2, *shape), np.nan)
        self.alarmed: float | None = None
        self.first: tuple[int, int, int] | None = None

    def add(self, block: Block) -> bool:
        """Take a block; whether it gives the first alarm."""
        self._number += 1
        h, weight = self._healthy, -math.log(self._number * (self._number + 1.0))
        with np.errstate(invalid="ignore"):
            m = block.mean / h.deviation
            q = block.square / h.square
        ratios = [
            self._shifts * m - 0.5 * self._shifts**2,
            h.shape * ((1.0 - 1.0 / self._spreads) * q - np.log(self._spreads)),
        ]
        for which, ratio in enumerate(ratios):
            told = np.where(np.isfinite(ratio), np.minimum(ratio, MOST_NATS), 0.0)
            self._logs[which] = told + np.logaddexp(self._logs[which], weight)
            of_all = np.logaddexp.reduce(self._logs[which], axis=0) - math.log(len(ratio))
            begun = of_all <= 0.0  # less than one: nothing has been seen
            begins = np.isnan(self.since[which]) & ~begun
            self.since[which] = np.where(begun, np.nan, self.since[which])
            self.since[which][begins] = block.begin
            self.evidence[which] = np.where(self._known, of_all, np.nan)
        if self.alarmed is not None or not np.nanmax(self.evidence, initial=-np.inf) >= self.threshold:
            return False
        first = np.unravel_index(int(np.nanargmax(self.evidence)), self.evidence.shape)
        self.alarmed, self.first = block.end, (int(first[0]), int(first[1]), int(first[2]))
        return True
