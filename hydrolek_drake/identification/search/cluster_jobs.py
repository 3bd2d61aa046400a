"""Whole jobs over an existing Dask cluster: each worker takes one, gives its result, and takes the next."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from hydrolek_drake.identification.search.cluster import RETRIES, connected, threads_of

AHEAD = 2
"""So many jobs for each thread of the cluster are under way: none waits for the next, and few stand in memory."""


class ClusterJobs:
    """A cluster that does whole jobs; use as a context manager."""

    def __init__(self, address: str) -> None:
        """Connect.

        Args:
            address: of the scheduler, such as tcp://host:8786; its workers must have this package installed.

        Raises:
            InputError: no scheduler there, or one without workers.
        """
        self._client = connected(address)

    def __enter__(self) -> "ClusterJobs":
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def shared(self, value: Any) -> Any:
        """What every job needs, sent once; it stands for the value among a job's arguments."""
        return self._client.scatter(value, broadcast=True)

    def done(
        self, work: Callable[..., Any], jobs: Iterable[tuple[Any, tuple[Any, ...]]]
    ) -> Iterator[tuple[Any, Any]]:
        """Results as they come.

        A worker that dies costs what it had at hand: its job is given to another one.

        Args:
            work: of the package, called by a worker.
            jobs: name and arguments of each; taken as workers have room.

        Yields:
            Name and result of each job; in place of the result the exception that it raised, or that its workers died.
        """
        from distributed import as_completed

        left = iter(jobs)
        names: dict[Any, Any] = {}
        running = as_completed([])
        room = AHEAD * threads_of(self._client)
        try:
            while True:
                while len(names) < room and (job := next(left, None)) is not None:
                    name, given = job
                    future = self._client.submit(work, *given, pure=False, retries=RETRIES)
                    names[future] = name
                    running.add(future)
                if not names:
                    return
                future = next(running)
                failure = future.exception() if future.status != "finished" else None
                yield names.pop(future), future.result() if failure is None else failure
        finally:
            self._client.cancel(list(names), force=True)
