"""Machines in lanes with laws and inputs from outside: each does what it does alone."""

from dataclasses import replace

import numpy as np
import pytest
from lane_runs import STEP, assert_alike, drawn_law, driven, varied

from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.run import Run


def _side_by_side(count):
    """Machines with laws of as many terms, at any stage."""
    rig, rng = load_rig("joint_bench"), np.random.default_rng(5)
    times, volts = driven(3.0)
    runs = []
    while len(runs) < 2 * LANES:
        law = drawn_law(rng, count)
        runs.append(Run(varied(rig.records()[:1], rng, 1), times, volts, times, STEP, law=law))
    assert len({run.law["probe"][0] for run in runs}) > 5  # stages
    for one, run in zip(roll_out_lanes(runs, at_once=True), runs, strict=True):
        assert_alike(one, run.outcome())


@pytest.mark.long("a third of a minute for each count: a loop is compiled")
@pytest.mark.parametrize("count", [1, 2, 5])
def test_laws_of_different_factors_side_by_side(count):
    _side_by_side(count)


def _outside(rng, seconds, spacing, only=()):
    """Inputs from outside that wander; `only` these, or all."""
    sizes = [0.3, 0.05, 0.05, 1e5, 200.0, 40.0, 1e-3, 1e-5, 1e-13, 1e-13, 0.05, 0.05, 1e-3, 1e-3, 0.05]
    rows = np.array(sizes) * rng.uniform(0.0, 1.0, (int(seconds / spacing) + 1, len(PROBES)))
    if only:
        rows[:, [i for i, name in enumerate(PROBES) if name not in only]] = 0.0
    return spacing, rows


def _probed(rig, law=None):
    """Machines with inputs of their own, most of them pulled, some of which end before the rollout does."""
    rng = np.random.default_rng(8)
    runs = []
    for i in range(LANES + 2):
        seconds = 3.0 + 0.2 * i
        times, volts = driven(seconds, seed=i)
        only = (PROBES[i],) if i % 2 else ()
        measured = np.column_stack([0.02 * rng.standard_normal(times.size), np.full((times.size, 2), 5e6)])
        runs.append(
            Run(
                varied(rig.records()[:1], rng, 1),
                times + 0.3 * i,
                volts,
                times + 0.3 * i,
                STEP * (1 + i % 2),
                probes=_outside(rng, seconds - 0.5 * (i % 2), 0.0037 * (1 + i), only),
                pull=(0.1, measured) if i % 3 else None,
                law=None if law is None else law(rng),
            )
        )
    runs[2] = replace(runs[2], probes=(0.01, runs[2].probes[1][:1]))  # one that stays
    runs[4] = replace(runs[4], probes=runs[5].probes)
    for one, run in zip(roll_out_lanes(runs, at_once=True), runs, strict=True):
        assert one.diverged is None
        assert_alike(one, run.outcome())


@pytest.mark.long("a loop is compiled")
def test_each_lane_has_its_own_inputs_from_outside_also_where_it_is_pulled():
    _probed(load_rig("joint_bench"))


@pytest.mark.long("a minute: loops of three kinds are compiled")
@pytest.mark.parametrize("name", ["joint_bench", "hydrolek_right_j2"])
def test_inputs_from_outside_beside_laws(name):
    rig = load_rig(name)
    _probed(rig, lambda rng: drawn_law(rng, 1))
