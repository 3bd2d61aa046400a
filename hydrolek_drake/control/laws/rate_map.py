"""Angular velocity against voltage and angle as measured by step tests, and its inverse: the feedforward."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.control.models.rig_model import (
    StepTests,
    control_step,
    ends_left_out,
    joint_range_deg,
    one_joint,
    rig_model,
    run_step,
    step_tests,
)
from hydrolek_drake.control.models.sdp_model import SdpModel, thesis_data
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig

MODEL_POINTS = 40
"""Points of an SDP model's law in its rate map."""


@dataclass(frozen=True)
class Direction:
    """One direction of a joint.

    Attributes:
        voltages: sizes of voltage from the dead-zone's edge to saturation [V], rising.
        rates: sizes of angular velocity there in mid-range [deg/s], from 0, rising.
        shape: share of these rates at any angle, coefficients of `numpy.polyval` over the angle [deg].
    """

    voltages: tuple[float, ...]
    rates: tuple[float, ...]
    shape: tuple[float, ...]

    @property
    def edge_V(self) -> float:
        """Edge of the dead-zone."""
        return self.voltages[0]

    @property
    def fastest(self) -> float:
        """Saturation rate in mid-range [deg/s]."""
        return self.rates[-1]


@dataclass(frozen=True)
class RateMap:
    """Both directions of a joint, and its dead time.

    Attributes:
        negative: towards falling angles.
        positive: towards rising angles.
        dead_time_s: from a change of voltage to that of the velocity.
        lower_deg: end of the joint's range.
        upper_deg: the other end.
    """

    negative: Direction
    positive: Direction
    dead_time_s: float
    lower_deg: float
    upper_deg: float

    def side(self, sign: float) -> Direction:
        """The direction of a sign."""
        return self.positive if sign > 0.0 else self.negative

    def share(self, sign: float, angle_deg: float) -> float:
        """How much faster than in mid-range the joint moves at an angle: lever and gravity (feedforward)."""
        angle = min(max(angle_deg, self.lower_deg), self.upper_deg)
        value = 0.0
        for coefficient in self.side(sign).shape:
            value = value * angle + coefficient
        return value


def map_from_tests(
    tests: StepTests, shapes: tuple[Sequence[float], Sequence[float]], model: SdpModel
) -> RateMap:
    """Rate map from step tests.

    The dead-zone's edge is where the line through the two slowest moving tests crosses zero, but not outside
    the interval between the largest voltage that did not move the joint and the smallest that did.

    Args:
        tests: of both directions.
        shapes: share of the rate over the angle, negative and positive direction.
        model: gives dead time and range.

    Raises:
        InputError: fewer than two voltages move the joint in one direction.
    """
    sides = []
    for sign, shape in zip((-1.0, 1.0), shapes, strict=True):
        chosen = np.sign(tests.voltage_V) == sign
        order = np.argsort(np.abs(tests.voltage_V[chosen]))
        v = np.abs(tests.voltage_V[chosen])[order]
        r = np.abs(tests.rate_deg_per_s[chosen])[order]
        first = int(np.argmax(r > 0.0))
        if np.count_nonzero(r > 0.0) < 2:
            raise InputError("step tests: at least two voltages of each sign must move the joint")
        slope = (r[first + 1] - r[first]) / (v[first + 1] - v[first])
        edge = v[first] - r[first] / slope if slope > 0.0 else v[first]
        edge = min(max(edge, v[first - 1] if first else 0.0), v[first])
        volts, rates = [float(edge)], [0.0]
        enough = float(thesis_data()["inverse"]["nearly_saturated"]["value"]) * float(r.max())
        for voltage, rate in zip(v[first:], np.maximum.accumulate(r[first:]), strict=True):
            if voltage > volts[-1] and rate > rates[-1] and rates[-1] < enough:
                volts.append(float(voltage))
                rates.append(float(rate))
        sides.append(Direction(tuple(volts), tuple(rates), tuple(map(float, shape))))
    delay = model.delay_samples * model.sample_s
    return RateMap(sides[0], sides[1], delay, model.lower_deg, model.upper_deg)


def map_from_model(model: SdpModel) -> RateMap:
    """Rate map of an SDP model: its law from the dead-zone's edges to nearly saturation, alike at all angles."""
    nearly = float(thesis_data()["inverse"]["nearly_saturated"]["value"])
    sides = []
    for sign, edge, fastest in zip((-1.0, 1.0), model.dead_zone_V, model.saturation_deg_per_s, strict=True):
        end = abs(model.voltage_at(nearly * fastest))
        volts = np.linspace(abs(edge), end, MODEL_POINTS)[1:]
        rates = np.abs(model.rate(sign * volts))
        sides.append(Direction((abs(edge), *map(float, volts)), (0.0, *map(float, rates)), (1.0,)))
    delay = model.delay_samples * model.sample_s
    return RateMap(sides[0], sides[1], delay, model.lower_deg, model.upper_deg)


def rate_shape(record: np.ndarray, sign: float, longest_step: float) -> tuple[float, ...]:
    """Rate over the angle when driven at full voltage, as a share of that in mid-range; a parabola.

    Lever and gravity enter here: the arm moves faster where the cylinder's lever is short or the load helps.
    """
    low, high = joint_range_deg(record)
    limit = float(record["command"]["limit"][0])
    times, angle = run_step(record, sign * limit, longest_step)
    velocity = np.gradient(angle, times)
    margin = ends_left_out() * (high - low)
    inside = (angle > low + margin) & (angle < high - margin)
    if np.count_nonzero(inside) < 4:
        return (1.0,)
    fitted = np.polyfit(angle[inside], velocity[inside], 2)
    middle = np.polyval(fitted, 0.5 * (low + high))
    return tuple(map(float, fitted / middle))


def rig_model_and_rates(rig: Rig, joint: str) -> tuple[SdpModel, RateMap]:
    """SDP model and rate map of a rig's joint, from the same simulated step tests.

    Raises:
        InputError: no such joint, no turning joint, or one that does not move.
    """
    record, longest_step = one_joint(rig, joint), control_step(rig)
    tests = step_tests(record, longest_step)
    model = rig_model(rig, joint, tests)
    shapes = (rate_shape(record, -1.0, longest_step), rate_shape(record, 1.0, longest_step))
    return model, map_from_tests(tests, shapes, model)


def rate_at(direction: Direction, size_V: float) -> float:
    """Size of the angular velocity in mid-range at a size of voltage [deg/s]."""
    return float(np.interp(size_V, direction.voltages, direction.rates))


def voltage_for(direction: Direction, size_deg_per_s: float) -> float:
    """Size of the voltage for a size of angular velocity; the largest if it cannot be reached."""
    return float(np.interp(size_deg_per_s, direction.rates, direction.voltages))
