"""Pump and return line, shared by all joints: at a constant pressure, or with a relief valve and a line's volume."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.fluid import softened, stiffness
from hydrolek_drake.physics.lines import accumulator
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.relief_valve import relieved_by_valve
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
    slope is -B/(V R). An accumulator's gas takes oil besides, `accumulator.gas_capacity`.

    Args:
        remembered: see `supply_pressure`.
        relief: where the relief valve stands [Pa].
        drawn: flow that all joints draw together [m^3/s].
        joint: parameter record.
    """
    p = joint.supply
    if rare(joint) and p.variant == PUMP:
        pressure, opened = p.pressure + remembered, max(relief, 0.0)
        stiff = stiffness(p.line_volume, max(pressure, 0.0), joint)
        if joint.accumulator.variant != accumulator.NONE:
            _, stiff = softened(accumulator.gas_capacity(pressure, joint), 0.0, stiff)
        slope = -stiff / p.relief_slope
        rate = stiff * (pumped(pressure, joint) - drawn)
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
