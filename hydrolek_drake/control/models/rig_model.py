"""An SDP model of a rig's joint, from open-loop step tests on its full hydraulic model."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from hydrolek_drake.control.models.sdp_model import SdpModel, exponential_rate, thesis_data
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.yaml_files import package_yaml

Array = NDArray[np.float64]


@cache
def _data() -> dict[str, Any]:
    raw = package_yaml(__package__, "rig_model.yaml")
    return {key: item["value"] for key, item in raw.items()}


def ends_left_out() -> float:
    """Share of the range at either end where run-up and stop spoil a measured rate."""
    return float(_data()["ends_left_out"])


@dataclass(frozen=True)
class StepTests:
    """Result of open-loop step tests.

    Attributes:
        voltage_V: shape (n,).
        rate_deg_per_s: angular velocity in the middle of the range, shape (n,); 0 where nothing moved.
        dead_time_s: from the step to the first movement, shape (n,); NaN where nothing moved.
    """

    voltage_V: Array
    rate_deg_per_s: Array
    dead_time_s: Array


def joint_range_deg(record: np.ndarray) -> tuple[float, float]:
    """Lower and upper stop of one joint's record, shape (1,)."""
    load = record["load"][0]
    return float(np.degrees(load["lower_stop"])), float(np.degrees(load["upper_stop"]))


def one_joint(rig: Rig, joint: str) -> np.ndarray:
    """Parameter record of one joint, shape (1,), the others standing at their initial positions.

    Raises:
        InputError: the rig has no such joint, or one without stops in degrees.
    """
    if joint not in rig.joints:
        raise InputError(f"rig {rig.name} has no joint '{joint}'; choose {', '.join(rig.joints)}")
    index = rig.joints.index(joint)
    record = rig.records()[index : index + 1]
    if not np.all(np.isfinite(joint_range_deg(record))) or rig.variant(joint, "load") == "sliding":
        raise InputError(
            f"rig {rig.name}: {joint} is no turning joint with stops; the controllers here need one"
        )
    return record


def control_step(rig: Rig) -> float:
    """Integration step of a loop that steps the spool once with the rest, as short as the rig's spool takes [s]."""
    return rig.value("integration.longest_step") / rig.value("integration.spool_steps")


def run_step(record: np.ndarray, voltage_V: float, longest_step: float) -> tuple[Array, Array]:
    """Times [s] and angles [deg] of one step from rest, near the end of the range that it leads away from."""
    data = _data()
    low, high = joint_range_deg(record)
    joint = record.copy()
    joint["load"]["initial_position"] = np.radians(
        low + data["from_end"] if voltage_V > 0.0 else high - data["from_end"]
    )
    neutral = float(record["command"]["neutral"][0])
    times = np.arange(0.0, data["duration"], data["row"])
    outcome = roll_out(
        joint,
        np.array([-1.0, 0.0]),
        np.array([neutral, neutral + voltage_V]),
        times,
        longest_step=longest_step,
    )
    return times, np.degrees(outcome.signals.reading)


def step_tests(record: np.ndarray, longest_step: float) -> StepTests:
    """Steps of both signs from rest, each from the end of the range that it leads away from."""
    data = _data()
    low, high = joint_range_deg(record)
    middle, half = 0.5 * (low + high), 0.5 * data["middle_share"] * (high - low)
    voltages = np.array([*(-v for v in reversed(data["voltages"])), *data["voltages"]])
    rates, dead = np.zeros(len(voltages)), np.full(len(voltages), np.nan)
    for i, voltage in enumerate(voltages):
        times, angle = run_step(record, float(voltage), longest_step)
        moved = (angle - angle[0]) * np.sign(voltage)
        if not moved[-1] > data["moving"]:
            continue
        dead[i] = times[int(np.argmax(moved > data["moving"]))]
        inside = (np.abs(angle - middle) <= half) & (times > data["settle"])
        if np.count_nonzero(inside) < 2:  # too slow to get there: judged where it is
            inside = (times > data["settle"]) & (angle > low) & (angle < high)
        rates[i] = np.polyfit(times[inside], angle[inside], 1)[0]
    return StepTests(voltages, rates, dead)


def fit_law(tests: StepTests, sample_s: float) -> tuple[float, ...]:
    """alpha1 to alpha6 of (6.3) that fit measured rates best, as section 6.1.3 does with `lsqcurvefit`.

    Raises:
        InputError: nothing moved in one direction.
    """
    alpha: list[float] = []
    for sign in (-1.0, 1.0):
        side = np.sign(tests.voltage_V) == sign
        v, rate = np.abs(tests.voltage_V[side]), tests.rate_deg_per_s[side] * sign * sample_s
        moving = v[rate > 0.0]
        if len(moving) < 3:
            raise InputError(
                f"the joint moves at {len(moving)} of {len(v)} voltages in "
                f"{'positive' if sign > 0 else 'negative'} direction; a law needs at least 3"
            )
        edge = float(np.max(v[v < moving.min()], initial=0.0))
        start = [float(rate.max()), 1.0, 0.5 * (edge + float(moving.min()))]

        def residual(p: Array, v: Array = v, rate: Array = rate) -> Array:
            return exponential_rate(v, (-1.0, 1.0, -np.inf, p[0], p[1], p[2])) - rate

        fitted = least_squares(
            residual, start, bounds=([0.0, 0.0, 0.0], [np.inf, np.inf, float(v.max())]), x_scale=start
        )
        alpha += [sign * fitted.x[0], fitted.x[1], sign * fitted.x[2]]
    return tuple(map(float, alpha))


def rig_model(rig: Rig, joint: str, tests: StepTests | None = None) -> SdpModel:
    """SDP model of one joint of a rig, the others held.

    The delay is the dead time at about 20 deg/s, less what it takes to be noticed at that rate.

    Args:
        rig: with this joint.
        joint: its name.
        tests: its `step_tests`, where they have been made.

    Raises:
        InputError: no such joint, no turning joint, or one that does not move.
    """
    record = one_joint(rig, joint)
    sample = float(thesis_data()["sample"]["value"])
    tests = tests or step_tests(record, control_step(rig))
    alpha = fit_law(tests, sample)
    wanted = float(thesis_data()["inverse"]["rate"]["value"])
    speed = np.abs(tests.rate_deg_per_s)
    i = int(np.argmin(np.where(np.isfinite(tests.dead_time_s), np.abs(speed - wanted), np.inf)))
    delay = float(tests.dead_time_s[i]) - _data()["moving"] / max(float(speed[i]), 1.0)
    low, high = joint_range_deg(record)
    return SdpModel(joint, alpha, None, sample, max(round(delay / sample), 1), low, high)
