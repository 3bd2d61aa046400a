"""How the feedforward law finds the dead-zone's edge and the dead time before its first large step in a direction.

Near the set point a voltage is sent whose rate is small. On a valve whose dead-zone has grown this does nothing, and
the joint stops short. So the first large step in a direction begins with a jog: the valve opens for two samples. If the
edge is where it is expected, the joint moves by a small share of the step; its way then confirms the edge, and when it
moved tells the dead time. If it does not move, the dead-zone reaches at least that far, and the next jog reaches
further. Nothing moves but in the direction that was asked for.
"""

from math import copysign, inf

from hydrolek_drake.control.laws.feedforward_learning import UnderWay, within
from hydrolek_drake.control.laws.feedforward_memory import Memory
from hydrolek_drake.control.laws.feedforward_tuning import limit
from hydrolek_drake.control.laws.law import clipped
from hydrolek_drake.control.laws.rate_map import Direction, RateMap, rate_at, voltage_for


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
    delay: int,
    sample_s: float,
) -> float | None:
    """Voltage of a jog's next sample [V]; None when the step itself may begin.

    The valve goes to just closed, opens for some samples, and is held just closed until the joint must have moved. If
    it has, the step begins, and until that acts the readings tell how far the jog went and when. If it has not, the
    next jog reaches further.

    Args:
        memory: is changed.
        rates: the joint's map.
        measured_deg: reading.
        distance_deg: of the set point.
        closed: share of the dead-zone at which the valve is held just closed.
        delay: dead time in whole samples.
        sample_s: of the law.
    """
    sign = copysign(1.0, distance_deg)
    side = rates.side(sign)
    shut_V = closed * (side.edge_V + memory.edge(sign))
    opened = int(limit("jog_samples"))
    open_s = opened * sample_s * rates.share(sign, memory.angle) * memory.share(sign)
    if memory.jog == 0.0:
        if sign * memory.voltages[0] < shut_V:  # not yet there
            return sign * shut_V
        _begin(memory, side, sign, distance_deg, open_s)
        return sign * memory.jog_V
    memory.jog += 1.0
    moved_deg = sign * (measured_deg - memory.jog_deg)
    memory.jog_sum += sample_s * moved_deg
    since = int(memory.jog) - 1  # samples since the valve opened
    if since < opened:
        return sign * memory.jog_V
    done = opened + delay + 1
    if since < done:
        return sign * shut_V
    memory.jog_tail += moved_deg
    expected_deg = open_s * rate_at(side, memory.jog_V - memory.jog_edge_V)
    if since == done and moved_deg >= limit("standing") * expected_deg:
        memory.learn_known(sign)
    if since < done + (delay if memory.known(sign) else limit("jog_wait")):
        return None if memory.known(sign) else sign * shut_V
    since_s = sample_s * (since + 0.5 - 0.5 * opened)
    _take(memory, rates, sign, memory.jog_tail / (since - done + 1), expected_deg, open_s, since_s)
    return None if memory.known(sign) else sign * closed * (side.edge_V + memory.edge(sign))


def _take(
    memory: Memory,
    rates: RateMap,
    sign: float,
    moved_deg: float,
    expected_deg: float,
    open_s: float,
    since_s: float,
) -> None:
    """Take edge and dead time from a jog that has ended, or have another one follow.

    Args:
        memory: is changed.
        rates: the joint's map.
        sign: direction.
        moved_deg: how far the jog went.
        expected_deg: how far it should have gone.
        open_s: for how long the valve was open, times how much faster than in mid-range the joint moves.
        since_s: since the middle of the opening, and half a sample for the trapezoidal rule.
    """
    side = rates.side(sign)
    memory.learn_edge(sign, within(side, _shift_V(memory, side, moved_deg, expected_deg, open_s)))
    stands = moved_deg < limit("standing") * expected_deg
    if stands and not memory.known(sign) and memory.edge(sign) < within(side, inf):
        memory.jog, memory.jog_again = 0.0, 1.0
        memory.jog_deg += sign * moved_deg
        return
    if moved_deg >= limit("jog_less") * expected_deg:
        # from the mean time of the opening to that of the movement
        late = since_s - memory.jog_sum / moved_deg - rates.dead_time_s
        memory.learn_late(sign, clipped(late, (0.0, limit("late"))))
    memory.jog = memory.jog_again = 0.0
    memory.learn_known(sign)
    if not memory.known(
        -sign
    ):  # a spring, an amplifier or a supply that has changed acts on both sides alike
        other = rates.side(-sign)
        memory.learn_edge(-sign, within(other, memory.edge(sign) * other.edge_V / side.edge_V))


def _begin(memory: Memory, side: Direction, sign: float, distance_deg: float, open_s: float) -> None:
    """Open the valve by what moves the joint by a share of the step, but not far beyond the edge."""
    way = clipped(limit("jog_share") * abs(distance_deg), (0.0, limit("jog_most")))
    reach_V = min(voltage_for(side, way / open_s), (1.0 + limit("jog_reach")) * side.edge_V)
    if (
        not memory.jog_again
    ):  # after a jog that was not answered the estimate has not come back to the readings yet
        memory.jog_deg = memory.mean
    memory.jog, memory.jog_sum, memory.jog_tail = 1.0, 0.0, 0.0
    memory.jog_edge_V = memory.edge(sign)
    memory.jog_V = memory.edge(sign) + reach_V


def _shift_V(memory: Memory, side: Direction, moved_deg: float, expected_deg: float, open_s: float) -> float:
    """How far the edge is shifted [V].

    A way near the expected one confirms what was known: load and posture change it too. Of another one, the rate map's
    inverse tells how far beyond the edge the voltage was. After a jog that did not move the joint, no way is too long:
    the edge is not nearer than that one reached.
    """
    longer = moved_deg > limit("jog_more") * expected_deg and not memory.jog_again
    if not longer and moved_deg >= limit("jog_less") * expected_deg:
        return memory.jog_edge_V
    return memory.jog_V - voltage_for(side, max(moved_deg, limit("jog_unseen")) / open_s)
