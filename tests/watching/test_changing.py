"""Numbers that change between recordings of a healthy machine, fitted to each anew: no alarm, and nothing hidden."""

import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.challenge.build import build_of
from hydrolek_drake.challenge.cases import driven, with_concealed
from hydrolek_drake.challenge.drawing import SIZING_STEP_S
from hydrolek_drake.challenge.driving import SAMPLE_S
from hydrolek_drake.cli.app import run
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.parameter_set import ParameterSet, free_of_joints
from hydrolek_drake.identification.problem_together import ProblemTogether
from hydrolek_drake.physics.records import flat
from hydrolek_drake.recordings import write_signals
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.changing import PerRecording, kept_of
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.watch import drifts_of, training_of, watch

FRICTION = "joints.joint.cylinder.viscous_friction"
LEAKAGE = "cylinder.cross_port_leakage"
LOADS = (0.0, 12.0, 5.0, 14.0, 1.0, 9.0, 3.0)
"""Kilograms 1 m from the axis, up to half of what the bench's own weight makes: the first three of the reference."""

LEAKING = 8.0e-13
"""Conductance of a leakage [m^3/(s Pa)], eight times what a watch without changing loads alarms."""


def _recorded(path, build, kilograms, seed, leakage=0.0):
    rig, rng = build.rig, np.random.default_rng(seed)
    healthy = build.nominal
    machine = healthy._replace(
        inertia=healthy.inertia + kilograms * rig.value("load.payload_inertia"),
        mgl=healthy.mgl + kilograms * rig.value("load.payload_gravity_cos"),
    )
    machine = with_concealed(machine, {LEAKAGE: {"conductance_m3_per_s_Pa": leakage}})
    done = driven(build, machine, "open", 14.0, rng, build.noise, SIZING_STEP_S)
    reading = done.reading + build.noise * rng.standard_normal(done.reading.size)
    signals = {"joint.command": done.volts, "joint.angle": reading}
    write_signals(
        path, np.arange(done.volts.size) * SAMPLE_S, signals, {"joint.command": "V", "joint.angle": "rad"}
    )
    return path


@pytest.fixture(scope="module")
def loaded(tmp_path_factory) -> Path:
    """Recordings of a bench that carries another load in each: a reference, healthy ones and ones with a leakage."""
    folder, build = tmp_path_factory.mktemp("loads"), build_of(load_rig("joint_bench"))
    for name in ("healthy", "leaking"):
        (folder / name).mkdir()
    for number, kilograms in enumerate(LOADS):
        if number < 3:
            _recorded(folder / f"reference_{number}.csv", build, kilograms, 110 + number)
            continue
        name = f"run_2026-03-{number:02d}.csv"
        _recorded(folder / "healthy" / name, build, kilograms, 120 + number)
        _recorded(folder / "leaking" / name, build, kilograms, 130 + number, LEAKING)
    return folder


def _watched(folder, kind, **told):
    reference, later = sorted(folder.glob("reference_*.csv")), sorted((folder / kind).glob("*.csv"))
    return watch(load_rig("joint_bench"), reference, later, cores=1, **told)


@pytest.mark.thorough
def test_loads_that_are_told_to_change_raise_no_alarm_and_are_found(loaded):
    watched = _watched(loaded, "healthy", changes=("load.payload",))
    assert watched.alarm is None and not any(j.beyond for j in watched.judgements)
    assert watched.healthy.inflation < 2.0  # the reference recordings differ by nothing but their loads
    path = "joints.joint.effects.load.payload.mass_kg"
    found = np.array([answer.own[path] for answer in watched.answers])
    planted = np.array(LOADS[3:])
    assert found - found.mean() == pytest.approx(planted - planted.mean(), abs=1.5)
    assert all(e.effect != "load.payload" for answer in watched.answers for e in answer.effects)


@pytest.mark.thorough
def test_the_same_loads_untold_leave_more_than_noise(loaded):
    watched = _watched(loaded, "healthy")
    assert watched.healthy.inflation > 10.0 or watched.alarm is not None


@pytest.mark.thorough
def test_a_leakage_is_named_while_the_load_changes(loaded):
    watched = _watched(loaded, "leaking", changes=("load.payload",))
    assert watched.alarm is not None and watched.alarm.effect == LEAKAGE
    for answer in watched.answers:
        assert answer.effects[0].effect == LEAKAGE
        assert answer.effects[0].size == pytest.approx(LEAKING, rel=0.1)


