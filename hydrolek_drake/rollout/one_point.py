"""Equations of the stages at one point, for callers in Python.

A call of an equation alone compiles it anew in every run; these are compiled once and kept.
"""

from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import cylinder, linkage, load, valve
from hydrolek_drake.physics.law import Seen, law_value
from hydrolek_drake.physics.linkages import ball_screw
from hydrolek_drake.physics.valves.openings import Openings
from hydrolek_drake.physics.valves.variants import PUMP_CONTROLLED


@njit(cache=True)
def inlet_conductance(p_supply: float, p_a: float, p_b: float, joint: Any) -> float:
    """Conductance of the inlet edge of side A of a valve that is wide open [m^3/(s Pa)]."""
    inlet, _, _, _ = valve.edge_conductances(Openings(1.0, 0.0, 0.0, 1.0), p_supply, p_a, p_b, 0.0, joint)
    return inlet


@njit(cache=True)
def full_flow(p_supply: float, drop: float, joint: Any) -> float:
    """Flow into side A of a valve that is wide open, at a pressure drop; of a pump all it gives [m^3/s]."""
    if joint.valve.variant == PUMP_CONTROLLED:
        return joint.valve.full_flow
    return inlet_conductance(p_supply, p_supply - drop, p_supply - drop, joint) * drop


@njit(cache=True)
def drive_force(command: float, joint: Any) -> float:
    """Force of an electric drive [N] at a command [V]; the largest of one that follows a position."""
    if cylinder.follows_position(joint):
        return ball_screw.nut_force(joint.cylinder.current_limit, joint)
    return cylinder.motor_force(command, joint)


@njit(cache=True)
def driven_inertia(joint: Any) -> float:
    """Inertia of a joint's load with what its drive adds [kg m^2 or kg]."""
    return load.own_inertia(joint) + load.reflected_rod_inertia(joint)


@njit(cache=True)
def stroke_and_lever(angle: float, joint: Any) -> tuple[float, float]:
    """Stroke [m] and lever [m] of a joint's linkage at an angle [rad]; see `linkage.stroke_and_lever`."""
    return linkage.stroke_and_lever(angle, joint)


@njit(cache=True)
def own_inertia(joint: Any) -> float:
    """Inertia of a joint's load [kg m^2 or kg]; see `load.own_inertia`."""
    return load.own_inertia(joint)


@njit(cache=True)
def gravity_moments(joint: Any) -> tuple[float, float]:
    """Gravity's moment on a joint's load at 0 and at 90 deg [N m]; see `load.gravity_moments`."""
    return load.gravity_moments(joint)


@njit(cache=True)
def law_along(law: Any, seen: np.ndarray) -> np.ndarray:
    """A term of a law (a record of `physics.law.LAW`) at many moments, `Seen` as rows. # (n, 8) -> (n,)."""
    values = np.empty(len(seen))
    for i in range(len(seen)):
        t, q, w, stroke, v, p_a, p_b, x = seen[i]
        values[i] = law_value(law, Seen(t, q, w, stroke, v, p_a, p_b, x))
    return values
