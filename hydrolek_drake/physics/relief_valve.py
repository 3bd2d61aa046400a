"""A relief valve on a pump's line, which has a setting, a slope, a hysteresis and a lag: one step of both."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.smooth import exponential, logarithm

RESOLVED = 1.0 / 3.0
"""A lag of less than this share of a step is none: the step's method would let it swing (R(z) < 0 for z < -3)."""


@njit
def relieved(above: float, rate: float, slope: float, h: float) -> float:
    """Pressure above the relief valve's setting after `h` seconds [Pa], exactly: du/dt = rate + slope max(u, 0).

    Below the setting it goes on a straight line, above it towards its balance; where it passes the setting, each way
    has its share of the time.

    Args:
        above: pressure above the setting now, below zero where the valve is closed [Pa].
        rate: with the valve closed [Pa/s].
        slope: below zero [1/s].
        h: [s].
    """
    balance = -rate / slope
    if above <= 0.0:
        reached = above + h * rate
        if reached <= 0.0:
            return reached
        return balance * (1.0 - exponential(slope * (reached / rate)))
    later = balance + (above - balance) * exponential(slope * h)
    if later >= 0.0:
        return later
    closes = logarithm(1.0 - above / balance) / -slope
    return rate * (h - closes)


@njit
def relieved_by_valve(
    above: float, valve: float, rate: float, slope: float, h: float, joint: Any
) -> tuple[float, float]:
    """Pressure above the relief valve's setting after `h` seconds, and where the valve stands [Pa].

    Arguments as of `relieved_with_play`, for a valve that follows at once or sooner than a step can tell, and
    `relieved_with_lag`.
    """
    if joint.supply.relief_time > RESOLVED * h:
        return relieved_with_lag(above, valve, rate, slope, h, joint)
    return relieved_with_play(above, valve, rate, slope, h, joint)


@njit
def relieved_with_lag(
    above: float, valve: float, rate: float, slope: float, h: float, joint: Any
) -> tuple[float, float]:
    """The same with a relief valve that follows with a time constant T: u' = rate + slope b, T b' = b_0(u, b) - b.

    The valve's place b, which lets off what the pressure b above the setting would without hysteresis, is drawn to the
    nearer edge b_0 of its play and rests on its seat at zero. With the oil of the line it is an oscillator of the
    frequency sqrt(-slope/T) and the damping 1/(2 T) (Merritt, Hydraulic Control Systems, 1967, section 9.2: a relief
    valve's lag and the compliance of what it protects). A step has up to three parts: until the valve begins to move,
    while it moves, and after it has stopped.

    Args:
        above: pressure above the relief valve's setting, u [Pa].
        valve: where the valve stands, b [Pa].
        rate: with the valve closed [Pa/s].
        slope: below zero [1/s].
        h: [s].
        joint: parameter record.
    """
    p = joint.supply
    half = 0.5 * p.relief_hysteresis
    now = rate + slope * valve
    to_open, to_close = valve + half - above, above - valve + half  # below zero beyond that edge
    opens = to_open < 0.0 or (now >= 0.0 and (to_close >= 0.0 or valve <= 0.0))
    way = 1.0 if opens else -1.0
    left, speed = (to_open, now) if opens else (to_close, -now)
    begins = h
    if left < 0.0 and (opens or valve > 0.0):
        begins = 0.0
    elif left < speed * h and (opens or valve > 0.0):
        begins = left / speed
    moves, balance = h - begins, -rate / slope
    edge = way * half
    drawn = above + now * begins - edge
    pressure, place = _followed(drawn, valve, balance, slope * moves, moves / p.relief_time)
    share = 1.0
    back = way * (place - pressure)
    if half > 0.0 and moves > 0.0 and back > 0.0:  # it stops where the pressure turns back
        on = max(way * (drawn - valve), 0.0)  # rounding may leave it on the other side of the edge
        share = on / (on + back)
    if place < 0.0:  # and on its seat
        share = min(share, valve / (valve - place))
    if share < 1.0:
        part = share * moves
        pressure, place = _followed(drawn, valve, balance, slope * part, part / p.relief_time)
        place = max(place, 0.0)
        pressure += (rate + slope * place) * (moves - part)
    return max(pressure + edge, p.tank_pressure - p.pressure), place


@njit
def _followed(drawn: float, valve: float, balance: float, slope: float, share: float) -> tuple[float, float]:
    """Pressure and valve after a while in which the valve follows, as `relieved_with_lag` has them [Pa].

    One step of the two-stage Radau IIA method (third order and L-stable; Hairer, Wanner, Solving Ordinary Differential
    Equations II, 1996, section IV.5) from the balance of both: y' = N^-1 (I + A/3) y, N = I - 2A/3 + A^2/6.

    Args:
        drawn: pressure above the setting, less the edge of the play that draws the valve [Pa].
        valve: where it stands [Pa].
        balance: where both would settle [Pa].
        slope: d(du/dt)/db times the while.
        share: the while over the valve's time constant.
    """
    u, b = drawn - balance, valve - balance
    product = slope * share
    n_uu, n_ub = 1.0 + product / 6.0, -slope * (2.0 / 3.0 + share / 6.0)
    n_bu = -share * (2.0 / 3.0 + share / 6.0)
    n_bb = 1.0 + share * (2.0 / 3.0 + share / 6.0) + product / 6.0
    on_u, on_b = u + slope * b / 3.0, b + share * (u - b) / 3.0
    by = 1.0 / (n_uu * n_bb - n_ub * n_bu)
    return balance + (n_bb * on_u - n_ub * on_b) * by, balance + (n_uu * on_b - n_bu * on_u) * by


@njit
def relieved_with_play(
    above: float, valve: float, rate: float, slope: float, h: float, joint: Any
) -> tuple[float, float]:
    """The same with a relief valve that sticks within its hysteresis: pressure, and where the valve stands [Pa].

    The valve's place is the pressure above its setting that it would have without hysteresis; it stays while the
    pressure is within half of the hysteresis of it, and follows beyond (a play). Both go one way within a step.

    Args:
        above: pressure above the relief valve's setting [Pa].
        valve: where the valve stands [Pa].
        rate: with the valve closed [Pa/s].
        slope: below zero [1/s].
        h: [s].
        joint: parameter record.
    """
    half = 0.5 * joint.supply.relief_hysteresis
    if half <= 0.0:
        later = relieved(above, rate, slope, h)
        return later, later
    now = rate + slope * max(valve, 0.0)
    edge = half if now >= 0.0 else -half
    left = valve + edge - above  # until the valve begins to move
    if now == 0.0 or abs(left) >= abs(now) * h:
        return above + now * h, valve
    later = relieved(valve, rate, slope, h - max(left / now, 0.0))
    return later + edge, later
