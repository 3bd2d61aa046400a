"""How far structures are behind the best one on held-out data, and how surely: differences with their standard error.

Residuals that lie close together err alike, so that the difference of two log-densities is summed over blocks of the
recordings, and its standard error is told by how these differ (Vehtari, Gelman, Gabry, Practical Bayesian model
evaluation, Statistics and Computing 27, 2017, section 5.1, with blocks in place of single values).
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.data.splitting import short_blocks
from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.identification.experiment import Experiment


def with_differences(judged: Sequence[Judged], held_out: Sequence[Experiment]) -> tuple[Judged, ...]:
    """The same, each with how far it is behind the first.

    Args:
        judged: structures with residuals on the held-out data, the most probable first.
        held_out: these data.
    """
    blocks = _blocks(held_out)
    best = 0.5 * judged[0].held_out ** 2
    told = []
    for each in judged:
        sums = np.bincount(blocks[blocks >= 0], (0.5 * each.held_out**2 - best)[blocks >= 0])
        sums = sums[np.unique(blocks[blocks >= 0])]
        error = math.sqrt(sums.size * float(np.var(sums, ddof=1))) if sums.size > 1 else math.inf
        told.append(replace(each, behind=float(sums.sum()), behind_error=error))
    return tuple(told)


def _blocks(held_out: Sequence[Experiment]) -> np.ndarray:
    """Number of the block of each residual; -1 of one that does not count. # (values,)."""
    parts, first = [], 0
    for experiment in held_out:
        own = np.where(experiment.used, short_blocks(experiment) + first, -1)
        parts.append(np.tile(own, len(experiment.channels)))
        first = max(int(own.max(initial=-1)) + 1, first)
    return np.concatenate(parts)
