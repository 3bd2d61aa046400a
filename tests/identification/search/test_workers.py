"""Evaluations over processes and over a Dask cluster: same values, and nothing that happens to one stops it."""

import os
import signal
import time

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.search import search
from hydrolek_drake.identification.search.cluster import ClusterWorkers
from hydrolek_drake.identification.search.workers import ProcessWorkers, ThreadWorkers, chunks_of


class Bowl:
    """Objective that can be sent; does bad things at certain places."""

    size = 1

    def __init__(self, evil=None):
        self.evil = evil

    def __call__(self, point):
        if self.evil == "dies" and point[0] > 0.9:
            os.kill(os.getpid(), signal.SIGKILL)
        if self.evil == "hangs" and point[0] > 0.9:
            time.sleep(60.0)
        if self.evil == "fails" and point[0] > 0.9:
            raise ValueError("no solution")
        return np.array([np.sum((point - 0.3) ** 2)])


POINTS = [np.array([x, 0.5]) for x in np.linspace(0.0, 1.0, 21)]


def expected(evil):
    return [None if evil and point[0] > 0.9 else Bowl()(point) for point in POINTS]


def same(found, wanted):
    return len(found) == len(wanted) and all(
        (a is None) == (b is None) and (a is None or np.array_equal(a, b))
        for a, b in zip(found, wanted, strict=True)
    )


@pytest.mark.parametrize("evil", [None, "fails", "dies"])
@pytest.mark.thorough(but=1)
def test_processes_give_the_values_in_order_and_lose_only_the_guilty(evil):
    with ProcessWorkers(Bowl(evil), 2) as evaluate:
        assert same(evaluate(POINTS), expected(evil))
        assert same(evaluate(POINTS[:3]), expected(evil)[:3])  # still at work


@pytest.mark.thorough
def test_an_overdue_evaluation_is_lost_and_the_others_are_not():
    with ProcessWorkers(Bowl("hangs"), 2, overdue=2.0) as evaluate:
        evaluate(POINTS[:2])  # the processes are up before time counts
        assert same(evaluate(POINTS[14:20]), expected("hangs")[14:20])


@pytest.mark.parametrize("workers", [ProcessWorkers, ThreadWorkers])
@pytest.mark.thorough(but=1)
def test_a_search_over_processes_or_threads_is_the_search_in_this_thread(workers):
    ends = np.zeros(2), np.ones(2)
    alone = search("de", Bowl(), *ends, 120, np.random.default_rng(0))
    with workers(Bowl(), 2) as evaluate:
        together = search("de", Bowl(), *ends, 120, np.random.default_rng(0), evaluate=evaluate)
    np.testing.assert_array_equal(alone.units, together.units)
    np.testing.assert_array_equal(alone.scores, together.scores)


def test_chunks_hold_every_point_once():
    chunks = chunks_of(23, 4)
    assert len(chunks) == 8
    np.testing.assert_array_equal(np.concatenate(chunks), np.arange(23))
    assert [len(chunk) for chunk in chunks_of(3, 4)] == [1, 1, 1]
    assert [len(chunk) for chunk in chunks_of(30, 2, 8)] == [8, 8, 8, 6]  # whole tables of lanes
    np.testing.assert_array_equal(np.concatenate(chunks_of(30, 2, 8)), np.arange(30))


@pytest.mark.thorough
def test_a_cluster_of_processes_one_of_which_is_killed_gives_the_same_search():
    from distributed import LocalCluster

    ends = np.zeros(2), np.ones(2)
    alone = search("de", Bowl(), *ends, 200, np.random.default_rng(0))
    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as cluster:
        victims = [worker.pid for worker in cluster.workers.values()]
        with ClusterWorkers(Bowl(), cluster.scheduler_address) as evaluate:
            rounds = []

            def killing(points):
                rounds.append(len(points))
                if len(rounds) == 3:
                    os.kill(victims[0], signal.SIGKILL)
                return evaluate(points)

            together = search("de", Bowl(), *ends, 200, np.random.default_rng(0), evaluate=killing)
            assert len(rounds) > 3
            # the objective that fails is a value here too
        with ClusterWorkers(Bowl("fails"), cluster.scheduler_address) as evaluate:
            assert same(evaluate(POINTS), expected("fails"))
    np.testing.assert_array_equal(alone.units, together.units)
    np.testing.assert_array_equal(alone.scores, together.scores)


def test_an_objective_that_a_cluster_has_lost_is_sent_again():
    from distributed import LocalCluster

    with (
        LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None, silence_logs=50
        ) as cluster,
        ClusterWorkers(Bowl(), cluster.scheduler_address) as evaluate,
    ):
        evaluate._client.cancel(evaluate._sent, force=True)
        assert same(evaluate(POINTS), expected(None))
        assert same(evaluate(POINTS), expected(None))


def test_a_cluster_that_is_not_there_is_refused(monkeypatch):
    monkeypatch.setattr("hydrolek_drake.identification.search.cluster.CONNECT_WITHIN", 1.0)
    with pytest.raises(InputError, match="no Dask scheduler answers there"):
        ClusterWorkers(Bowl(), "tcp://127.0.0.1:9")


def test_no_worker_is_refused():
    with pytest.raises(InputError, match="at least 1"):
        ProcessWorkers(Bowl(), 0)