def test_each_recording_has_its_own_record_in_which_alone_its_numbers_stand():
    rig = load_rig("joint_bench")
    free = free_of_joints(rig, {"joint"})
    both = PerRecording(rig, free, (FRICTION,), ["one", "other"], {})
    assert len(both) == len(free) + 1
    plain, unit = flat(rig.records())[0], both.unit()
    assert np.allclose(flat(both.records(unit)), plain, equal_nan=True)
    moved = unit.copy()
    moved[both.paths.index(f"{FRICTION} in other")] = 0.9
    first, second = flat(both.records(moved))
    assert np.allclose(first, plain, equal_nan=True)
    wanted = rig.with_values({FRICTION: next(f for f in free if f.path == FRICTION).from_unit(0.9)})
    assert np.allclose(second, flat(wanted.records())[0], equal_nan=True)
    moved = unit.copy()
    moved[both.paths.index("supply.pressure")] = 0.9
    first, second = flat(both.records(moved))
    assert np.array_equal(first, second, equal_nan=True)
    assert not np.allclose(first, plain, equal_nan=True)
    assert both.arrivals.sum() == ParameterSet(rig, free).arrivals.sum() == 1


def test_what_is_kept_is_the_marginal_of_what_stays():
    rig = load_rig("joint_bench")
    parameters = ParameterSet(rig, free_of_joints(rig, {"joint"}))
    count = len(parameters)
    rng = np.random.default_rng(3)
    root = rng.standard_normal((count + 8, count + 1))  # two recordings, each with a friction of its own
    information, unit = root.T @ root, rng.random(count + 1)
    mean, kept = kept_of(parameters, (FRICTION,), unit, information)
    stays = np.array([path != FRICTION for path in parameters.paths])
    assert np.array_equal(mean[stays], unit[: count - 1])
    told = np.linalg.inv(information)[: count - 1, : count - 1]
    assert np.linalg.inv(kept)[np.ix_(stays, stays)] == pytest.approx(told, rel=1e-8)
    [at] = np.flatnonzero(~stays)
    assert mean[at] == parameters.unit()[at]
    assert kept[at, at] == pytest.approx(12.0)  # no more than its range, of which the variance is a twelfth
    assert not kept[at, stays].any()


def test_another_computer_is_told_what_changes(loaded):
    rig = load_rig("joint_bench")
    training = training_of(rig, [loaded / "reference_0.csv"])
    with ThreadPoolExecutor(1) as pool:
        names = ("load.payload", "viscous_friction")
        session = Session(rig, training[0].experiments, pool, 1, drifts_of(None), changes=names)
        there = session.reference.session(pool, 1)
    assert there.changing == session.changing
    assert set(there.changing) == {"joints.joint.effects.load.payload.mass_kg", FRICTION}
    assert there.bench.parameters(()).paths == session.bench.parameters(()).paths


def test_what_cannot_change_is_refused(loaded, tmp_path, capsys):
    reference = str(loaded / "reference_0.csv")
    later = ["--recordings", str(loaded / "healthy")]
    assert run(["watch", "joint_bench", reference, *later, "--changes", "load.paylod"]) == 2
    assert "load.payload" in capsys.readouterr().err
    shutil.copy(reference, tmp_path / "stream.csv")
    live = ["--live", str(tmp_path / "stream.csv"), "--changes", "load.payload"]
    assert run(["watch", "joint_bench", reference, *live]) == 2
    assert "--changes" in capsys.readouterr().err


def test_joints_that_move_together_have_records_of_their_own_in_each_recording(two_joints, recorded_together):
    """A number that changes in one recording of two changes that one's residuals, as it does alone; not the other's."""
    recordings = [recorded_together(two_joints, seed, seconds=3.0)[0] for seed in (5, 6)]
    groups = [experiments_of(two_joints, each) for each in recordings]
    named = [
        [replace(e, name=name) for e in group] for name, group in zip(("one", "other"), groups, strict=True)
    ]
    path = "joints.right_j2.cylinder.viscous_friction"
    free = [f for f in free_of_joints(two_joints, {"right_j2", "right_j3"}) if f.path == path]
    both = PerRecording(two_joints, free, (path,), ["one", "other"], {})
    joints = len(two_joints.joints)
    placed = [replace(e, index=e.index + joints * k) for k, group in enumerate(named) for e in group]
    changed = both.unit()
    changed[both.paths.index(f"{path} in other")] = 0.9
    found = ProblemTogether(both, placed).residuals_of_all([both.unit(), changed])
    alone = ParameterSet(two_joints, free)
    first = ProblemTogether(alone, named[0]).residuals(alone.unit())
    [second, moved] = ProblemTogether(alone, named[1]).residuals_of_all([alone.unit(), np.array([0.9])])
    assert np.array_equal(found[0], np.concatenate([first, second]))
    assert np.array_equal(found[1], np.concatenate([first, moved]))
    assert not np.allclose(moved, second)
