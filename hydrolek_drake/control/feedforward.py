"""Rate control with model-based feedforward: inverse rate map, delay compensation, learning of what differs."""

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from math import copysign, sqrt
from typing import Any

import numpy as np
import yaml

from hydrolek_drake.control.law import Array
from hydrolek_drake.control.rate_map import RateMap, rate_at, voltage_for
from hydrolek_drake.errors import InputError


@dataclass(frozen=True)
class FeedforwardTuning:
    """Free numbers of the law.

    Attributes:
        gain: rate per predicted error near the set point [1/s].
        braking_deg: distance over which the joint is braked from its saturation rate, so that the deceleration
            grows with the joint's speed.
        extra_delay_s: dead time beyond the measured one that the prediction counts with.
        correction: share of the reading's deviation that the angle's estimate takes up in a sample.
        learn_rate: share of the saturation rate's deviation that is learned in a sample.
        learn_edge: share of the dead-zone's deviation that is learned in a sample.
        slowest: least rate while the set point is not reached [deg/s].
        stop_within_deg: predicted error at which the valve closes.
        start_beyond_deg: error at which it opens again.
        overdrive: factor on the saturation voltage while the saturation rate is wanted, so that a joint whose
            dead-zone has grown still reaches it.
        opening_V: how much further the valve may open in a sample once beyond its dead-zone; closing is free.
    """

    gain: float
    braking_deg: float
    extra_delay_s: float
    correction: float
    learn_rate: float
    learn_edge: float
    slowest: float
    stop_within_deg: float
    start_beyond_deg: float
    overdrive: float
    opening_V: float


@cache
def tuning_data() -> dict[str, Any]:
    """Content of `feedforward.yaml`."""
    return yaml.safe_load(files(__package__).joinpath("feedforward.yaml").read_text(encoding="utf-8"))


def tuning() -> FeedforwardTuning:
    """The tuning found on perturbed machines (docs/control.md)."""
    return FeedforwardTuning(**{key: float(item["value"]) for key, item in tuning_data()["tuning"].items()})


_RUNNING, _STANDING, _ANGLE, _SET_POINT, _SLOPE = range(5)
_SHARE = {-1.0: 5, 1.0: 6}
_EDGE = {-1.0: 7, 1.0: 8}
_VOLTAGES = 9


