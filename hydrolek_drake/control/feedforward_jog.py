"""How the feedforward law finds the dead-zone's edge and the dead time before its first large step in a direction.

Near the set point a voltage is sent whose rate is small. On a valve whose dead-zone has grown this does nothing, and
the joint stops short. So the first large step in a direction begins with a jog: the valve opens for two samples. If the
edge is where it is expected, the joint moves by a small share of the step; its way then confirms the edge, and when it
moved tells the dead time. If it does not move, the dead-zone reaches at least that far, and the next jog reaches
further. Nothing moves but in the direction that was asked for.
"""

import math
from math import copysign

from hydrolek_drake.control.feedforward_learning import UnderWay, within
from hydrolek_drake.control.feedforward_memory import Memory
from hydrolek_drake.control.feedforward_tuning import limit
from hydrolek_drake.control.law import clipped
from hydrolek_drake.control.rate_map import Direction, RateMap, rate_at, voltage_for


def begins(memory: Memory, sent: UnderWay, distance_deg: float) -> bool:
    """Whether a joint at rest is to be jogged first: a large step in a direction whose edge no jog has told.

    Args:
        memory: of the joint.
        sent: voltages under way.
        distance_deg: of the set point.
    """
    sign = copysign(1.0, distance_deg)
    return not memory.known(sign) and abs(distance_deg) >= limit("jog_from") and not any(sent.rates)


def jog(
    memory: Memory,
    rates: RateMap,
    measured_deg: float,
    distance_deg: float,
    closed: float,
    hold: int,
    sample_s: float,
) -> float | None:
    """Voltage of a jog's next sample [V]; None when the edge is known.

    The valve goes to just closed, opens for some samples, and is held just closed until the joint has been seen to
    stop. What the joint has moved is then compared with the rate map.

    Args:
        memory: is changed.
        rates: the joint's map.
        measured_deg: reading.
        distance_deg: of the set point.
        closed: share of the dead-zone at which the valve is held just closed.
        hold: samples until what was sent has acted and been seen.
        sample_s: of the law.
    """
    sign = copysign(1.0, distance_deg)
    side = rates.side(sign)
    shut_V = closed * (side.edge_V + memory.edge(sign))
    opened = int(limit("jog_samples"))
    open_s = opened * sample_s * rates.share(sign, memory.angle) * memory.share(sign)
    if memory.jog == 0.0:
        memory.jog = 1.0
    if memory.jog == 1.0:
        if sign * memory.voltages[0] < shut_V:  # not yet there
            return sign * shut_V
        memory.jog_deg, memory.jog_sum, memory.jog_edge_V = _mean(memory), 0.0, memory.edge(sign)
        memory.jog_V = _reach(memory, side, sign, distance_deg, open_s)
    else:
        memory.jog_sum += sign * (measured_deg - memory.jog_deg)
    memory.jog += 1.0
    if memory.jog <= 1 + opened:
        return sign * memory.jog_V
    if memory.jog <= 1 + opened + hold + limit("jog_wait"):
        return sign * shut_V
    expected_deg = open_s * rate_at(side, memory.jog_V - memory.jog_edge_V)
    if not _learned(memory, rates, sign, expected_deg, open_s, sample_s):
        memory.jog = 1.0
        return sign * closed * (side.edge_V + memory.edge(sign))
    memory.jog = 0.0
    return None


def _mean(memory: Memory) -> float:
    """Angle, averaged over the window: a period of a swinging load [deg]."""
    return (memory.angle + sum(memory.estimates)) / (1 + len(memory.estimates))


def _reach(memory: Memory, side: Direction, sign: float, distance_deg: float, open_s: float) -> float:
    """Size of a jog's voltage [V]: what moves the joint by a share of the step, but not far beyond the edge."""
    way = clipped(limit("jog_share") * abs(distance_deg), (0.0, limit("jog_most")))
    moving_V = voltage_for(side, way / open_s)
    return memory.edge(sign) + min(moving_V, (1.0 + limit("jog_reach")) * side.edge_V)


def _learned(
    memory: Memory, rates: RateMap, sign: float, expected_deg: float, open_s: float, sample_s: float
) -> bool:
    """Take edge and dead time from a jog that has ended; whether the joint was seen to move.

    A way near the expected one confirms the edge: load and posture change it too. Of another one, the rate map's
    inverse tells how far beyond the edge the voltage was.
    """
    side = rates.side(sign)
    moved_deg = sign * (_mean(memory) - memory.jog_deg)
    confirmed = moved_deg >= limit("jog_less") * expected_deg
    shift_V = memory.jog_edge_V
    if not confirmed or moved_deg > limit("jog_more") * expected_deg:
        shift_V = memory.jog_V - voltage_for(side, max(moved_deg, 0.0) / open_s)
    memory.learn_edge(sign, within(side, shift_V))
    if moved_deg < limit("standing") * expected_deg and memory.edge(sign) < within(side, math.inf):
        return False
    if confirmed:
        # the mean time of the movement, by the trapezoidal rule, less that of the opening
        mean_s = sample_s * (memory.jog - 1.5 - memory.jog_sum / moved_deg)
        late = mean_s - 0.5 * limit("jog_samples") * sample_s - rates.dead_time_s
        memory.learn_late(sign, clipped(late, (0.0, limit("late"))))
    memory.learn_known(sign)
    if not memory.known(-sign):
        other = rates.side(-sign)
        shared_V = limit("jog_shared") * memory.edge(sign) * other.edge_V / side.edge_V
        memory.learn_edge(-sign, within(other, shared_V))
    return True
