"""Joints that move together: parameters are fitted with what the joints do to each other."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.diagnosis.intervals.last_numbers import with_last_numbers
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.weighing import felt_together
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.experiments.recorded_together import OneRecording, recordings_of
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.identification.problem_together import ProblemTogether
from hydrolek_drake.rigs import Rig, load_rig

pytestmark = pytest.mark.xdist_group("joints together")

MOVING = ("right_j2", "right_j3")
LONG = {"seconds": 10.0, "largest_V": 4.0}
DROOP = "joints.right_j2.effects.supply.pressure_droop.resistance_Pa_s_per_m3"
TRUTH = {
    DROOP: 3e10,
    "joints.right_j2.cylinder.area_a": 1.03,  # times the rig's own
    "joints.right_j3.cylinder.area_a": 0.98,
    "joints.right_j2.valve.full_opening_b": 0.97,
    "joints.right_j3.amplifier.max_current_a": 1.02,
}


@pytest.fixture(scope="module")
def machine(two_joints) -> Rig:
    """A machine whose pump gives way, with numbers of its own."""
    own = {path: two_joints.value(path) * size for path, size in TRUTH.items() if path != DROOP}
    return two_joints.with_values({**own, DROOP: TRUTH[DROOP]})


@pytest.fixture(scope="module")
def begun(two_joints, machine, recorded_together, fitted) -> Iterator[tuple[Workbench, object]]:
    """Data of both joints, and the droop fitted by rollouts of both."""
    training = experiments_of(two_joints, recorded_together(machine, 1, **LONG)[0])
    nominal = free_parameters(two_joints, [path for path in TRUTH if path != DROOP])
    with ThreadPoolExecutor(1) as pool:
        bench = Workbench(two_joints, nominal, training, pool, 2)
        scales = natural_scales(two_joints, MOVING[0], training)
        droop = next(c for c in candidates_of(two_joints, MOVING[0], scales) if c.size_path == DROOP)
        yield bench, fitted(bench, (droop,), {DROOP: 1e10}, 20)


def _true_place(bench: Workbench, machine: Rig, effects) -> np.ndarray:
    parameters = bench.parameters(effects)
    return parameters.unit({path: machine.value(path) for path in parameters.paths})


@pytest.mark.thorough
def test_a_droop_that_the_joints_share_is_fitted_to_its_size(begun, machine, recorded_together) -> None:
    bench, found = begun
    recorded = bench.training
    problem = bench.problem(found.effects, bench.fine, kind=ProblemTogether)
    left = problem.residuals(found.fit.unit)
    true = problem.residuals(_true_place(bench, machine, found.effects))
    assert left @ left < true @ true  # at the bottom: lower than where the truth lies
    assert found.values[DROOP] == pytest.approx(TRUTH[DROOP], rel=0.02)
    assert found.fit.over_noise == pytest.approx(np.sqrt(left @ left / problem.counted), abs=0.02)

    ahead = experiments_of(bench.rig, recorded_together(machine, 2, **LONG)[0])
    told, intervals, held_out = with_last_numbers(bench, Judged(found, np.zeros(1), 1), ahead)
    counted = sum(experiment.counted for experiment in held_out)
    chance = 4.0 / np.sqrt(2.0 * counted)
    assert np.sqrt(told.held_out @ told.held_out / counted) == pytest.approx(1.0, abs=chance)
    assert intervals.keys() == set(bench.parameters(found.effects).paths)
    for path, known in intervals.items():
        width = 0.5 * (known.high - known.low)
        assert abs(known.value - machine.value(path)) < 2.0 * width, path
        assert width < 0.05 * machine.value(path), path
    bench.training = recorded


def test_a_jacobian_of_one_joint_at_a_time_lacks_what_it_does_to_the_others(begun, machine) -> None:
    bench, found = begun
    unit = _true_place(bench, machine, found.effects)
    recorded = bench.training
    bench.training = tuple(felt_together(machine, recorded))
    problem = bench.problem(found.effects, bench.fine, kind=ProblemTogether)
    alone = bench.problem(found.effects, bench.fine).jacobian(unit)
    together = problem.jacobian(unit)
    way = 1e-4 * np.ones(unit.size)
    change = problem.residuals(unit + way) - problem.residuals(unit)
    amiss, much_amiss = (np.linalg.norm(j @ way - change) / np.linalg.norm(change) for j in (together, alone))
    assert amiss < 0.02
    assert much_amiss > 5.0 * amiss
    bench.training = recorded


def test_joints_that_do_not_move_are_held(recorded_together) -> None:
    whole = load_rig("hydrolek", {})
    group = recordings_of(experiments_of(whole, recorded_together(whole, 3, **LONG)[0]))[0]
    recording = OneRecording(whole, group)
    short = recording.times[:300]
    every = recording.roll_out(whole.records(), short)
    fewer = recording.without_still(whole.records()).roll_out(whole.records(), short)
    assert len(every.joints) == 7
    assert set(MOVING) < set(fewer.joints) < set(every.joints)
    for joint in MOVING:
        one, other = (d.signals["reading"][:, d.joints.index(joint)] for d in (every, fewer))
        assert one == pytest.approx(other, abs=1e-8)
