"""Rollouts of several threads in common tables of lanes: each gets its own, whatever happens to the others."""

import threading
from concurrent.futures import wait
from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.sharing import shared_map
from hydrolek_drake.physics.records import flat, position_of
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import pool as pool_module
from hydrolek_drake.rollout.kernel import SIGNALS
from hydrolek_drake.rollout.lanes import lanes
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.pool import RolloutPool
from hydrolek_drake.rollout.run import Run

STEP = 5e-4


@pytest.fixture(scope="module")
def runs():
    """Machines of one kind whose supplies differ."""
    record = load_rig("joint_bench").records()[:1]
    times = np.arange(0.0, 2.0, 0.01)
    volts = np.repeat(np.random.default_rng(1).uniform(-4.0, 4.0, 10), 20)
    records = np.repeat(record, 40)
    flat(records)[:, position_of("supply", "pressure")] *= np.linspace(0.9, 1.1, 40)
    made = Run(record, times, volts, times, STEP).of(records)
    roll_out_lanes(made[:1], at_once=True)  # compiled
    return made


def _alike(done, run):
    alone = run.outcome()
    assert done.diverged == alone.diverged
    for name in SIGNALS:
        np.testing.assert_array_equal(getattr(done.signals, name), getattr(alone.signals, name))


def test_what_threads_ask_for_one_after_the_other_is_rolled_out_in_full_tables(runs, monkeypatch):
    sizes = []
    table = lanes.one_table
    monkeypatch.setattr(
        pool_module,
        "one_table",
        lambda kind, some, laws: sizes.append(len(some)) or table(kind, some, laws),
    )
    monkeypatch.setattr(pool_module, "PATIENCE_S", 60.0)  # however slowly a busy computer wakes the threads
    all_begun = threading.Barrier(LANES)

    def search(first):
        """Four rollouts, each asked for when the one before is known."""
        all_begun.wait(60.0)
        return [roll_out_lanes([run])[0] for run in runs[first : first + 4]]

    with RolloutPool(1) as pool:
        found = list(pool.map(search, range(0, 4 * LANES, 4)))
    for first, outcomes in zip(range(0, 4 * LANES, 4), found, strict=True):
        for run, done in zip(runs[first : first + 4], outcomes, strict=True):
            _alike(done, run)
    assert sizes == [LANES] * 4


def test_a_run_that_cannot_be_made_ends_only_who_asked_for_it(runs):
    backwards = replace(runs[0], times=runs[0].times[::-1].copy())
    with RolloutPool(1) as pool:
        bad = pool.submit(roll_out_lanes, [backwards])
        good = [pool.submit(roll_out_lanes, [run]) for run in runs[:6]]
        with pytest.raises(InputError, match="must rise"):
            bad.result()
        for future, run in zip(good, runs, strict=False):
            _alike(future.result()[0], run)


def test_who_waits_for_others_keeps_nobody_waiting(runs):
    """Work that shares pieces with the pool, and asks for rollouts itself."""

    def shared(first):
        pieces = shared_map(pool, lambda run: roll_out_lanes([run])[0], runs[first : first + 3])
        return [*pieces, *roll_out_lanes(runs[first + 3 : first + 6])]

    with RolloutPool(2) as pool:
        futures = [pool.submit(shared, first) for first in range(0, 36, 6)]
        assert not wait(futures, timeout=120.0).not_done
        for first, future in zip(range(0, 36, 6), futures, strict=True):
            for run, done in zip(runs[first : first + 6], future.result(), strict=True):
                _alike(done, run)
