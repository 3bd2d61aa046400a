"""Where a rollout begins: at rest, in balance.

All of it is compiled: a fit of many joints asks for thousands of such states, and every call of a compiled function
from Python costs as much as the equations in it.
"""

import math
from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import amplifier, cylinder, hooks, linkage, load, sensor, supply
from hydrolek_drake.physics.lines import hose
from hydrolek_drake.physics.lines.long_line import LINES_SIZE, put_lines, resting_lines
from hydrolek_drake.physics.linkages import servo_screw
from hydrolek_drake.physics.valves.variants import PUMP_CONTROLLED
from hydrolek_drake.rollout.rates import State

STATE_SIZE = 2 + len(State._fields) + 3 + len(amplifier.Currents._fields)
"""Numbers of a joint's state; what moves in long lines comes behind them."""


def state_size(joint: np.ndarray) -> int:
    """Numbers of the state of a joint, whose record has the shape (1,), with its long lines if it has any."""
    return STATE_SIZE + (LINES_SIZE if joint["hose"]["variant"][0] == hose.LONG_LINE else 0)


START_STEPS = 8
"""Steps of the search for a start: its error falls by the share that lean and bow change with position, at most a
tenth, in each."""

UNPRESSED = 1e-3
"""A play that the load presses together by less than this share of its gap is not taken up: friction of its pins holds
as much, and a joint that was measured in balance is so only to within the noise, which tells no side. It starts centred
then, at most half of its gap off."""


def rest_state(
    joint: np.ndarray, position: float | None = None, time: float = 0.0, carried: float | None = None
) -> np.ndarray:
    """State at rest in balance (bench.md 6): side B at its given pressure, side A carries the load.

    Args:
        joint: parameter record, shape (1,).
        position: joint position [rad or m]; None for the rig's own.
        time: since switching on [s], for loads that are picked up later and for what warms up.
        carried: gravity's moment on it [N m]; None for what it is with the other joints held.

    Raises:
        ZeroDivisionError: a lever, an area or a play's stiffness is zero.
    """
    state = np.zeros(state_size(joint))
    q = float(joint[0]["load"]["initial_position"]) if position is None else float(position)
    _rest(joint, q, float(time), carried is None, 0.0 if carried is None else float(carried), state)
    return state


def rest_state_at_reading(joint: np.ndarray, reading: float) -> np.ndarray:
    """State at rest in which the sensor reads a value [rad or m]: a leaning base or a bowed sensor is allowed for.

    Args:
        joint: parameter record, shape (1,).
        reading: what was measured [rad or m].

    Raises:
        ZeroDivisionError: as of `rest_state`.
    """
    state = np.zeros(state_size(joint))
    _rest_at_reading(joint, float(reading), state)
    return state


@njit(cache=True)
def _rest_at_reading(joints: np.ndarray, reading: float, state: np.ndarray) -> None:
    position = reading
    for _ in range(START_STEPS):
        _rest(joints, position, 0.0, True, 0.0, state)
        off = reading - sensor.reading(state[11], 0.0, joints[0])
        if off == 0.0:
            break
        position += off


@njit(cache=True)
def _rest(
    joints: np.ndarray, q: float, time: float, by_itself: bool, carried: float, state: np.ndarray
) -> None:
    joint = joints[0]
    state[:] = 0.0
    state[4] = state[11] = q
    state[6], state[16] = supply.at_start(joint)
    state[12] = time
    state[14], state[15] = amplifier.coil_currents(0.0, time, joint)
    if by_itself:
        carried = load.gravity_load(q, time, joint)
    needed = carried - load.stop_load(q, 0.0, joint)
    if cylinder.is_electric(joint):
        state[9] = q
        if cylinder.follows_position(joint):
            state[6], state[16] = servo_screw.at_rest(joint.linkage.direction * needed, joint)
        return
    tilt, lead = rest_tilt_and_lead(joint, q, needed)
    state[2], state[3] = rest_pressures(joint, lead - tilt, needed)
    state[7], state[9] = tilt, lead
    state[11] = q - tilt
    if len(state) > STATE_SIZE:
        put_lines(state[STATE_SIZE:], resting_lines(state[2], state[3]))


@njit
def _quotient(value: float, divisor: float) -> float:
    """A quotient; there is no balance where something is divided by zero, which is told as Python does."""
    if divisor == 0.0:
        raise ZeroDivisionError("rest: division by zero")
    return value / divisor


@njit(cache=True)
def rest_tilt_and_lead(joint: Any, position: float, needed: float) -> tuple[float, float]:
    """Tilt of the base and position of the actuator's side [rad] under a held moment `needed` [N m]."""
    stiffness = hooks.base_stiffness(joint)
    tilt = -needed / stiffness if stiffness > 0.0 else 0.0
    lead = position
    gap = hooks.linkage_gap(joint)
    if gap > 0.0:
        pressed = _quotient(needed, joint.linkage.play_stiffness)
        if abs(pressed) > UNPRESSED * gap:
            lead = position + joint.linkage.play_taken_up * (math.copysign(0.5 * gap, needed) + pressed)
    return tilt, lead


@njit(cache=True)
def rest_pressures(joint: Any, side: float, needed: float) -> tuple[float, float]:
    """Chamber pressures that hold a moment `needed` [N m] with the actuator's side at `side` [rad or m]."""
    p = joint.cylinder
    _, lever = linkage.stroke_and_lever(side, joint)
    p_b = p.initial_pressure_b
    if joint.valve.variant == PUMP_CONTROLLED:  # the charge line holds the lower side
        p_b = joint.valve.charge_pressure
    p_a = _quotient(_quotient(needed, lever) + p.area_b * p_b, p.area_a)
    if p_a < 0.0:  # the load pulls the rod out: side B carries it
        p_a = joint.supply.tank_pressure
        p_b = _quotient(p.area_a * p_a - needed / lever, p.area_b)
    return p_a, p_b


def state_at_reading(joint: np.ndarray, state: np.ndarray, reading: float) -> np.ndarray:
    """A state, such as an observer's, moved to where the sensor reads a value [rad or m]; all else stays as it is.

    Args:
        joint: parameter record, shape (1,).
        state: as of `kernel.integrate`, shape (18,).
        reading: what was measured [rad or m].
    """
    there = state.copy()
    _move_to_reading(joint, float(reading), there)
    return there


@njit(cache=True)
def _move_to_reading(joints: np.ndarray, reading: float, state: np.ndarray) -> None:
    for _ in range(START_STEPS):
        off = reading - sensor.reading(state[11], state[12], joints[0])
        if off == 0.0:
            break
        state[4] += off
        state[9] += off
        state[11] += off
