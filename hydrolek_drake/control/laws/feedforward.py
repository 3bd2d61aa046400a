"""Rate control with model-based feedforward: inverse rate map, delay compensation, learning of what differs."""

from dataclasses import dataclass
from math import copysign

from hydrolek_drake.control.laws.feedforward_jog import begins, jog
from hydrolek_drake.control.laws.feedforward_learning import (
    UnderWay,
    grow_push,
    learn_landing,
    learn_rates,
    saturated_rate,
)
from hydrolek_drake.control.laws.feedforward_memory import SCALARS, Memory
from hydrolek_drake.control.laws.feedforward_tuning import FeedforwardTuning, limit
from hydrolek_drake.control.laws.law import Array, clipped
from hydrolek_drake.control.laws.rate_map import RateMap, rate_at, voltage_for
from hydrolek_drake.errors import InputError

_ROUNDING = 1e-9


@dataclass(frozen=True)
class FeedforwardLaw:
    """Moves a joint at the rate that its distance asks for, through the inverse of its measured rate map.

    - Prediction: where the joint will stand when the voltages that are still on their way have acted
      (the dead time of section 6.1.3, as a Smith predictor does for an integrating plant).
    - Wanted rate: far off the saturation rate, where the dead-zone does not matter. A joint at that rate is braked in
      equal steps so that it stops a little before the set point; then the valve waits, just closed, until it has been
      seen where the joint stopped. The rest, and small distances, are moved at a rate of gain times the predicted
      distance. A set point that moves steadily adds its own velocity.
    - Feedforward: the rate map's inverse gives the voltage, dead-zone and all; lever and gravity are in the
      map's share over the angle.
    - Voltage: through the dead-zone and when opening it moves by bounded steps; closing is free.
    - Jogs (`feedforward_jog.py`): the first large step in a direction begins with a short opening of the valve that
      tells where the dead-zone ends, and the dead time.
    - Learning (`feedforward_learning.py`): how fast the joint saturates, where its dead-zone ends, its dead time. All
      per direction and bounded. This takes the integrator's place: nothing can wind up.

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
        if self.map.dead_time_s < 0.0:
            raise InputError("feedforward control needs a dead time of at least 0 s")

    def _samples(self, late_s: float) -> tuple[int, float]:
        """Dead time in whole samples, and the rest as a share of one."""
        samples = (self.map.dead_time_s + late_s) / self.sample_s
        whole = int(samples + _ROUNDING)
        return whole, samples - whole

    @property
    def _window(self) -> int:
        """Samples over which a rate is measured."""
        return int(limit("window"))

    @property
    def _kept(self) -> int:
        """Past voltages that are kept: of the longest dead time, and of the window in which they are judged."""
        return self._samples(limit("late"))[0] + self._window + 3

    @property
    def size(self) -> int:
        """Numbers of a `Memory`."""
        return SCALARS + self._kept + self._window

    def memory(self, state: Array) -> Memory:
        """A state by name."""
        return Memory.unpack(state, self._kept)

    def initial(self, measured_deg: float) -> Array:
        """At rest, nothing on its way, nothing learned."""
        return Memory.at_rest(measured_deg, self._kept, self._window).pack()

    def _rate(self, memory: Memory, voltage: float) -> float:
        """Rate that a voltage gives once it acts [deg/s], with what has been learned."""
        if voltage == 0.0:
            return 0.0
        sign = copysign(1.0, voltage)
        size = rate_at(self.map.side(sign), abs(voltage) - memory.edge(sign))
        return sign * size * self.map.share(sign, memory.angle) * memory.share(sign)

    def _edge(self, memory: Memory, sign: float) -> float:
        """Where the dead-zone ends, with what has been learned [V]."""
        return self.map.side(sign).edge_V + memory.edge(sign)

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`; the output is the wanted rate [deg/s]."""
        memory = self.memory(state)
        rates = [self._rate(memory, voltage) for voltage in memory.voltages]
        moving = next((r for r in reversed(rates[: self._samples(0.0)[0] + 2]) if r != 0.0), 0.0)
        sent = UnderWay(memory.voltages, rates, *self._samples(memory.late(moving)))
        hold = sent.whole + 1 + self._window  # samples until what was sent has acted and been seen
        self._estimate(memory, sent, measured_deg)
        moved = memory.angle - memory.estimates[-1]
        grow_push(
            memory, self.tuning, sent, moved, set_point_deg - memory.angle,
            self.map.dead_time_s + self._window * self.sample_s, self.sample_s,
        )  # fmt: skip

        slope = (set_point_deg - memory.set_point) / self.sample_s
        steady = abs(slope - memory.slope) <= limit("slope_change")
        velocity = slope if steady and memory.running else 0.0
        ahead = memory.angle + self.sample_s * sent.to_come
        distance = set_point_deg + velocity * (sent.whole + sent.rest) * self.sample_s - ahead
        same = set_point_deg == memory.set_point
        if velocity == 0.0 and self._arrived(
            memory, sent, distance, set_point_deg - memory.mean, moving, same, hold
        ):
            wanted = 0.0
        else:
            memory.standing = 0.0
            wanted = self._wanted(memory, sent, distance, velocity)
        jogged: float | None = None
        jogging = memory.jog or memory.jog_again or begins(memory, sent, distance)
        if jogging and same and wanted and velocity == 0.0:
            jogged = jog(
                memory, self.map, measured_deg, distance, self.tuning.closed, sent.whole, self.sample_s
            )
        else:
            memory.jog = memory.jog_again = 0.0
        if jogged is None:
            voltage = self._voltage(memory, wanted, ahead, hold)
        else:
            wanted, voltage = self._rate(memory, jogged), jogged
        voltage = self._slewed(memory, voltage)
        if memory.standing == 1.0 and self._braked(memory, sent):
            memory.rest_deg, memory.landing = ahead, rates[int(limit("steps"))]
        elif memory.standing == 0.0:
            memory.landing = 0.0
        elif memory.standing >= hold and memory.landing != 0.0:
            learn_landing(memory, self.tuning, memory.mean)
        memory.running, memory.set_point, memory.slope = 1.0, set_point_deg, slope
        memory.voltages = [voltage, *memory.voltages[:-1]]
        memory.estimates = [memory.angle, *memory.estimates[:-1]]
        return memory.pack(), wanted, voltage

    def _estimate(self, memory: Memory, sent: UnderWay, measured_deg: float) -> None:
        """Where the joint stands: prediction and reading, and what the difference teaches.

        Of a deviation that noise or a swinging load explains only a share is believed, of a larger one the rest too.
        """
        memory.angle += sent.acted * self.sample_s
        off = measured_deg - memory.angle
        explained = clipped(off, (-limit("band"), limit("band")))
        taken = off - (1.0 - self.tuning.correction) * explained
        memory.angle += taken
        moved = memory.angle - memory.estimates[-1]
        learn_rates(memory, self.map, self.tuning, sent, moved, self.sample_s)

    def _braked(self, memory: Memory, sent: UnderWay) -> bool:
        """Whether the joint has just been braked from saturation in as many steps as that takes."""
        steps = int(limit("steps"))
        sign = copysign(1.0, sum(sent.rates))
        full = saturated_rate(memory, self.map, sign)
        return sign * sent.rates[steps] >= full and all(sign * rate < full for rate in sent.rates[:steps])

    def _arrived(
        self, memory: Memory, sent: UnderWay, distance: float, error: float, moving: float, same: bool, hold: int
    ) -> bool:  # fmt: skip
        """Whether the valve is to be closed; counts how long it has been.

        It closes when the joint is predicted to stop within the tolerance or beyond the set point, or has been
        braked; it opens again when everything sent has acted and the mean error is too large, or for another set point.
        """
        if memory.standing and same:
            memory.standing += 1.0
            return memory.standing <= hold or abs(error) <= self.tuning.start_beyond_deg
        passed = same and moving * distance < 0.0
        if abs(distance) <= self.tuning.stop_within_deg or passed or self._braked(memory, sent):
            memory.standing = 1.0
            return True
        return False

    def _wanted(self, memory: Memory, sent: UnderWay, distance: float, velocity: float) -> float:
        """Rate for a predicted distance [deg/s]."""
        tune = self.tuning
        sign, far = copysign(1.0, distance), abs(distance)
        fast = self.map.side(sign).fastest * memory.share(sign)
        full = saturated_rate(memory, self.map, sign)
        left = max(far - fast * tune.landing_s, 0.0) / self.sample_s
        steps = int(limit("steps"))
        since = next((i for i in range(steps) if sign * sent.rates[i] >= full), steps)
        if left > tune.braking * fast * (1.0 if since == 0 else tune.starting):
            size = limit("fastest") * fast
        elif since < steps:
            size = left / (steps - since)
        else:
            size = min(tune.gain * far + memory.push, fast)
        if velocity == 0.0:
            size = max(size, tune.slowest)
        rate = copysign(size, distance) + velocity
        fastest = limit("fastest") * self.map.side(rate).fastest
        return clipped(rate, (-fastest, fastest))

    def _voltage(self, memory: Memory, wanted: float, ahead: float, hold: int) -> float:
        """Voltage for a wanted rate; at rest none, but the valve is held just closed until that is sure."""
        if wanted == 0.0:
            before = memory.voltages[0]
            if not 1.0 <= memory.standing <= hold:
                return 0.0
            return copysign(min(abs(before), self.tuning.closed * self._edge(memory, before)), before)
        sign = copysign(1.0, wanted)
        side = self.map.side(sign)
        size = abs(wanted) / (self.map.share(sign, ahead) * memory.share(sign))
        if size >= side.fastest:
            volts = side.voltages[-1] + max(memory.edge(sign), self.tuning.reserve * side.edge_V)
        else:
            volts = voltage_for(side, size) + memory.edge(sign)
        return sign * min(volts, self.limit_V)

    def _slewed(self, memory: Memory, voltage: float) -> float:
        """A voltage within reach of the last one: opening and crossing the dead-zone go by bounded steps."""
        tune, before = self.tuning, memory.voltages[0]
        if voltage * before < 0.0 or abs(voltage) < abs(before):
            closed = tune.closed * self._edge(memory, before)
            least = closed if abs(before) > closed else abs(before) - tune.crossing_V
            return copysign(1.0, before) * max(voltage * copysign(1.0, before), least)
        edge = self._edge(memory, voltage)
        if abs(before) >= tune.closed * edge - _ROUNDING:
            most = abs(before) + tune.opening_V
        else:
            most = min(abs(before) + tune.crossing_V, edge)
        return copysign(min(abs(voltage), most), voltage)
