"""Pump and return line, shared by all joints: at a constant pressure, or with a relief valve and a line's volume."""

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
            Parameter("line_volume", "m^3", "oil between pump and valves", lowest=0.0, positive=True),
        ),
    },
    default="constant_pressure",
)
CONSTANT_PRESSURE = float(STAGE.code("constant_pressure"))
PUMP = float(STAGE.code("pump"))


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
def rate_of_change(remembered: float, drawn: float, joint: Any) -> tuple[float, float]:
    """Rate of what the supply remembers, and the slope of it that can be stiff [1/s].

    A constant pressure remembers the flow drawn, dQ/dt = (Q_drawn - Q)/T, without a slope. A pump's line fills with
    dp/dt = B/V (D w - leakage - Q_drawn) less what the relief valve lets off, which is left to `relieved`: a share
    of the pressure above its setting, B/(V R) each second, with the slope -B/(V R) (Merritt, Hydraulic Control
    Systems, 1967, section 9.2: a relief valve's static characteristic with its gain 1/R).
    """
    p = joint.supply
    if rare(joint) and p.variant == PUMP:
        pressure = p.pressure + remembered
        stiffness = effective_bulk_modulus(max(pressure, 0.0), joint) / p.line_volume
        rate = stiffness * (pumped(pressure, joint) - drawn)
        if pressure <= p.tank_pressure:
            rate = max(rate, 0.0)
        return rate, -stiffness / p.relief_slope
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
        return relieved_with_play(remembered, relief, rate, slope, h, joint)
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
