"""A ball screw that an electric motor turns."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.parameters import Parameter

PARAMETERS = (
    Parameter("current_gain", "A/V", "current of the motor over command; 1 where the command is the current"),
    Parameter("current_limit", "A", "largest current of the drive; 0 for any", neutral=0.0, lowest=0.0),
    Parameter("torque_constant", "N m/A", "torque over current", lowest=0.0),
    Parameter("lead", "m", "way of the nut for each turn of the screw", lowest=0.0, positive=True),
    Parameter(
        "efficiency", "1", "share of the torque that reaches the nut", neutral=1.0, lowest=0.0, highest=1.0
    ),
    Parameter("rotor_inertia", "kg m^2", "of rotor, coupling and screw", neutral=0.0, lowest=0.0),
)


@njit
def commanded_current(command: float, joint: Any) -> float:
    """Current of the motor [A] at a command of its drive [V]."""
    p = joint.cylinder
    current = p.current_gain * command
    if p.current_limit > 0.0:
        current = min(max(current, -p.current_limit), p.current_limit)
    return current


@njit
def screw_force(command: float, joint: Any) -> float:
    """Force on the nut [N] at a command of the drive [V]."""
    return nut_force(commanded_current(command, joint), joint)


@njit
def nut_force(current: float, joint: Any) -> float:
    """Force on the nut [N]: 2 pi/lead times torque constant, efficiency and current [A] (ISO 3408-5)."""
    p = joint.cylinder
    return 2.0 * math.pi / p.lead * p.efficiency * p.torque_constant * current


@njit
def screw_mass(joint: Any) -> float:
    """Mass that the turning parts add to the nut's [kg]: their inertia times the square of 2 pi/lead."""
    p = joint.cylinder
    turn = 2.0 * math.pi / p.lead
    return p.rotor_inertia * turn * turn
