"""Machines in lanes: each does what it does alone, whatever its neighbours are or do."""

from dataclasses import replace

import numpy as np
import pytest
from lane_runs import SIZES, STEP, assert_alike, driven, in_lanes, varied, with_effect

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.kernel import SIGNALS
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.rest import rest_state_at_reading
from hydrolek_drake.rollout.rollout import roll_out
from hydrolek_drake.rollout.run import Run


def _one_by_one(records, times, volts, **named):
    return [roll_out(records[i : i + 1], times, volts, times, **named) for i in range(len(records))]


def _assert_as_alone(records, times, volts, step):
    found = in_lanes(records, times, volts, longest_step=step)
    for one, other in zip(found, _one_by_one(records, times, volts, longest_step=step), strict=True):
        assert_alike(one, other)


def test_every_lane_does_what_it_does_alone_and_goes_on_from_where_it_ended():
    rig, rng = load_rig("hydrolek_right_j2"), np.random.default_rng(1)
    records = varied(rig.records()[:1], rng, LANES + 3)  # more than one table's
    times, volts = driven(8.0)
    found = in_lanes(records, times, volts, longest_step=STEP)
    alone = _one_by_one(records, times, volts, longest_step=STEP)
    for one, other in zip(found, alone, strict=True):
        assert_alike(one, other)
    later = times + 8.0
    runs = Run(records[:1], later, volts, later, STEP).of(records)
    onward = roll_out_lanes(
        [replace(run, state=one.state) for run, one in zip(runs, found, strict=True)], at_once=True
    )
    for i, one in enumerate(onward):
        assert_alike(
            one, roll_out(records[i : i + 1], later, volts, later, state=alone[i].state, longest_step=STEP)
        )


MIXED = ("cylinder.coulomb_friction",)


@pytest.mark.long("half a minute: loops of two kinds are compiled")
def test_a_batch_of_machines_with_other_effects():
    """An effect that is a program of its own, and some that are not, side by side; all of them: `--long`."""
    rig = load_rig("hydrolek_right_j2")
    effects = (
        *MIXED,
        "supply.pressure_droop",
        "cylinder.cross_port_leakage",
        "sensor.hysteresis",
        "command.delay",
    )
    records = np.concatenate(
        [rig.records()[:1], *(with_effect(rig, effect).records()[:1] for effect in effects)]
    )
    times, volts = driven(5.0)
    _assert_as_alone(records, times, volts, STEP)


@pytest.mark.long("half a minute: a loop is compiled")
def test_machines_with_a_pump_and_four_edges():
    rig, rng = load_rig("hopsan_link"), np.random.default_rng(8)
    records = varied(rig.records()[:1], rng, LANES)
    records["supply"]["relief_hysteresis"][::2] = 0.0
    times, volts = driven(5.0)
    _assert_as_alone(records, times, volts, STEP)


@pytest.mark.long("five minutes: every effect on every joint, the programs of all kinds compiled")
@pytest.mark.parametrize(
    "name",
    ["joint_bench", "emps", "festo_tp511", "patu_lift", "hopsan_link"]
    + [f"hydrolek_{side}_j{n}" for side in ("right", "left") for n in range(1, 6)],
)
def test_every_effect_on_every_machine_for_40_seconds(name):
    rig = load_rig(name)
    machines = [rig]
    for effect in SIZES:
        try:
            machines.append(with_effect(rig, effect))
        except InputError:
            continue  # it does not act on this machine
    records = np.concatenate([machine.records()[:1] for machine in machines])
    times, volts = driven(40.0)
    step = rig.value("integration.longest_step")
    _assert_as_alone(records, times, volts, step)


def test_a_lane_that_diverges_or_has_no_number_disturbs_no_other_by_a_bit():
    rig, rng = load_rig("joint_bench"), np.random.default_rng(2)
    records = varied(rig.records()[:1], rng, LANES)
    times, volts = driven(4.0)
    good = in_lanes(records, times, volts, longest_step=STEP)
    spoiled = records.copy()
    spoiled[2]["supply"]["pressure"] = 1e16
    spoiled[5]["load"]["inertia"] = np.nan
    spoiled[6]["fluid"]["density"] = 0.0
    found = in_lanes(spoiled, times, volts, longest_step=STEP)
    assert "left all bounds at" in found[2].diverged
    assert found[5].diverged == "load.inertia is not a number (NaN)"
    assert found[6].diverged == "a parameter by which something is divided is zero"
    for i in (0, 1, 3, 4, 7):
        for name in SIGNALS:
            np.testing.assert_array_equal(getattr(found[i].signals, name), getattr(good[i].signals, name))


def test_a_lane_that_cannot_begin_disturbs_no_other():
    """A play without stiffness, on a machine whose rig says nothing of one."""
    rig = load_rig("joint_bench")
    records = varied(rig.records()[:1], np.random.default_rng(2), 4)
    records[1]["effects"]["linkage_backlash"]["gap_rad"] = 0.005
    records[1]["linkage"]["play_stiffness"] = 0.0
    records[2]["linkage"]["direction"] = 0.0
    times, volts = driven(1.0)
    found = in_lanes(records, times, volts, longest_step=STEP)
    for one, other in zip(found, _one_by_one(records, times, volts, longest_step=STEP), strict=True):
        assert one.diverged == other.diverged
    assert [one.diverged is None for one in found] == [True, False, False, True]


def test_each_lane_has_its_own_recording_start_step_pull_and_time_constant():
    rig, rng = load_rig("joint_bench"), np.random.default_rng(4)
    records = varied(rig.records()[:1], rng, 7)
    runs = []
    for i in range(7):
        times, volts = driven(1.0 + 0.7 * i, seed=i)
        measured = np.column_stack([0.02 * rng.standard_normal(times.size), np.full((times.size, 2), 5e6)])
        measured[10:20, 0] = np.nan
        runs.append(
            Run(
                records[i : i + 1],
                times,
                volts,
                times[:: 1 + i % 2] + 0.003 * (i % 3),
                STEP * (1 + i % 2),
                state=rest_state_at_reading(records[i : i + 1], 0.01 * i),
                pull=(0.03 * (i + 1), measured[:: 1 + i % 2]) if i % 3 else None,
            )
        )
    for one, run in zip(roll_out_lanes(runs, at_once=True), runs, strict=True):
        assert_alike(one, run.outcome())


def test_rows_that_are_far_and_unevenly_apart():
    rig = load_rig("joint_bench")
    records = varied(rig.records()[:1], np.random.default_rng(6), 4)
    command_times, volts = driven(6.0)
    times = np.array([0.0, 0.003, 0.5, 0.51, 2.0, 2.0001, 5.0])
    runs = Run(records[:1], command_times, volts, times, STEP).of(records)
    for i, one in enumerate(roll_out_lanes(runs, at_once=True)):
        assert_alike(one, roll_out(records[i : i + 1], command_times, volts, times, longest_step=STEP))


def test_times_that_do_not_rise_are_refused():
    rig = load_rig("joint_bench")
    with pytest.raises(InputError, match="must rise"):
        roll_out_lanes(
            [Run(rig.records()[:1], np.zeros(1), np.zeros(1), np.array([1.0, 0.5]), STEP)], at_once=True
        )
