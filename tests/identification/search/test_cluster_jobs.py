"""Whole jobs on a Dask cluster: every one ends once, whatever dies."""

import os
import signal

import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.identification.search.cluster_jobs import ClusterJobs


def _root(offset: float, number: float) -> float:
    if number < 0.0:
        raise ValueError("no root of a negative number")
    return offset + number**0.5


def _dies_the_first_time(marker: str, number: int) -> int:
    """Kills its worker unless an earlier try has."""
    try:
        with open(f"{marker}_{number}", "x"):
            pass
    except FileExistsError:
        return number
    os.kill(os.getpid(), signal.SIGKILL)
    return -1


def test_every_job_ends_once_and_a_failure_is_its_own(cluster):
    taken = []

    def jobs():
        for number in [4.0, -1.0, 9.0, *range(20)]:
            taken.append(number)
            yield number, (shared, float(number))

    with ClusterJobs(cluster.scheduler_address) as there:
        shared = there.shared(100.0)
        ended = []
        for number, result in there.done(_root, jobs()):
            ended.append((number, result))
            assert len(taken) <= len(ended) + 3  # two for each thread are under way: others are not even read
    assert sorted(n for n, _ in ended) == sorted(taken)
    for number, result in ended:
        if number < 0.0:
            assert isinstance(result, ValueError) and "negative" in str(result)
        else:
            assert result == 100.0 + number**0.5


@pytest.mark.thorough
def test_a_worker_that_dies_costs_what_it_had_at_hand(cluster, tmp_path):
    marker = str(tmp_path / "died")
    jobs = [(number, (marker if number == 3 else str(tmp_path / "no"), number)) for number in range(8)]
    for number in range(8):
        if number != 3:
            (tmp_path / f"no_{number}").touch()
    with ClusterJobs(cluster.scheduler_address) as there:
        ended = dict(there.done(_dies_the_first_time, jobs))
    assert ended == {number: number for number in range(8)}
    assert (tmp_path / "died_3").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["challenge", "--cluster", "tcp://127.0.0.1:1", "--workers", "2"], "no --workers"),
        (["watch", "joint_bench", "a.csv", "--live", "b.csv", "--cluster", "tcp://127.0.0.1:1"], "no --live"),
    ],
)
def test_contradictions_are_told_in_one_line(arguments, said, capsys):
    assert run(arguments) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
