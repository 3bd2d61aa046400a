"""How innovations answer to an input that is moved at knots: the columns of the matrix A of `unknown_input`.

An observer forgets within some of its time constants T, so that knots which lie far enough apart can be moved in one
rollout: the columns of A of all knots take as many rollouts as there are knots within that time (a coloured Jacobian;
Curtis, Powell, Reid, IMA Journal of Applied Mathematics 13 (1974) 117).
"""

import math
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import ClassVar, Protocol

import numpy as np
from scipy.sparse import csc_matrix

from hydrolek_drake.diagnosis.settings import LOCATING
from hydrolek_drake.diagnosis.structures.inputs import Input
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.rollout import Signals
from hydrolek_drake.rollout.run import Run

ABREAST = 64
"""So many knots' responses are multiplied at once."""


class Trial(Protocol):
    """How an input is moved at knots.

    Attributes:
        share: of the input's unit that is tried.
        spacing_s: between knots [s].
    """

    share: ClassVar[float]
    spacing_s: ClassVar[float]

    @property
    def input(self) -> Input:
        """Where it enters, and as what."""
        ...

    def run(
        self, experiment: Experiment, records: np.ndarray, step: float, pull: float | None, moved: np.ndarray
    ) -> Run:
        """The rollout of a recording in which it is moved.

        Args:
            experiment: the recording.
            records: of the joints.
            step: of the integration [s].
            pull: time constant of the observer [s]; None for a free rollout.
            moved: at which knots. # (k,) truth values
        """
        ...


def response(
    pool: Executor,
    experiment: Experiment,
    records: np.ndarray,
    step: float,
    observer_s: float,
    trial: Trial,
    still: np.ndarray,
) -> tuple[csc_matrix, np.ndarray]:
    """How the innovations of a recording answer to each knot, in units of the trial, and the knots' times.

    Args:
        pool: threads.
        experiment: the recording.
        records: of the joints.
        step: of the integration [s].
        observer_s: time constant of the observer [s]; infinite for free rollouts, of which each knot takes one.
        trial: how the input is moved.
        still: innovations while it is not. # (n,)

    Returns:
        A of the recording # (n, k), and times [s] # (k,).
    """
    time, spacing = experiment.time, trial.spacing_s
    count = int(np.ceil((time[-1] - time[0]) / spacing)) + 1
    apart = (
        count + 1 if math.isinf(observer_s) else int(np.ceil(LOCATING.forgotten * observer_s / spacing)) + 2
    )
    pull = None if math.isinf(observer_s) else observer_s
    runs = [
        trial.run(experiment, records, step, pull, np.arange(count) % apart == first)
        for first in range(min(apart, count))
    ]
    answers = rolled(runs, pool)
    channels, samples = len(experiment.channels), time.size
    knot_of_sample = (time - time[0]) / spacing
    data, row_indices, pointers = [], [], [0]
    changes = [
        np.nan_to_num((experiment.residuals(signals) - still) / trial.share).reshape(channels, samples)
        for signals in answers
    ]
    for knot in range(count):
        begin, end = np.searchsorted(knot_of_sample, (knot - 1.0, knot - 1.0 + apart))
        part = changes[knot % apart][:, begin:end]
        rows_here = (np.arange(channels)[:, None] * samples + np.arange(begin, end)[None, :]).ravel()
        data.append(part.ravel())
        row_indices.append(rows_here)
        pointers.append(pointers[-1] + rows_here.size)
    matrix = csc_matrix(
        (np.concatenate(data), np.concatenate(row_indices), np.array(pointers)),
        shape=(channels * samples, count),
    )
    return matrix, time[0] + spacing * np.arange(count)


def squared(responses: csc_matrix) -> np.ndarray:
    """The products of all responses with each other; those of knots that lie far apart have no value in common.

    Responses that overlap are nearly full, so that dense products of some of them with those that begin before they end
    are many times as fast as a product of sparse matrices. # (k, k)

    Args:
        responses: of all knots, in their order. # (n, k)
    """
    count = responses.shape[1]
    squared = np.zeros((count, count))
    touched = [np.unique(responses[:, at : at + ABREAST].indices) for at in range(0, count, ABREAST)]
    for number, rows in enumerate(touched):
        at = number * ABREAST
        end = at + ABREAST
        for later in touched[number + 1 :]:
            if not np.isin(later, rows, assume_unique=True, kind="sort").any():
                break
            end += ABREAST
        near = responses[:, at : min(end, count)][rows].toarray()
        product = near[:, :ABREAST].T @ near
        squared[at : at + product.shape[0], at : at + product.shape[1]] = product
        squared[at : at + product.shape[1], at : at + product.shape[0]] = product.T
    return squared


def rolled(runs: Sequence, pool: Executor) -> list[Signals]:
    """Signals of some rollouts, in lanes on several cores.

    Args:
        runs: rollouts.
        pool: threads.
    """
    chunks = [runs[at : at + LANES] for at in range(0, len(runs), LANES)]
    return [outcome.signals for part in pool.map(roll_out_lanes, chunks) for outcome in part]
