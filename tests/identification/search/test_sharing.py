"""Work shared among threads: order, no deadlock when the callers are the pool's own threads, errors."""

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.identification.sharing import shared_map


def test_callers_that_fill_the_pool_do_the_work_themselves() -> None:
    with ThreadPoolExecutor(2) as pool:

        def outer(first: int) -> list[int]:
            return shared_map(pool, lambda n: first + n * n, range(5))

        done = [f.result(timeout=30.0) for f in [pool.submit(outer, first) for first in range(20)]]
    assert done == [[first + n * n for n in range(5)] for first in range(20)]


def test_idle_threads_take_their_share() -> None:
    both = threading.Barrier(2, timeout=30.0)
    with ThreadPoolExecutor(1) as pool:
        names = shared_map(pool, lambda _: (both.wait(), threading.current_thread().name)[1], range(2))
    assert len(set(names)) == 2


def test_an_error_comes_out_and_the_rest_is_not_begun() -> None:
    begun: list[int] = []

    def work(n: int) -> int:
        begun.append(n)
        if n == 0:
            raise ValueError("broken")
        return n

    busy = threading.Event()
    with ThreadPoolExecutor(1) as pool:
        pool.submit(busy.wait, 30.0)
        with pytest.raises(ValueError, match="broken"):
            shared_map(pool, work, range(4))
        busy.set()
    assert begun == [0]


def test_nothing_to_do() -> None:
    with ThreadPoolExecutor(1) as pool:
        assert shared_map(pool, lambda n: n, []) == []


def test_after_its_pool_was_shut_down_the_caller_does_everything() -> None:
    with ThreadPoolExecutor(2) as pool:
        pass
    assert shared_map(pool, lambda n: n * n, range(4)) == [0, 1, 4, 9]
