"""Rollouts of a diagnosis that a Dask cluster makes: the same, and a worker that dies costs what it had at hand."""

import os
import signal
import threading

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.identification.search.cluster_pool import ClusterPool
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.run import Run


@pytest.mark.thorough
def test_machines_do_the_same_on_a_cluster_one_worker_of_which_is_killed(cluster, bench):
    joint = bench.records()[:1]
    times = np.arange(0.0, 20.0, 0.01)
    runs = [Run(joint, np.array([0.0, 0.5 + 0.1 * i]), np.array([0.0, 3.0]), times, 1e-3) for i in range(4)]
    here = roll_out_lanes(runs)
    victim = next(iter(cluster.workers.values())).pid
    with ClusterPool(cluster.scheduler_address) as pool:
        assert pool.cores == 2
        threading.Timer(0.2, os.kill, (victim, signal.SIGKILL)).start()
        asked = [pool.submit(roll_out_lanes, runs) for _ in range(6)]
        for there in (future.result() for future in asked):
            for one, other in zip(there, here, strict=True):
                np.testing.assert_array_equal(one.signals.reading, other.signals.reading)


def test_an_address_and_a_number_of_threads_contradict_each_other(capsys):
    status = run(["diagnose", "joint_bench", "none.csv", "--cluster", "tcp://127.0.0.1:1", "--workers", "2"])
    error = capsys.readouterr().err
    assert status == 2 and "give one of them" in error and error.count("\n") == 1
