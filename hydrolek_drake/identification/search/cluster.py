"""Evaluations over an existing Dask cluster (`dask scheduler`, `dask worker`), in chunks."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.search.workers import chunks_of, evaluate_chunk

CONNECT_WITHIN = 15.0
"""Seconds to reach the scheduler."""

RETRIES = 3
"""Times that a chunk is given to another worker when its own dies."""


def connected(address: str) -> Any:
    """A client of a cluster that has workers.

    Args:
        address: of the scheduler, such as tcp://host:8786.

    Raises:
        InputError: no scheduler there, or one without workers.
    """
    from distributed import Client

    try:
        client = Client(address, timeout=CONNECT_WITHIN)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"--cluster {address}: no Dask scheduler answers there; start one with 'dask scheduler' and "
            "give its address, such as tcp://host:8786"
        ) from error
    if not client.scheduler_info()["workers"]:
        client.close()
        raise InputError(f"--cluster {address}: the scheduler has no workers; start 'dask worker {address}'")
    return client


def threads_of(client: Any) -> int:
    """Threads that a cluster has, at least one; `client` as of `connected`."""
    return max(sum(client.nthreads().values()), 1)


class ClusterWorkers:
    """Maps an objective over points with a cluster's workers; use as a context manager."""

    def __init__(self, objective: Any, address: str, overdue: float | None = None) -> None:
        """Connect and send the objective to all workers.

        Args:
            objective: can be pickled; the workers must have this package installed.
            address: of the scheduler, such as tcp://host:8786.
            overdue: time that one evaluation may take [s]; None for any.

        Raises:
            InputError: no scheduler there, or one without workers.
        """
        self.overdue = overdue
        self._client = connected(address)
        self._objective = objective
        self._send()

    def __enter__(self) -> "ClusterWorkers":
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def __call__(self, points: Sequence[np.ndarray]) -> list[np.ndarray | None]:
        """Values in the order of the points; None for one that failed or was overdue."""
        threads = threads_of(self._client)
        chunks = chunks_of(len(points), threads, getattr(self._objective, "batch", 1))
        values: list[np.ndarray | None] = [None] * len(points)
        for chunk in self._round(points, chunks, values, threads):
            self._round(points, [np.array([i]) for i in chunk], values, threads)
        return values

    def _send(self) -> None:
        """Give the objective to all workers."""
        self._sent = self._client.scatter(self._objective, broadcast=True)

    def _round(
        self,
        points: Sequence[np.ndarray],
        chunks: list[np.ndarray],
        values: list[np.ndarray | None],
        threads: int,
    ) -> list[np.ndarray]:
        """Evaluate chunks; returns those that came to nothing."""
        futures = [
            self._client.submit(
                evaluate_chunk, self._sent, [points[i] for i in chunk], pure=False, retries=RETRIES
            )
            for chunk in chunks
        ]
        rounds = -(-len(chunks) // threads)
        longest = (
            None if self.overdue is None else self.overdue * rounds * max(len(chunk) for chunk in chunks)
        )
        self._wait(futures, longest)
        missed = []
        for chunk, future in zip(chunks, futures, strict=True):
            if future.status != "finished":
                missed.append(chunk)
                continue
            for i, value in zip(chunk, future.result(), strict=True):
                values[int(i)] = value
        return missed

    def _wait(self, futures: Sequence[Any], longest: float | None) -> None:
        """Until every future has a value, has failed, is overdue, or was lost with what it needs."""
        from distributed import TimeoutError as DaskTimeoutError
        from distributed import wait
        from distributed.client import FuturesCancelledError

        try:
            wait(futures, timeout=longest)
        except (DaskTimeoutError, TimeoutError):
            self._client.cancel([future for future in futures if not future.done()], force=True)
        except FuturesCancelledError:  # the objective was lost with a worker
            self._send()
            self._wait([future for future in futures if not future.cancelled()], longest)
