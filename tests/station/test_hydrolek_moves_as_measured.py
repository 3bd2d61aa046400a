"""The HydroLek rigs move as the thesis measured: Table 3.2, Table 6.1, section 3.1 and section 6.1.3."""

import numpy as np
import pytest

from hydrolek_drake.kinematics.arms import load_of_joint
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import rest_state, roll_out

# Table 6.1: saturation rates a1, a4 [deg per 0.01 s] and dead-zone limits a3, a6 [V] of the right arm.
TABLE_6_1 = {
    1: (-0.5448, -1.2739, 0.4101, 1.1454),
    2: (-0.2951, -1.3298, 0.3887, 1.3124),
    3: (-0.2474, -1.2618, 0.3409, 1.1993),
    4: (-0.7808, -1.4426, 0.6048, 1.1650),
}
MIRRORED = (1, 4)  # joints of the left arm that turn the other way
DEAD_TIME = {1: 0.15, 2: 0.15, 3: 0.15, 4: 0.25}  # seconds, section 6.1.3
CASES = [(side, joint, sign) for side in ("right", "left") for joint in TABLE_6_1 for sign in (1, -1)]
STEP_AT = 0.1  # seconds


def expected(side: str, joint: int, sign: int) -> tuple[float, float]:
    """Saturation rate [deg/s] and dead-zone limit [V], both with the sign of the motion."""
    of_right = -sign if side == "left" and joint in MIRRORED else sign
    a1, a3, a4, a6 = TABLE_6_1[joint]
    rate, limit = (a4, a6) if of_right > 0 else (a1, a3)
    return sign * abs(rate) * 100.0, sign * abs(limit)


def move(side: str, joint: int, volts: float, start_share: float, duration: float):
    rig = load_rig(f"hydrolek_{side}_j{joint}")
    records = rig.records()
    lower, upper = records[0]["load"]["lower_stop"], records[0]["load"]["upper_stop"]
    start = lower + start_share * (upper - lower)
    times = np.arange(0.0, duration, 0.01)
    command = np.where(times >= STEP_AT - 1e-9, volts, 0.0)
    outcome = roll_out(records, times, command, times, state=rest_state(records, start), longest_step=0.5e-3)
    assert outcome.diverged is None
    return times, np.degrees(outcome.signals.position), np.degrees(lower), np.degrees(upper)


@pytest.mark.parametrize(("side", "joint", "sign"), CASES)
def test_saturation_rate_within_ten_percent(side, joint, sign):
    times, angle, lower, upper = move(side, joint, 10.0 * sign, 0.25 if sign > 0 else 0.75, 4.0)
    middle = np.abs(angle - 0.5 * (lower + upper)) < 0.15 * (upper - lower)
    moving = middle & (times > STEP_AT + DEAD_TIME[joint]) & (np.sign(np.gradient(angle)) == sign)
    rate = np.polyfit(times[moving], angle[moving], 1)[0]
    assert rate == pytest.approx(expected(side, joint, sign)[0], rel=0.10)


@pytest.mark.parametrize(("side", "joint", "sign"), CASES)
def test_dead_zone_within_ten_percent(side, joint, sign):
    limit = expected(side, joint, sign)[1]
    _, inside, _, _ = move(side, joint, 0.9 * limit, 0.5, 3.0)
    _, outside, _, _ = move(side, joint, 1.1 * limit, 0.5, 3.0)
    assert abs(inside[-1] - inside[100]) < 0.05  # closed valves: what is left is the oil settling
    assert sign * (outside[-1] - outside[100]) > 0.5


@pytest.mark.parametrize(("side", "joint", "sign"), CASES)
def test_dead_time_as_read_off_the_step_responses(side, joint, sign):
    times, angle, _, _ = move(side, joint, 10.0 * sign, 0.5, 1.0)
    starts = times[np.abs(angle - angle[0]) > 0.2][
        0
    ]  # four times the potentiometer's noise: where the eye sees it
    assert starts - STEP_AT == pytest.approx(DEAD_TIME[joint], abs=0.03)  # read by eye off samples of 0.01 s


@pytest.mark.parametrize("joint", [1, 2, 3, 4, 5])
def test_joints_stop_at_the_ends_of_table_3_2(joint):
    for sign in (1, -1):
        _, angle, lower, upper = move("right", joint, 10.0 * sign, 0.5, 6.0)
        assert angle[-1] == pytest.approx(upper if sign > 0 else lower, abs=0.5)


def test_the_arm_lifts_150_kg_at_full_reach():
    rig = load_rig("hydrolek_right_j2")
    stretched = {f"right_j{n}": 0.0 for n in (1, 3, 4, 6, 7)} | {"right_j5": np.radians(-4.16)}
    load = load_of_joint("right_j2", stretched)
    lifting = rig.with_values(
        {
            "load.inertia": load.inertia,
            "load.gravity_cos": load.gravity_cos,
            "load.gravity_sin": load.gravity_sin,
            "load.payload_inertia": load.inertia_per_kg,
            "load.payload_gravity_cos": load.gravity_cos_per_kg,
            "load.payload_gravity_sin": load.gravity_sin_per_kg,
            "effects.load.payload.mass_kg": 150.0,
        }
    ).records()
    times = np.arange(0.0, 4.0, 0.01)
    command = np.where(times >= 0.5, 10.0, 0.0)
    angle = np.degrees(
        roll_out(
            lifting, times, command, times, state=rest_state(lifting, 0.0), longest_step=0.5e-3
        ).signals.position
    )
    assert abs(angle[49] - angle[10]) < 0.2  # the closed valve holds it
    assert angle[-1] > 20.0
