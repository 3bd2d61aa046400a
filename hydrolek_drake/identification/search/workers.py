"""Evaluations over threads or processes of this machine, in chunks; a lost or overdue one is a score, not an end."""

import contextlib
import multiprocessing
from collections.abc import Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.search.evaluation import attempt_all
from hydrolek_drake.rollout.pool import RolloutPool

CHUNKS_PER_WORKER = 2
"""Two, so that a slow chunk does not leave the others idle; more would only send more messages."""

_objective: Any = None  # of a worker process: sent once, not with each point


def chunks_of(count: int, workers: int, batch: int = 1) -> list[np.ndarray]:
    """Indices 0 ... count - 1 in nearly equal runs, `CHUNKS_PER_WORKER` for each worker.

    Args:
        count: of the indices.
        workers: that share them.
        batch: so many are evaluated at the price of one: no run is cut within a batch.
    """
    batches = np.array_split(np.arange(-(-count // batch)), CHUNKS_PER_WORKER * workers)
    ends = [(batch * int(each[0]), min(batch * (int(each[-1]) + 1), count)) for each in batches if each.size]
    return [np.arange(begin, end) for begin, end in ends]


def evaluate_chunk(objective: Any, points: list[np.ndarray]) -> list[np.ndarray | None]:
    """Values of several points, None for each that failed."""
    return attempt_all(objective, points)


def _prepare(objective: Any) -> None:
    global _objective
    _objective = objective


def _evaluate_here(points: list[np.ndarray]) -> list[np.ndarray | None]:
    return evaluate_chunk(_objective, points)


class ThreadWorkers:
    """Maps an objective over points with threads of this process; for what runs outside Python's lock."""

    def __init__(self, objective: Any, workers: int) -> None:
        """Begin; arguments as of `ProcessWorkers`."""
        self.objective = objective
        self.workers = workers
        self._pool = RolloutPool(workers)

    def __enter__(self) -> "ThreadWorkers":
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.shutdown(cancel_futures=True)

    def __call__(self, points: Sequence[np.ndarray]) -> list[np.ndarray | None]:
        """Values in the order of the points; None for one that failed."""
        chunks = chunks_of(len(points), self.workers, getattr(self.objective, "batch", 1))
        futures = [
            self._pool.submit(evaluate_chunk, self.objective, [points[i] for i in chunk]) for chunk in chunks
        ]
        return [value for future in futures for value in future.result()]


class ProcessWorkers:
    """Maps an objective over points with processes; use as a context manager."""

    def __init__(self, objective: Any, workers: int, overdue: float | None = None) -> None:
        """Start the processes.

        Args:
            objective: can be pickled.
            workers: processes.
            overdue: time that one evaluation may take [s]; None for any.

        Raises:
            InputError: fewer than one worker.
        """
        if workers < 1:
            raise InputError(f"--workers {workers}: at least 1 is needed")
        self.objective = objective
        self.workers = workers
        self.overdue = overdue
        self._pool = self._start()

    def __enter__(self) -> "ProcessWorkers":
        return self

    def __exit__(self, *_: object) -> None:
        self._kill()

    def __call__(self, points: Sequence[np.ndarray]) -> list[np.ndarray | None]:
        """Values in the order of the points; None for one that failed, was lost twice, or was overdue."""
        values: list[np.ndarray | None] = [None] * len(points)
        chunks = chunks_of(len(points), self.workers, getattr(self.objective, "batch", 1))
        futures = {self._submit([points[i] for i in chunk]): chunk for chunk in chunks}
        rounds = -(-len(chunks) // self.workers)
        longest = (
            None if self.overdue is None else self.overdue * rounds * max(len(chunk) for chunk in chunks)
        )
        done, late = wait(futures, timeout=longest)
        again = [chunk for future, chunk in futures.items() if not self._collect(future, done, chunk, values)]
        if again:
            self._restart(bool(late))
        for i in (int(i) for chunk in again for i in chunk):  # one at a time: only the guilty one is lost
            future = self._submit([points[i]])
            done, late = wait([future], timeout=self.overdue)
            if not self._collect(future, done, np.array([i]), values):
                self._restart(bool(late))
        return values

    def _submit(self, points: list[np.ndarray]) -> "Future[list[np.ndarray | None]]":
        try:
            return self._pool.submit(_evaluate_here, points)
        except RuntimeError:  # a worker was killed meanwhile, which breaks the pool
            self._restart(False)
            return self._pool.submit(_evaluate_here, points)

    @staticmethod
    def _collect(future: Any, done: Any, chunk: np.ndarray, values: list[np.ndarray | None]) -> bool:
        if future not in done or future.cancelled() or future.exception() is not None:
            return False
        for i, value in zip(chunk, future.result(), strict=True):
            values[int(i)] = value
        return True

    def _start(self) -> ProcessPoolExecutor:
        context = multiprocessing.get_context("spawn")  # a fork of a process with threads may hang
        return ProcessPoolExecutor(
            self.workers, mp_context=context, initializer=_prepare, initargs=(self.objective,)
        )

    def _restart(self, late: bool) -> None:
        broken = getattr(self._pool, "_broken", False)
        if late or broken:
            self._kill()
            self._pool = self._start()

    def _kill(self) -> None:
        processes = list((getattr(self._pool, "_processes", None) or {}).values())
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            with contextlib.suppress(Exception):
                process.kill()
                process.join()
