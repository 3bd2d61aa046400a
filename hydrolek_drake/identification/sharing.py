"""Work shared with a pool by one of its own threads, without waiting for what nobody has begun."""

import contextlib
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, wait
from typing import TypeVar

from hydrolek_drake.rollout.lanes.lanes import sharing

Item = TypeVar("Item")
Result = TypeVar("Result")


def shared_map(pool: Executor, work: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    """Results of independent pieces of work, in their order.

    Idle threads of the pool take pieces; the caller does those that none has taken. So a thread of the pool may
    itself call this: where all are busy it does everything alone, and no thread ever waits for a piece that is
    not being worked on. Where the pool has been shut down, the caller does everything: what computes a Jacobian when it
    is first asked for (`Fit.jacobian`) may outlive it.

    Args:
        pool: threads.
        work: must not wait for further work of the pool.
        items: what it is called with.

    Raises:
        Exception: the first piece's that fails; the rest is cancelled first.
    """
    try:
        futures = [pool.submit(work, item) for item in items[1:]]
    except RuntimeError:  # shut down
        return [work(item) for item in items]
    try:
        results = [work(item) for item in items[:1]]
        for item, future in zip(items[1:], futures, strict=True):
            if future.cancel():
                results.append(work(item))
            else:
                with _waiting():
                    results.append(future.result())
        return results
    except BaseException:
        running = [future for future in futures if not future.cancel()]
        wait(running)
        raise


def _waiting() -> contextlib.AbstractContextManager[None]:
    """While this thread waits, its pool need not wait for what it would roll out."""
    tables = sharing()
    return contextlib.nullcontext() if tables is None else tables.waiting()
