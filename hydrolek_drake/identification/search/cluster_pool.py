"""Threads whose tables of lanes are rolled out by an existing Dask cluster."""

import contextlib
from collections.abc import Callable, Sequence
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from typing import Any

from hydrolek_drake.identification.search.cluster import RETRIES, connected, threads_of
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes, together_with
from hydrolek_drake.rollout.rollout import Outcome
from hydrolek_drake.rollout.run import Run


class ClusterPool(ThreadPoolExecutor):
    """Threads for work of which most is rollouts, as many as a cluster has."""

    def __init__(self, address: str) -> None:
        """Connect.

        Args:
            address: of the scheduler, such as tcp://host:8786; its workers must have this package installed.

        Raises:
            InputError: no scheduler there, or one without workers.
        """
        self._client = connected(address)
        self.cores = threads_of(self._client)
        self._tables = ClusterTables(self._client)
        super().__init__(self.cores)

    def submit(self, work: Callable[..., Any], /, *given: Any, **named: Any) -> Future[Any]:
        """As of `Executor`; what the work rolls out in lanes is rolled out by the cluster."""
        return super().submit(self._elsewhere, work, *given, **named)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """As of `Executor`; leaves the cluster."""
        super().shutdown(wait, cancel_futures=cancel_futures)
        self._client.close()

    def _elsewhere(self, work: Callable[..., Any], *given: Any, **named: Any) -> Any:
        with together_with(self._tables):
            return work(*given, **named)


class ClusterTables:
    """Rolls out machines on a cluster's workers; what the cluster loses is rolled out here."""

    def __init__(self, client: Any) -> None:
        """Keep the client.

        Args:
            client: of `cluster.connected`.
        """
        self._client = client

    def roll_out(self, runs: Sequence[Run]) -> list[Outcome]:
        """As of `roll_out_lanes`."""
        from distributed import KilledWorker
        from distributed.client import FuturesCancelledError
        from distributed.comm.core import CommClosedError

        try:
            future = self._client.submit(roll_out_lanes, list(runs), pure=False, retries=RETRIES)
            outcomes: list[Outcome] = future.result()
        except (KilledWorker, CommClosedError, CancelledError, FuturesCancelledError):
            with together_with(None):
                return roll_out_lanes(runs)
        return outcomes

    def waiting(self) -> contextlib.AbstractContextManager[None]:
        """While this thread waits for another one, which is no matter of the cluster's."""
        return contextlib.nullcontext()
