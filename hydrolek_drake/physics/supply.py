"""Pump and return line, shared by all joints: at a constant pressure, or with a relief valve and a line's volume."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.fluid import effective_bulk_modulus
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.smooth import exponential, logarithm
from hydrolek_drake.physics.usual import rare

_TANK = Parameter("tank_pressure", "Pa", "return line pressure, P_T", lowest=0.0)

STAGE = Stage(
    "supply",
    "pump and return line, shared by all joints",
    (),
    {
        "constant_pressure": (
            Parameter("pressure", "Pa", "pump pressure, P_S", lowest=0.0),
            _TANK,
            Parameter(
                "flow_time_constant",
                "s",
                "how fast the supply pressure answers to the flow drawn",
                lowest=0.0,
                positive=True,
            ),
        ),
        "pump": (
            Parameter(
                "pressure",
                "Pa",
                "setting of the relief valve, at which it begins to open without a hysteresis",
                lowest=0.0,
            ),
            _TANK,
            Parameter("displacement", "m^3/rad", "of the pump", lowest=0.0, positive=True),
            Parameter("speed", "rad/s", "of the pump's shaft", lowest=0.0, positive=True),
            Parameter(
                "pump_leakage",
                "m^3/(s Pa)",
                "what the pump loses at its outlet's pressure",
                neutral=0.0,
                lowest=0.0,
            ),
            Parameter(
                "relief_slope",
                "Pa s/m^3",
                "rise of pressure per flow that the relief valve lets off",
                lowest=0.0,
                positive=True,
            ),
            Parameter(
                "relief_hysteresis",
                "Pa",
                "by how much the relief valve closes below the pressure at which it opens",
                neutral=0.0,
                lowest=0.0,
            ),
            Parameter(
                "relief_time",
                "s",
                "time constant with which the relief valve follows the pressure",
                neutral=0.0,
                lowest=0.0,
            ),
            Parameter("line_volume", "m^3", "oil between pump and valves", lowest=0.0, positive=True),
            Parameter(
                "initial_pressure",
                "Pa",
                "pressure of the line at the start, 0 for what it is at rest",
                neutral=0.0,
                lowest=0.0,
            ),
            Parameter(
                "initial_relief",
                "1",
                "share of what the relief valve lets off at rest that it lets off at the start; 0 if it is closed",
                neutral=1.0,
                lowest=0.0,
            ),
        ),
    },
    default="constant_pressure",
)
CONSTANT_PRESSURE = float(STAGE.code("constant_pressure"))
PUMP = float(STAGE.code("pump"))

RESOLVED = 1.0 / 3.0
"""A lag of less than this share of a step is none: the step's method would let it swing (R(z) < 0 for z < -3)."""


@njit
def supply_pressure(remembered: float, joint: Any) -> float:
    """Pressure at the valves [Pa]; what an empty line would have is the tank's.

    Args:
        remembered: the flow that all joints together have drawn, low-passed [m^3/s]; of a pump with its relief valve,
            by how much the line's pressure lies above that valve's setting [Pa].
        joint: parameter record.
    """
    p = joint.supply
    if rare(joint) and p.variant == PUMP:
        return max(p.pressure + remembered, p.tank_pressure)
    return max(p.pressure - hooks.supply_drop(remembered, joint), p.tank_pressure)


@njit
def rate_of_change(remembered: float, relief: float, drawn: float, joint: Any) -> tuple[float, float]:
    """Rate of what the supply remembers, and the slope of it that can be stiff [1/s].

    A constant pressure remembers the flow drawn, dQ/dt = (Q_drawn - Q)/T, without a slope. A pump's line fills with
    dp/dt = B/V (D w - leakage - Q_drawn - Q_relief). A relief valve that stands at b lets off b/R at the pressure
    p_0 + b that it would have without hysteresis (Merritt, Hydraulic Control Systems, 1967, section 9.2: static
    characteristic with the gain 1/R), and through the same opening, which is an orifice,
    Q_relief = b/R sqrt((p - p_T)/(p_0 + b - p_T)) at another one. What b/R takes is left to `relieved_by_valve`: the
    slope is -B/(V R).

    Args:
        remembered: see `supply_pressure`.
        relief: where the relief valve stands [Pa].
        drawn: flow that all joints draw together [m^3/s].
        joint: parameter record.
    """
    p = joint.supply
    if rare(joint) and p.variant == PUMP:
        pressure, opened = p.pressure + remembered, max(relief, 0.0)
        stiffness = effective_bulk_modulus(max(pressure, 0.0), joint) / p.line_volume
        slope = -stiffness / p.relief_slope
        rate = stiffness * (pumped(pressure, joint) - drawn)
        drop = max(pressure - p.tank_pressure, 0.0)
        rate += slope * opened * (math.sqrt(drop / (p.pressure + opened - p.tank_pressure)) - 1.0)
        if pressure <= p.tank_pressure:
            rate = max(rate, -slope * opened)
        return rate, slope
    return (drawn - remembered) / p.flow_time_constant, 0.0


@njit
def advanced(
    remembered: float, relief: float, rate: float, slope: float, h: float, joint: Any
) -> tuple[float, float]:
    """What the supply remembers after `h` seconds with a held rate, and where its relief valve stands [Pa].

    Args:
        remembered: see `supply_pressure`.
        relief: where the relief valve stands now; it stays so where there is none [Pa].
        rate: of `rate_of_change`.
        slope: of it, where it is left to the relief valve [1/s].
        h: [s].
        joint: parameter record.
    """
    if rare(joint) and joint.supply.variant == PUMP:
        return relieved_by_valve(remembered, relief, rate, slope, h, joint)
    return remembered + h * rate, relief


@njit
def pumped(pressure: float, joint: Any) -> float:
    """Flow that the pump gives against a pressure [m^3/s]."""
    p = joint.supply
    return p.displacement * p.speed * (1.0 - hooks.pump_loss(joint)) - p.pump_leakage * pressure


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
    if (
        half > 0.0 and moves > 0.0 and way * (pressure - place) < 0.0
    ):  # it stops where the pressure turns back
        share = (drawn - valve) / ((drawn - valve) - (pressure - place))
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


@njit
def at_start(joint: Any) -> tuple[float, float]:
    """What a supply remembers at the start, and where its relief valve stands [Pa]: as at rest, or as the rig says."""
    rest = at_rest(joint)
    p = joint.supply
    if not rare(joint) or p.variant != PUMP:
        return rest, rest
    first = p.initial_pressure - p.pressure if p.initial_pressure > 0.0 else rest
    return first, p.initial_relief * rest


@njit
def at_rest(joint: Any) -> float:
    """What a supply remembers that has run for a while and of which nothing is drawn."""
    p = joint.supply
    if not rare(joint) or p.variant != PUMP:
        return 0.0
    left = pumped(p.pressure, joint)
    if left > 0.0:
        return left * p.relief_slope / (1.0 + p.pump_leakage * p.relief_slope)
    # a pump that leaks more than it gives at the setting
    return max(left / p.pump_leakage if p.pump_leakage > 0.0 else -p.pressure, -p.pressure)
