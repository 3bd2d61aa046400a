"""Machines whose joints move together, in lanes: each does what it does alone, whatever its neighbours are or do."""

from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.parameter_set import ParameterSet, free_parameters
from hydrolek_drake.identification.problem_together import problem_of
from hydrolek_drake.physics.law import LAW
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.physics.records import flat, position_of
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.lanes import compiling as lane_compiling
from hydrolek_drake.rollout.lanes.lanes import one_by_one
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.together import lanes as together_lanes
from hydrolek_drake.rollout.together.lanes import roll_out_together
from hydrolek_drake.rollout.together.together import JointsTogether

pytestmark = [pytest.mark.xdist_group("joints together"), pytest.mark.thorough]

MOVING = ("right_j2", "right_j3")
STEP = 5e-4


def _volts(times, joints, seed=4):
    levels = np.random.default_rng(seed).uniform(-3.0, 3.0, (times.size // 50 + 1, joints))
    return np.repeat(levels, 50, axis=0)[: times.size]


def _varied(records, rng):
    """Numbers, delays among them, 2 % off, other ones for each joint."""
    varied = records.copy()
    for name in ("supply.pressure", "fluid.bulk_modulus", "command.delay", "load.damping", "valve.discharge"):
        flat(varied)[:, position_of(*name.split("."))] *= rng.uniform(0.98, 1.02, size=len(records))
    return varied


def _runs(rig, count, joints=MOVING, seconds=2.0, each=lambda i, records: records):
    """Machines with commands, times and steps of their own."""
    rng = np.random.default_rng(1)
    machine = JointsTogether(rig, joints)
    runs = []
    for i in range(count):
        times = np.arange(0.0, seconds + 0.1 * i, 0.01)
        records = each(i, _varied(rig.records(), rng))
        places = records["load"]["initial_position"][[rig.joints.index(joint) for joint in joints]]
        runs.append(
            machine.run(
                records,
                times,
                _volts(times, len(joints), i),
                times[:: 1 + i % 2],
                places,
                STEP * (1 + i % 3 / 2),
            )
        )
    return runs


def _alike(done, run):
    """To the last bit."""
    alone = run.outcome()
    assert done.diverged == alone.diverged
    for name, found in done.signals.items():
        np.testing.assert_array_equal(found, alone.signals[name], err_msg=name)


def _all_alike(runs):
    for done, run in zip(roll_out_together(runs, at_once=True), runs, strict=True):
        assert done.diverged is None
        _alike(done, run)


def test_every_lane_does_what_it_does_alone(two_joints):
    def loaded(i, records):
        """What hangs on the tool is told by this joint or that, and picked up sooner or later."""
        payload = records[i % 2]["effects"]["load_payload"]
        payload["mass_kg"], payload["time_s"] = 3.0 * (i % 4), 0.2 * i
        return records

    _all_alike(_runs(two_joints, LANES + 3, each=loaded))


def test_a_lane_that_diverges_or_has_no_number_disturbs_no_other_by_a_bit(two_joints):
    def spoiled(i, records):
        if i == 2:
            records["supply"]["pressure"] = 1e16
        if i == 4:
            records[1]["cylinder"]["area_a"] = np.nan
        if i == 5:
            records["fluid"]["density"] = 0.0
        return records

    good = roll_out_together(_runs(two_joints, LANES), at_once=True)
    runs = _runs(two_joints, LANES, each=spoiled)
    found = roll_out_together(runs, at_once=True)
    assert "left all bounds at" in found[2].diverged
    assert found[4].diverged == "cylinder.area_a is not a number (NaN)"
    assert found[5].diverged == "a parameter by which something is divided is zero"
    for i, (one, other) in enumerate(zip(found, good, strict=True)):
        if i in (2, 4, 5):
            _alike(one, runs[i])
        else:
            for name, signal in one.signals.items():
                np.testing.assert_array_equal(signal, other.signals[name])


def test_the_jacobian_is_the_same_in_lanes_and_one_by_one(two_joints, recorded_together, monkeypatch):
    recording, _ = recorded_together(two_joints, 5, seconds=3.0)
    paths = [f"joints.{j}.{name}" for j in MOVING for name in ("cylinder.area_a", "command.delay")]
    parameters = ParameterSet(two_joints, free_parameters(two_joints, paths))
    problem = problem_of(parameters, experiments_of(two_joints, recording))
    unit = parameters.unit()
    roll_out_together(_runs(two_joints, 1), at_once=True)  # compiled
    tables = []
    table = together_lanes.one_table
    monkeypatch.setattr(
        together_lanes, "one_table", lambda kinds, runs: tables.append(len(runs)) or table(kinds, runs)
    )
    found = problem.jacobian(unit)
    assert tables == [4]
    with one_by_one():
        np.testing.assert_array_equal(found, problem.jacobian(unit))


def test_another_process_compiles_what_a_kind_of_joint_needs(two_joints):
    (run,) = _runs(two_joints, 1)
    roll_out_together([run], at_once=True)
    mark = lane_compiling._mark(together_lanes.kinds_of(run)[0])
    mark.unlink()
    process = lane_compiling._begin(run.records[:1], None, run.spool_steps, together=True)
    assert process.wait(300.0) == 0 and mark.exists()


def _law(probe, size):
    """An oscillation."""
    law = np.ones(1, dtype=LAW)
    for name in ("time", "place", "speed_shape", "other"):
        law[name] = 0.0
    law["probe"], law["sine"], law["cosine"], law["frequency"] = PROBES.index(probe), size, size, 1.3
    return law


def test_what_all_joints_feel_of_a_law_is_rolled_out_one_by_one(two_joints):
    runs = [
        replace(run, laws=(_law("supply", -5e5 * i), np.zeros(0, LAW)))
        for i, run in enumerate(_runs(two_joints, 3))
    ]
    _all_alike(runs)


@pytest.mark.long("two minutes: loops of more kinds are compiled")
@pytest.mark.parametrize("probe", ["load", "command", "valve"])
def test_laws_of_single_joints(two_joints, probe):
    sizes = {"load": 100.0, "command": 0.3, "valve": 0.05}
    runs = [
        replace(run, laws=(_law(probe, sizes[probe] * i), np.zeros(0, LAW)))
        for i, run in enumerate(_runs(two_joints, 5))
    ]
    _all_alike(runs)


@pytest.mark.long("two minutes: loops of more kinds are compiled")
@pytest.mark.parametrize(
    "effect",
    [
        "cylinder.coulomb_friction.coulomb_N=2000",
        "valve.spool_stiction.force_N=5",
        "base.compliance.stiffness_Nm_per_rad=2e5",
        "linkage.backlash.gap_rad=0.005",
        "supply.pressure_droop.resistance_Pa_s_per_m3=3e10",
    ],
)
def test_effects(two_joints, effect):
    path, _, value = effect.partition("=")
    rig = two_joints.with_values({f"joints.right_j2.effects.{path}": float(value)})
    _all_alike(_runs(rig, 5))


@pytest.mark.long("a minute: loops of another kind are compiled")
def test_joints_on_one_pump(on_a_pump):
    def other_pump(i, records):
        """Too small for the joints or not, its relief valve with or without a hysteresis."""
        records["supply"]["displacement"] *= 0.3 + 0.1 * i
        if i % 3 == 0:
            records["supply"]["relief_hysteresis"] = 0.0
        return records

    runs = _runs(on_a_pump, LANES + 3, each=other_pump)
    setting = on_a_pump.value("supply.pressure")
    lowest = np.array([run.outcome().signals["supply_pressure"].min() for run in runs])
    assert np.sum(lowest < 0.9 * setting) >= 3  # their relief valves close for a while
    _all_alike(runs)


@pytest.mark.long("two minutes: loops of four kinds are compiled")
def test_all_joints_of_both_arms():
    rig = load_rig("hydrolek")
    _all_alike(_runs(rig, LANES, joints=rig.joints))


@pytest.mark.long("half a minute: loops of another kind are compiled")
@pytest.mark.parametrize("name", ["joint_bench", "hopsan_link"])
def test_a_joint_of_no_arm(name):
    rig = load_rig(name)
    _all_alike(_runs(rig, 4, joints=rig.joints))
