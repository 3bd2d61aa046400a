"""When a loop over lanes is compiled: beside the work, in a process of its own, once it would have been worth it.

A loop for another kind of machine takes some 15 s of processor time to compile, as long as a thousand rollouts; it
then lies on disk for all runs to come. Nobody waits for it: until it is there, machines are rolled out one by one,
which gives the same numbers to the last bit (`tests/rollout/test_lanes.py`).
"""

import contextlib
import hashlib
import subprocess
import sys
import threading
from collections import Counter
from pathlib import Path

import numba
import numpy as np
from llvmlite.binding import get_host_cpu_name

from hydrolek_drake.rollout.lanes.view import Kind

WORTH = 200
"""Machines of a kind that have been asked for before its loop is compiled: a fit of some steps, and no single look."""

WORTH_TOGETHER = 40
"""The same of machines with joints of a kind that move together, which take longer: some Jacobians."""

_lock = threading.Lock()
_ready: set[str] = set()
_asked: Counter[str] = Counter()
_running: list[subprocess.Popen[bytes]] = []


def ready(kind: Kind, joint: np.ndarray, law: np.ndarray | None, count: int, spool_steps: int) -> bool:
    """Whether the loop of a kind is there; if it is not and has become worth it, a process begins to compile it.

    Args:
        kind: of the machines.
        joint: record of one of them, shape (1,).
        law: of that one, rows of `law.LAW`, or None.
        count: how many are to be rolled out now.
        spool_steps: as of `roll_out`.
    """
    with _lock:
        if kind.name in _ready or _mark(kind).exists():
            _ready.add(kind.name)
            return True
        _asked[kind.name] += count
        _running[:] = [process for process in _running if process.poll() is None]
        if _asked[kind.name] >= (WORTH_TOGETHER if kind.together else WORTH) and not _running:
            _asked[kind.name] = 0  # should it fail, it is tried again after as many
            with contextlib.suppress(OSError):
                _running.append(_begin(joint, law, spool_steps, kind.probed, kind.together))
        return False


def compiled(kind: Kind) -> None:
    """Take note that the loop of a kind has been compiled, and is kept on disk."""
    with _lock:
        _ready.add(kind.name)
        with contextlib.suppress(OSError):
            _mark(kind).touch()


def _mark(kind: Kind) -> Path:
    processor = numba.config.CPU_NAME or get_host_cpu_name()  # a home folder may be that of several computers
    # numba keeps what it compiles by the place of the source, of which there may be several copies
    place = hashlib.sha256(str(Path(__file__).resolve()).encode()).hexdigest()[:8]
    return Path(numba.config.CACHE_DIR or ".") / f"lanes_{kind.name}_{processor}_{place}"


def _begin(
    joint: np.ndarray,
    law: np.ndarray | None,
    spool_steps: int,
    probed: bool = False,
    together: bool = False,
) -> "subprocess.Popen[bytes]":
    """A process that compiles the loop for machines of a joint's kind, and outlives this one if need be."""
    told = (spool_steps, int(probed), int(together))
    process = subprocess.Popen(
        [sys.executable, "-m", "hydrolek_drake.rollout.lane_program", *map(str, told)],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # Ctrl-C is for the work, not for what it leaves for later
    )
    assert process.stdin is not None  # it is a pipe
    with contextlib.suppress(BrokenPipeError), process.stdin as to:
        to.write(joint.tobytes() + (b"" if law is None else law.tobytes()))
    return process
