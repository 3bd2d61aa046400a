"""Commands and tests leave the cores to rollouts: the linear algebra under them has one thread."""

import os
import subprocess
import sys

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from hydrolek_drake.cli.app import run
from hydrolek_drake.cli.machines import rigs
from hydrolek_drake.linear_algebra import VARIABLE


def _threads() -> set[int]:
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_a_command_has_one_thread_and_leaves_the_caller_what_he_had(monkeypatch) -> None:
    seen: list[set[int]] = []
    monkeypatch.setattr(rigs, "rigs", lambda: seen.append(_threads()))
    with threadpool_limits(limits=2, user_api="blas"):
        assert run(["rigs"]) == 0
        assert seen == [{1}] and _threads() == {2}


@pytest.mark.parametrize(("given", "told"), [(None, 1), ("2", 2)])
def test_what_is_loaded_later_has_one_too_unless_the_environment_says_otherwise(given, told) -> None:
    program = (
        "from hydrolek_drake.linear_algebra import in_one_thread; in_one_thread(); import scipy.linalg;"
        "from threadpoolctl import threadpool_info;"
        "print([p['num_threads'] for p in threadpool_info() if 'scipy.libs' in p['filepath']])"
    )
    environment = {name: value for name, value in os.environ.items() if name != VARIABLE}
    if given is not None:
        environment[VARIABLE] = given
    if told > (os.cpu_count() or 1):
        pytest.skip("this machine has one core")
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True)
    assert done.stdout.strip() == f"[{told}]"