@dataclass(frozen=True)
class FeedforwardLaw:
    """Moves a joint at the rate that its distance asks for, through the inverse of its measured rate map.

    - Prediction: where the joint will stand when the voltages that are still on their way have acted
      (the dead time of section 6.1.3, as a Smith predictor does for an integrating plant).
    - Wanted rate: gain times the predicted distance near the set point, farther off with its square root, as
      constant deceleration needs, the saturation rate at most; plus the set point's own velocity
      when it moves steadily.
    - Feedforward: the rate map's inverse gives the voltage, dead-zone and all; lever and gravity are in the
      map's share over the angle.
    - Learning: at saturation, how much faster or slower than its map the joint is (load, supply pressure);
      below, how far its dead-zone's edge lies from the map's. Both per direction, both bounded.
      This takes the integrator's place: nothing can wind up.

    Attributes:
        map: measured rates.
        sample_s: sample time.
        limit_V: largest voltage.
        tuning: free numbers.
    """

    map: RateMap
    sample_s: float
    limit_V: float
    tuning: FeedforwardTuning

    def __post_init__(self) -> None:
        """Refuse a dead time that is negative."""
        if self.map.dead_time_s + self.tuning.extra_delay_s < 0.0:
            raise InputError("feedforward control needs a dead time of at least 0 s")

    @property
    def _delay(self) -> tuple[int, float]:
        """Dead time in whole samples, and the rest as a share of one."""
        samples = (self.map.dead_time_s + self.tuning.extra_delay_s) / self.sample_s
        whole = int(samples + 1e-9)
        return whole, samples - whole

    @property
    def _window(self) -> int:
        """Samples over which a rate is measured."""
        return int(tuning_data()["limits"]["window"]["value"])

    @property
    def size(self) -> int:
        """Flags, estimate, set point and its slope, what is learned, past voltages, past estimates."""
        return _VOLTAGES + self._delay[0] + self._window + 2 + self._window

    def initial(self, measured_deg: float) -> Array:
        """At rest, nothing on its way, nothing learned."""
        state = np.zeros(self.size)
        state[_ANGLE] = state[_SET_POINT] = measured_deg
        state[_SHARE[-1.0]] = state[_SHARE[1.0]] = 1.0
        state[self.size - self._window :] = measured_deg
        return state

    def _rate(self, state: Array, voltage: float, angle: float) -> float:
        """Rate that a voltage gives once it acts [deg/s], with what has been learned."""
        if voltage == 0.0:
            return 0.0
        sign = copysign(1.0, voltage)
        size = rate_at(self.map.side(sign), abs(voltage) - float(state[_EDGE[sign]]))
        return sign * size * self.map.share(sign, angle) * float(state[_SHARE[sign]])

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`; the output is the wanted rate [deg/s]."""
        new = state.copy()
        whole, rest = self._delay
        window = self._window
        voltages = state[_VOLTAGES : self.size - window]
        angle = float(state[_ANGLE])
        rates = [self._rate(state, float(v), angle) for v in voltages]
        acted = (1.0 - rest) * rates[whole] + rest * rates[whole + 1]
        angle += acted * self.sample_s
        angle += self.tuning.correction * (measured_deg - angle)
        past = state[self.size - window :]
        self._learn(new, rates, (angle - float(past[-1])) / (window * self.sample_s))
        ahead = angle + self.sample_s * (sum(rates[:whole]) + rest * rates[whole])

        slope = (set_point_deg - float(state[_SET_POINT])) / self.sample_s
        limits = tuning_data()["limits"]
        steady = abs(slope - float(state[_SLOPE])) <= float(limits["slope_change"]["value"])
        velocity = slope if steady and float(state[_RUNNING]) else 0.0
        lead = self.map.dead_time_s + self.tuning.extra_delay_s
        distance = set_point_deg + velocity * lead - ahead
        wanted = self._wanted(new, distance, set_point_deg - angle, velocity)
        voltage = 0.0
        if wanted != 0.0:
            sign = copysign(1.0, wanted)
            scale = self.map.share(sign, ahead) * float(new[_SHARE[sign]])
            side = self.map.side(sign)
            size = voltage_for(side, abs(wanted) / scale) + float(new[_EDGE[sign]])
            if abs(wanted) / scale >= side.fastest:
                size = max(size, self.tuning.overdrive * side.voltages[-1])
            before = max(sign * float(voltages[0]), side.edge_V + float(new[_EDGE[sign]]))
            voltage = sign * min(size, before + self.tuning.opening_V, self.limit_V)
        new[_RUNNING] = 1.0
        new[_ANGLE], new[_SET_POINT], new[_SLOPE] = angle, set_point_deg, slope
        new[_VOLTAGES : self.size - window] = np.concatenate([[voltage], voltages[:-1]])
        new[self.size - window :] = np.concatenate([[angle], past[:-1]])
        return new, wanted, voltage

    def _wanted(self, new: Array, distance: float, error: float, velocity: float) -> float:
        """Rate for a predicted distance; closes the valve within the tolerance, with hysteresis."""
        tune = self.tuning
        if velocity == 0.0:
            if new[_STANDING] and abs(error) <= tune.start_beyond_deg:
                return 0.0
            if abs(distance) <= tune.stop_within_deg:
                new[_STANDING] = 1.0
                return 0.0
        new[_STANDING] = 0.0
        far = abs(distance)
        size = min(tune.gain * far, self.map.side(distance).fastest * sqrt(far / tune.braking_deg))
        if velocity == 0.0:
            size = max(size, tune.slowest)
        rate = copysign(size, distance) + velocity
        fastest = self.map.side(rate).fastest * float(tuning_data()["limits"]["fastest"]["value"])
        return min(max(rate, -fastest), fastest)

    def _learn(self, new: Array, rates: list[float], measured: float) -> None:
        """Compare the rate over the last samples with what the voltages that acted then should have given."""
        whole, window = self._delay[0], self._window
        acting = rates[whole : whole + window + 1]
        low, high = min(acting), max(acting)
        if low * high < 0.0 or low == high == 0.0:  # both directions, or none
            return
        sign = copysign(1.0, low + high)
        side = self.map.side(sign)
        expected = abs(sum(acting) / len(acting))
        got = measured * sign
        limits = tuning_data()["limits"]
        saturated = side.fastest * float(new[_SHARE[sign]]) * float(limits["saturated"]["value"])
        slowest, fastest = sorted((abs(low), abs(high)))
        if slowest >= saturated:
            bound = float(limits["share"]["value"])
            ratio = min(max(got / expected, 0.0), bound)
            share = float(new[_SHARE[sign]]) * (1.0 + self.tuning.learn_rate * (ratio - 1.0))
            new[_SHARE[sign]] = min(max(share, 1.0 / bound), bound)
        elif fastest < saturated:
            slope = (side.rates[1] - side.rates[0]) / (side.voltages[1] - side.voltages[0])
            edge = float(new[_EDGE[sign]]) + self.tuning.learn_edge * (expected - got) / slope
            bound = float(limits["edge"]["value"]) * side.edge_V
            new[_EDGE[sign]] = min(max(edge, -bound), bound)
