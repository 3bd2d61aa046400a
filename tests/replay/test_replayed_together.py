"""Joints of a machine that were recorded together are replayed together: one pump, and an arm that gives way."""

from dataclasses import replace as changed

import numpy as np
import pytest

from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.experiments.recorded_together import OneRecording
from hydrolek_drake.replay import compare, replay
from hydrolek_drake.replay.by_diagram import moved_by_diagram
from hydrolek_drake.replay.driving import Driven, Moved, moved
from hydrolek_drake.rigs import load_rig

pytestmark = pytest.mark.xdist_group("joints together")

DROOP = "joints.right_j2.effects.supply.pressure_droop.resistance_Pa_s_per_m3"
ALLOWED_DEG = 0.02
"""What the rollout's own step may cost (hydrolek.yaml)."""


@pytest.fixture(scope="module")
def drooping(two_joints):
    return two_joints.with_values({DROOP: 3e10})


def _off_deg(outcomes, reading: np.ndarray) -> np.ndarray:
    off = np.stack([one.signals.reading for one in outcomes.values()], axis=1) - reading
    return np.degrees(np.sqrt(np.mean(off**2, axis=0)))


def test_the_machines_own_numbers_leave_the_noise_of_joints_that_shake_and_starve_each_other(
    drooping, recorded_together
) -> None:
    recording, reading = recorded_together(drooping, noise_deg=0.02)  # the start is known to within it
    both = replay(drooping, recording)
    assert _off_deg(both.outcomes, reading).max() < ALLOWED_DEG
    assert all(one.agrees for one in compare(both) if one.key.endswith(".angle"))
    (supply,) = [pair for pair in both.pairs if pair.key == "supply.pressure"]
    assert supply.model.min() < drooping.value("supply.pressure") - 1e6
    off = supply.model - recording.signal("supply.pressure")
    assert np.sqrt(np.mean(off**2)) < 0.02 * np.ptp(supply.model)  # the step again, where flows change fast


def test_each_alone_would_leave_far_more(drooping, recorded_together) -> None:
    recording, reading = recorded_together(drooping)
    alone = {}
    for joint in drooping.joints:
        one = Driven(joint, recording.time, recording.signal(f"{joint}.command"), None)
        alone |= moved(drooping, [one], recording.time, {})
    assert _off_deg(alone, reading).min() > 10.0 * ALLOWED_DEG


@pytest.mark.long("a minute: a program of its own is compiled")
def test_a_recorded_supply_pressure_drives_both_where_the_rig_knows_no_droop(
    two_joints, drooping, recorded_together
) -> None:
    recording, reading = recorded_together(drooping)
    ignorant = replay(two_joints, recording)
    driven = changed(two_joints, driven_by=("supply.pressure",))
    cut, by_diagram = replay(driven, recording), replay(driven, recording, by=moved_by_diagram)
    assert _off_deg(cut.outcomes, reading).max() < 0.1 * _off_deg(ignorant.outcomes, reading).max()
    assert _off_deg(by_diagram.outcomes, reading).max() < 0.1 * _off_deg(ignorant.outcomes, reading).max()
    assert not any(pair.key == "supply.pressure" for pair in cut.pairs)
    for outcome in cut.outcomes.values():
        np.testing.assert_allclose(outcome.signals.supply_pressure, recording.signal("supply.pressure"))
    fitted = OneRecording(driven, experiments_of(driven, recording))  # as a fit sees it
    done = fitted.roll_out(driven.records(), fitted.times)
    again = {e.joint: Moved(fitted.signals_of(e, done), None) for e in fitted.group}
    model = np.stack([cut.outcomes[joint].signals.reading for joint in again], axis=1)
    assert _off_deg(again, model[np.searchsorted(recording.time, fitted.times)]).max() < ALLOWED_DEG


def test_a_command_that_is_missing_at_first_is_neutral_until_it_comes(two_joints, recorded_together) -> None:
    """A part is replayed from where both joints rest; one joint's command begins late."""
    recording, _ = recorded_together(two_joints)
    first, second = two_joints.joints
    volts = {joint: recording.signal(f"{joint}.command") for joint in two_joints.joints}
    volts[second] = np.where(recording.time < 1.0, 0.0, volts[second])
    late = recording.time >= 1.0
    whole, cut = (
        moved(
            two_joints,
            [Driven(first, recording.time, volts[first], None), Driven(second, times, values, None)],
            recording.time,
            {},
        )
        for times, values in (
            (recording.time, volts[second]),
            (recording.time[late], volts[second][late]),
        )
    )
    for joint in two_joints.joints:
        np.testing.assert_allclose(whole[joint].signals.reading, cut[joint].signals.reading, rtol=1e-12)


def test_where_a_joint_without_a_command_stands_is_felt_by_those_that_carry_it() -> None:
    rig = load_rig("hydrolek", {})
    time = np.arange(0.0, 2.0, 0.01)
    driven = [Driven(f"right_j{n}", time, np.where(time < 0.5, 0.0, 4.0), None) for n in (2, 3)]
    raised = rig.value("joints.right_j4.load.initial_position") + 0.5
    hanging, carried = (moved(rig, driven, time, elsewhere) for elsewhere in ({}, {"right_j4": raised}))
    assert list(hanging) == list(carried) == ["right_j2", "right_j3"]
    assert not any(one.diverged for done in (hanging, carried) for one in done.values())
    off = carried["right_j2"].signals.reading - hanging["right_j2"].signals.reading
    assert np.abs(np.degrees(off)).max() > ALLOWED_DEG


def test_a_divergence_of_one_is_told_of_all_that_move_with_it(two_joints, recorded_together) -> None:
    recording, _ = recorded_together(two_joints)
    wild = replay(two_joints.with_values({"supply.pressure": 1e16}), recording)
    for joint in two_joints.joints:
        assert wild.outcomes[joint].diverged.startswith("left all bounds at ")
        assert any(joint in note and "compared up to there" in note for note in wild.notes)


def test_a_recorded_angle_of_a_joint_without_a_command_is_where_it_starts(recorded_together) -> None:
    rig = load_rig("hydrolek", {})
    recording, _ = recorded_together(rig)
    raised = rig.value("joints.right_j4.load.initial_position") + 0.5
    noise = np.random.default_rng(1).normal(0.0, 1e-4, recording.time.size)
    seen = changed(recording, signals={**recording.signals, "right_j4.angle": raised + noise})
    empty = changed(recording, signals={**recording.signals, "right_j4.angle": np.full(noise.size, np.nan)})
    one, other, nothing = (
        replay(rig, r, (0.0, 2.0)).outcomes["right_j2"].signals.reading for r in (recording, seen, empty)
    )
    assert np.degrees(np.abs(one - other).max()) > ALLOWED_DEG
    np.testing.assert_allclose(nothing, one, rtol=1e-12)
