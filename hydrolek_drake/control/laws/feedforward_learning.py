"""How the feedforward law learns in what its joint differs from the rate map."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import copysign

from hydrolek_drake.control.laws.feedforward_memory import Memory
from hydrolek_drake.control.laws.feedforward_tuning import FeedforwardTuning, limit
from hydrolek_drake.control.laws.law import clipped
from hydrolek_drake.control.laws.rate_map import Direction, RateMap


@dataclass(frozen=True)
class UnderWay:
    """Voltages that have been sent, newest first, and what they should do.

    Attributes:
        voltages: [V].
        rates: that they should give once they act [deg/s].
        whole: dead time in whole samples.
        rest: the rest of it as a share of a sample.
    """

    voltages: Sequence[float]
    rates: Sequence[float]
    whole: int
    rest: float

    @property
    def acted(self) -> float:
        """Rate during the sample that has just ended [deg/s]."""
        return (1.0 - self.rest) * self.rates[self.whole] + self.rest * self.rates[self.whole + 1]

    @property
    def to_come(self) -> float:
        """Sum of the rates that have not acted yet; times the sample, the way still to come."""
        return sum(self.rates[: self.whole]) + self.rest * self.rates[self.whole]


def saturated_rate(memory: Memory, rates: RateMap, sign: float) -> float:
    """Rate from which a joint counts as saturated in a direction [deg/s]."""
    return limit("saturated") * rates.side(sign).fastest * memory.share(sign)


def within(side: Direction, shift_V: float) -> float:
    """Shift of a dead-zone's edge [V], within what may be learned."""
    return clipped(shift_V, (-limit("edge_less") * side.edge_V, limit("edge_more") * side.edge_V))


def learn_rates(
    memory: Memory,
    rates: RateMap,
    tuning: FeedforwardTuning,
    sent: UnderWay,
    moved_deg: float,
    sample_s: float,
) -> None:
    """Compare the way of the last samples with what the voltages that acted then should have given.

    At saturation the rate is learned, below it the dead-zone's edge: by its share of the deviation, and at once as
    far as a voltage that did not move the joint tells that the dead-zone reaches.

    Args:
        memory: is changed.
        rates: the joint's map.
        tuning: how fast.
        sent: voltages under way.
        moved_deg: way over the window.
        sample_s: of the law.
    """
    window = int(limit("window"))
    acting = sent.rates[sent.whole : sent.whole + window + 1]
    low, high = min(acting), max(acting)
    if low * high < 0.0 or low == high == 0.0:  # both directions, or none
        return
    sign = copysign(1.0, low + high)
    side = rates.side(sign)
    expected = abs(sum(acting) / len(acting))
    got = sign * moved_deg / (window * sample_s)
    saturated = saturated_rate(memory, rates, sign)
    slowest, fastest = sorted((abs(low), abs(high)))
    if slowest >= saturated:
        bound = limit("share")
        ratio = clipped(got / expected, (0.0, bound))
        share = memory.share(sign) * (1.0 + tuning.learn_rate * (ratio - 1.0))
        memory.learn_share(sign, clipped(share, (1.0 / bound, bound)))
    elif fastest < saturated:
        slope = (side.rates[1] - side.rates[0]) / (side.voltages[1] - side.voltages[0])
        newer = sent.whole + 1 + round(sent.rest)  # acted long enough ago for the joint to have followed
        coasting = max(map(abs, sent.rates[newer : newer + window + 1])) >= saturated
        if coasting:  # how a joint is braked tells more of valve and load than of the edge
            return
        edge = memory.edge(sign) + tuning.learn_edge * (expected - got) / slope
        should_deg = sign * (sent.rates[newer] + sent.rates[newer + 1]) * sample_s
        if should_deg >= limit("stalled") and sign * moved_deg < limit("standing") * should_deg:
            edge = max(edge, min(abs(sent.voltages[newer]), abs(sent.voltages[newer + 1])) - side.edge_V)
        memory.learn_edge(sign, within(side, edge))


def learn_landing(memory: Memory, tuning: FeedforwardTuning, rested_deg: float) -> None:
    """A braked joint that rests beyond where it was expected has a longer dead time: way beyond over rate."""
    sign = copysign(1.0, memory.landing)
    late = memory.late(sign) + tuning.learn_landing * (rested_deg - memory.rest_deg) / memory.landing
    memory.learn_late(sign, clipped(late, (0.0, limit("late"))))
    memory.landing = 0.0


def grow_push(
    memory: Memory, tuning: FeedforwardTuning, sent: UnderWay, moved_deg: float, error_deg: float, reach_s: float,
    sample_s: float,
) -> None:  # fmt: skip
    """While a joint stands although it should move, the wanted rate grows with the error; it ends with movement.

    Args:
        memory: is changed.
        tuning: how fast.
        sent: voltages under way.
        moved_deg: way over the window.
        error_deg: distance of the set point.
        reach_s: how long it takes until movement is seen.
        sample_s: of the law.
    """
    expected = sum(sent.rates[sent.whole : sent.whole + int(limit("window"))]) * sample_s
    stands = copysign(1.0, expected) * moved_deg < limit("standing") * abs(expected)
    if abs(expected) >= limit("stuck") and stands:
        memory.push += tuning.push * abs(error_deg) / reach_s**2 * sample_s
    else:
        memory.push = 0.0
