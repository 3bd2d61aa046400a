"""Machines in lanes: each does what it does alone, whatever its neighbours are or do."""

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.law import LAW, OTHERS, PLACES, SPEEDS, TERM_NAMES, TIMES
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.physics.records import flat, position_of
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.kernel import SIGNALS
from hydrolek_drake.rollout.lanes import compiling as lane_compiling
from hydrolek_drake.rollout.lanes.kinds import kind_of
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.rest import rest_state_at_reading
from hydrolek_drake.rollout.rollout import roll_out, with_own
from hydrolek_drake.rollout.run import Run

SIZES = json.loads((Path(__file__).parents[2] / "scripts" / "agreement_effects.json").read_text())
STEP = 5e-4


def _driven(seconds, seed=3):
    times = np.arange(0.0, seconds, 0.01)
    levels = np.random.default_rng(seed).uniform(-4.0, 4.0, size=times.size // 23 + 1)
    return times, np.repeat(levels, 23)[: times.size]


def _with(rig, effect):
    record = rig.records()[0]
    scale = {
        "force": float(record["cylinder"]["area_a"] * record["supply"]["pressure"]),
        "inertia": float(record["load"]["inertia"]),
        "friction": float(record["cylinder"]["viscous_friction"]),
        "stroke": float(record["cylinder"]["stroke"]),
    }
    where = f"joints.{rig.joints[0]}.effects.{effect}"
    return rig.with_values(
        {f"{where}.{name}": v * scale.get(of, 1.0) for name, (v, of) in SIZES[effect].items()}
    )


def _varied(record, rng, count):
    """Machines whose numbers, delays among them, are 2 % off."""
    records = np.repeat(record, count)
    names = ("supply.pressure", "fluid.bulk_modulus", "command.delay", "load.inertia", "valve.discharge")
    for name in names:
        flat(records)[:, position_of(*name.split("."))] *= rng.uniform(0.98, 1.02, size=count)
    return records


def _alike(done, alone):
    """To the last bit."""
    assert done.diverged == alone.diverged
    for name in SIGNALS:
        np.testing.assert_array_equal(getattr(done.signals, name), getattr(alone.signals, name), err_msg=name)
    if done.diverged is None:
        np.testing.assert_array_equal(done.state, alone.state)


def _one_by_one(records, times, volts, **named):
    return [roll_out(records[i : i + 1], times, volts, times, **named) for i in range(len(records))]


def _in_lanes(records, times, volts, **named):
    """Machines under one command."""
    return roll_out_lanes(Run(records[:1], times, volts, times, **named).of(records), at_once=True)


def test_every_lane_does_what_it_does_alone_and_goes_on_from_where_it_ended():
    rig, rng = load_rig("hydrolek_right_j2"), np.random.default_rng(1)
    records = _varied(rig.records()[:1], rng, LANES + 3)  # more than one table's
    times, volts = _driven(8.0)
    found = _in_lanes(records, times, volts, longest_step=STEP)
    alone = _one_by_one(records, times, volts, longest_step=STEP)
    for one, other in zip(found, alone, strict=True):
        _alike(one, other)
    later = times + 8.0
    runs = Run(records[:1], later, volts, later, STEP).of(records)
    onward = roll_out_lanes(
        [replace(run, state=one.state) for run, one in zip(runs, found, strict=True)], at_once=True
    )
    for i, one in enumerate(onward):
        _alike(
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
    records = np.concatenate([rig.records()[:1], *(_with(rig, effect).records()[:1] for effect in effects)])
    times, volts = _driven(5.0)
    for one, other in zip(
        _in_lanes(records, times, volts, longest_step=STEP),
        _one_by_one(records, times, volts, longest_step=STEP),
        strict=True,
    ):
        _alike(one, other)


@pytest.mark.long("half a minute: a loop is compiled")
def test_machines_with_a_pump_and_four_edges():
    rig, rng = load_rig("hopsan_link"), np.random.default_rng(8)
    records = _varied(rig.records()[:1], rng, LANES)
    records["supply"]["relief_hysteresis"][::2] = 0.0
    times, volts = _driven(5.0)
    for one, other in zip(
        _in_lanes(records, times, volts, longest_step=STEP),
        _one_by_one(records, times, volts, longest_step=STEP),
        strict=True,
    ):
        _alike(one, other)


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
            machines.append(_with(rig, effect))
        except InputError:
            continue  # it does not act on this machine
    records = np.concatenate([machine.records()[:1] for machine in machines])
    times, volts = _driven(40.0)
    step = rig.value("integration.longest_step")
    for one, other in zip(
        _in_lanes(records, times, volts, longest_step=step),
        _one_by_one(records, times, volts, longest_step=step),
        strict=True,
    ):
        _alike(one, other)


def test_a_lane_that_diverges_or_has_no_number_disturbs_no_other_by_a_bit():
    rig, rng = load_rig("joint_bench"), np.random.default_rng(2)
    records = _varied(rig.records()[:1], rng, LANES)
    times, volts = _driven(4.0)
    good = _in_lanes(records, times, volts, longest_step=STEP)
    spoiled = records.copy()
    spoiled[2]["supply"]["pressure"] = 1e16
    spoiled[5]["load"]["inertia"] = np.nan
    spoiled[6]["fluid"]["density"] = 0.0
    found = _in_lanes(spoiled, times, volts, longest_step=STEP)
    assert "left all bounds at" in found[2].diverged
    assert found[5].diverged == "load.inertia is not a number (NaN)"
    assert found[6].diverged == "a parameter by which something is divided is zero"
    for i in (0, 1, 3, 4, 7):
        for name in SIGNALS:
            np.testing.assert_array_equal(getattr(found[i].signals, name), getattr(good[i].signals, name))


def test_a_lane_that_cannot_begin_disturbs_no_other():
    """A play without stiffness, on a machine whose rig says nothing of one."""
    rig = load_rig("joint_bench")
    records = _varied(rig.records()[:1], np.random.default_rng(2), 4)
    records[1]["effects"]["linkage_backlash"]["gap_rad"] = 0.005
    records[1]["linkage"]["play_stiffness"] = 0.0
    records[2]["linkage"]["direction"] = 0.0
    times, volts = _driven(1.0)
    found = _in_lanes(records, times, volts, longest_step=STEP)
    for one, other in zip(found, _one_by_one(records, times, volts, longest_step=STEP), strict=True):
        assert one.diverged == other.diverged
    assert [one.diverged is None for one in found] == [True, False, False, True]


def test_each_lane_has_its_own_recording_start_step_pull_and_time_constant():
    rig, rng = load_rig("joint_bench"), np.random.default_rng(4)
    records = _varied(rig.records()[:1], rng, 7)
    runs = []
    for i in range(7):
        times, volts = _driven(1.0 + 0.7 * i, seed=i)
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
        _alike(one, run.outcome())


def _law(rng, terms):
    """Terms of all kinds, drawn; what divides is of the size of what it divides."""
    law = np.zeros(terms, dtype=LAW)
    places = {"probe": PROBES, "time": TIMES, "place": PLACES, "speed_shape": SPEEDS, "other": OTHERS}
    for name, choices in places.items():
        law[name] = rng.integers(0, len(choices), size=terms)
    for name, value in (
        ("seconds", 5.0),
        ("low", -0.1),
        ("high", 0.7),
        ("centre", 0.2),
        ("reach", 0.3),
        ("speed", 0.5),
        ("slow", 0.01),
        ("opening", 1e-3),
        ("pressure", 1e7),
    ):
        law[name] = value
    scales = {"command": 0.3, "supply": 1e5, "cylinder": 200.0, "load": 40.0, "flow": 1e-5, "sensor": 1e-3}
    scales |= {"capacity_a": 1e-13, "capacity_b": 1e-13, "ramp": 1e-3, "coil_time": 1e-3}
    sizes = np.array([scales.get(PROBES[int(probe)], 0.05) for probe in law["probe"]])
    law["sine"], law["cosine"] = sizes * rng.uniform(-1.0, 1.0, size=(2, terms))
    law["frequency"] = rng.choice([0.0, 0.0, 1.3], size=terms)
    law["at_rod"] = rng.integers(0, 2, size=terms)
    return law


def _side_by_side(count):
    """Machines with laws of as many terms, at any stage."""
    rig, rng = load_rig("joint_bench"), np.random.default_rng(5)
    times, volts = _driven(3.0)
    runs = []
    while len(runs) < 2 * LANES:
        law = _law(rng, count)
        runs.append(Run(_varied(rig.records()[:1], rng, 1), times, volts, times, STEP, law=law))
    assert len({run.law["probe"][0] for run in runs}) > 5  # stages
    for one, run in zip(roll_out_lanes(runs, at_once=True), runs, strict=True):
        _alike(one, run.outcome())


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
        times, volts = _driven(seconds, seed=i)
        only = (PROBES[i],) if i % 2 else ()
        measured = np.column_stack([0.02 * rng.standard_normal(times.size), np.full((times.size, 2), 5e6)])
        runs.append(
            Run(
                _varied(rig.records()[:1], rng, 1),
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
        _alike(one, run.outcome())


@pytest.mark.long("a loop is compiled")
def test_each_lane_has_its_own_inputs_from_outside_also_where_it_is_pulled():
    _probed(load_rig("joint_bench"))


@pytest.mark.long("a minute: loops of three kinds are compiled")
@pytest.mark.parametrize("name", ["joint_bench", "hydrolek_right_j2"])
def test_inputs_from_outside_beside_laws(name):
    rig = load_rig(name)
    _probed(rig, lambda rng: _law(rng, 1))


def test_rows_that_are_far_and_unevenly_apart():
    rig = load_rig("joint_bench")
    records = _varied(rig.records()[:1], np.random.default_rng(6), 4)
    command_times, volts = _driven(6.0)
    times = np.array([0.0, 0.003, 0.5, 0.51, 2.0, 2.0001, 5.0])
    runs = Run(records[:1], command_times, volts, times, STEP).of(records)
    for i, one in enumerate(roll_out_lanes(runs, at_once=True)):
        _alike(one, roll_out(records[i : i + 1], command_times, volts, times, longest_step=STEP))


def test_few_kinds_are_compiled():
    rig = load_rig("joint_bench")
    kinds = {kind_of(_with(rig, effect).records()[:1], 1) for effect in SIZES if effect != "linkage.backlash"}
    assert len(kinds) <= 6  # without any, rubbing, warming, sticking, rocking, driven otherwise


def test_times_that_do_not_rise_are_refused():
    rig = load_rig("joint_bench")
    with pytest.raises(InputError, match="must rise"):
        roll_out_lanes(
            [Run(rig.records()[:1], np.zeros(1), np.zeros(1), np.array([1.0, 0.5]), STEP)], at_once=True
        )


def test_until_a_loop_is_compiled_machines_go_one_by_one_and_nobody_waits(monkeypatch, tmp_path):
    monkeypatch.setattr(lane_compiling, "_mark", lambda kind: tmp_path / kind.name)
    begun = []
    monkeypatch.setattr(lane_compiling, "_begin", lambda *given: begun.append(given) or _Running())
    rig = load_rig("joint_bench")
    records = _varied(rig.records()[:1], np.random.default_rng(7), 60)
    records["fluid"]["floor_time"] = 0.0  # a kind is told by its variants and effects alone
    kind = kind_of(records[:1], 1)
    monkeypatch.setattr(lane_compiling, "_ready", set())
    monkeypatch.setattr(lane_compiling, "_asked", Counter())
    monkeypatch.setattr(lane_compiling, "WORTH", 200)
    asked = [lane_compiling.ready(kind, records[:1], None, 60, 1) for _ in range(8)]
    assert not any(asked) and len(begun) == 1  # after 240 of them; not again while that runs
    (tmp_path / kind.name).touch()  # as the other process does when it is done
    assert lane_compiling.ready(kind, records[:1], None, 60, 1)


@pytest.mark.long("a quarter of a minute: a process compiles a loop")
def test_the_process_compiles_the_loop_that_was_asked_for(tmp_path):
    """A law may stand in the record of its joint already."""
    rig = load_rig("joint_bench")
    records = rig.records()[:1].copy()
    records["law"][TERM_NAMES[0]] = _law(np.random.default_rng(8), 1)
    law = with_own(None, records)
    kind = kind_of(records, 1, law)
    mark = lane_compiling._mark(kind)
    mark.unlink(missing_ok=True)
    assert lane_compiling._begin(records, law, 1).wait(300) == 0
    assert mark.exists()


class _Running:
    def poll(self):
        return None


def test_another_process_compiles_a_loop_for_all():
    rig = load_rig("joint_bench")
    kind = kind_of(rig.records()[:1], 1)
    _in_lanes(rig.records()[:1], np.array([0.0, 1e-3]), np.zeros(2), longest_step=STEP)
    lane_compiling._mark(kind).unlink()
    process = lane_compiling._begin(rig.records()[:1], None, 1)
    assert process.wait(300.0) == 0 and lane_compiling._mark(kind).exists()
