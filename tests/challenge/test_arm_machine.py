"""The challenge's own arm joints are those of the rigs, effects included: two formulations, one machine."""

import functools
import math

import numpy as np
import pytest
from scipy.constants import g as GRAVITY

from hydrolek_drake.challenge.arm_body import turned_body
from hydrolek_drake.challenge.build import ARM_JOINTS, Build, build_of
from hydrolek_drake.challenge.driving import SAMPLE_S, Played, random_series, turned_back
from hydrolek_drake.challenge.listed import LISTED, with_effects
from hydrolek_drake.kinematics.arms import arms_urdf_path
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.rollout.rest import rest_state
from hydrolek_drake.rollout.rollout import roll_out

ALLOWED_DEG = 0.02
"""What the rollout's step may cost (hydrolek.yaml); less than half of the sensor's noise."""

STEP_S = 1e-4
"""Coarse enough for a test; at these sizes within about 0.01 deg of the step that records."""

OTHER_SIZES = {
    "command.delay": {"delay_s": 0.03},
    "valve.asymmetric_overlap": {"shift_m": 4e-6},
}
"""Effects that arms do not conceal, but that the machine has."""

DRAKE_GRAVITY = 9.81


def _rms_deg(values: np.ndarray) -> float:
    return float(np.degrees(np.sqrt(np.mean(values**2))))


def _rolled_out(rig: Rig, start: float, volts: np.ndarray, longest_step: float | None = None) -> np.ndarray:
    record = rig.records()[0][None]
    times = np.arange(volts.size) * SAMPLE_S
    outcome = roll_out(
        record,
        times,
        volts,
        times,
        state=rest_state(record, start),
        longest_step=longest_step or rig.value("integration.longest_step"),
        spool_steps=int(rig.value("integration.spool_steps")),
    )
    assert outcome.diverged is None
    return outcome.signals.reading


def _parameters(build: Build, effect: str) -> dict[str, float]:
    if effect in OTHER_SIZES:
        return OTHER_SIZES[effect]
    entry = build.listed[effect]
    return entry["size"] | {p: math.sqrt(low * high) for p, (low, high) in entry.get("draw", {}).items()}


@functools.cache
def _build(name: str) -> Build:
    return build_of(load_rig(name, {}))


@functools.cache
def _without(build_name: str, fine: float | None) -> tuple[Played, np.ndarray]:
    """What a joint does without effects, and its rollout."""
    build = _build(build_name)
    series = random_series(build.driving, False, 12.0, np.random.default_rng(3))
    plain = build.play(build.nominal, series, step=STEP_S)
    return plain, _rolled_out(build.rig, math.radians(build.driving.start_deg), plain.volts, fine)


@pytest.mark.parametrize("name", ARM_JOINTS)
def test_links_summed_one_by_one_are_the_plants_inertia_and_gravity(name: str) -> None:
    rig = _build(name).rig
    joint = rig.joints[0]
    body = turned_body(arms_urdf_path(), joint, rig.posture_without(joint))
    weight = DRAKE_GRAVITY * body.slope
    told = [
        body.inertia,
        weight * body.moment * math.cos(body.phase),
        -weight * body.moment * math.sin(body.phase),
        body.tool_distance**2,
        weight * body.tool_distance * math.cos(body.tool_phase),
        -weight * body.tool_distance * math.sin(body.tool_phase),
    ]
    names = ("inertia", "gravity_cos", "gravity_sin")
    plants = [rig.value(f"load.{prefix}{n}") for prefix in ("", "payload_") for n in names]
    assert told == pytest.approx(plants, rel=1e-12, abs=1e-12)
    assert pytest.approx(DRAKE_GRAVITY, rel=1e-3) == GRAVITY


@pytest.mark.parametrize("name", ARM_JOINTS)
@pytest.mark.thorough(but=1)
def test_without_effects_it_moves_as_the_rollout_does(name: str) -> None:
    build = _build(name)
    series = random_series(build.driving, False, 40.0, np.random.default_rng(1))
    done = build.play(build.nominal, series, step=STEP_S)
    start = math.radians(build.driving.start_deg)
    assert np.degrees(np.ptp(done.reading)) > 30.0
    assert _rms_deg(_rolled_out(build.rig, start, done.volts) - done.reading) < ALLOWED_DEG


@pytest.mark.parametrize("effect", LISTED)
@pytest.mark.parametrize("number", range(1, 6))
@pytest.mark.thorough(but=20)
def test_an_effect_changes_both_alike(number: int, effect: str) -> None:
    name = f"hydrolek_{'left' if number % 2 else 'right'}_j{number}"
    build = _build(name)
    # stick-slip shakes the rollout's own step by more than is allowed; that is not the formulation's
    fine = STEP_S if effect in ("cylinder.stribeck_friction", "valve.spool_stiction") else None
    plain, plain_rolled_out = _without(name, fine)
    joint, parameters = build.rig.joints[0], _parameters(build, effect)
    changed = build.replay(with_effects(build.nominal, {effect: parameters}), plain.volts, STEP_S)
    with_it = build.rig.with_values(
        {f"joints.{joint}.effects.{effect}.{p}": v for p, v in parameters.items()}
    )
    start = math.radians(build.driving.start_deg)
    ours = changed.reading - plain.reading
    theirs = _rolled_out(with_it, start, plain.volts, fine) - plain_rolled_out
    assert _rms_deg(theirs - ours) < max(0.05 * _rms_deg(ours), 0.1 * ALLOWED_DEG)
    if effect != "cylinder.end_cushion":  # not every joint comes to its end in so short a time
        assert _rms_deg(ours) > ALLOWED_DEG


def test_voltages_that_were_applied_are_applied_again_unchanged() -> None:
    build = _build("hydrolek_left_j3")
    upwards = np.repeat([0.0, 2.4, 0.0, 2.4], [50, 300, 50, 100])  # the first 3 s lead to the end
    driven = build.play(build.nominal, upwards, step=STEP_S)
    assert driven.reading[399] > math.radians(build.driving.high_deg)
    assert driven.volts[-1] == -2.4  # turned back
    again = build.replay(build.nominal, upwards, STEP_S)
    assert np.array_equal(again.volts, upwards)


def test_a_joint_near_its_end_is_turned_back() -> None:
    driving = _build("hydrolek_left_j3").driving
    below, above = math.radians(driving.low_deg) - 0.01, math.radians(driving.high_deg) + 0.01
    assert turned_back(2.0, above, driving) == turned_back(2.0, 0.0, driving) * -1.0 == -2.0
    assert turned_back(-2.0, above, driving) == -2.0
    assert turned_back(-2.0, below, driving) == 2.0
    assert turned_back(2.0, below, driving) == 2.0
