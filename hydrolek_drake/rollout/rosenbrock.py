"""A step of one joint's state: the two-stage Rosenbrock-W method with the stiff part of the Jacobian.

k_1 = f(y) + GAMMA h J k_1, k_2 = f(y + h k_1) - 2 k_1 + GAMMA h J k_2, y' = y + h (3 k_1 + k_2)/2 (Verwer and others,
see `physics.solenoid.GAMMA`): of second order whatever J is, and the more exact the more of the Jacobian it holds.
"""

from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import cavity, cylinder, hooks, rod_friction, supply
from hydrolek_drake.physics.lines.long_line import Fed
from hydrolek_drake.physics.probes import Probe
from hydrolek_drake.physics.solenoid import GAMMA
from hydrolek_drake.rollout.rates import Slopes, State, Turned, rates


@njit
def _lessening(part: float, slope: float) -> float:
    """By how much a stiff rate is lessened in a stage, GAMMA times a step long [s]; 1 for one that is not."""
    return 1.0 if slope == 0.0 else 1.0 / (1.0 - part * slope)


@njit
def implicit(f: State, slope: Slopes, h: float, joint: Any) -> State:
    """Rates `k` of a stage of a step of `h` seconds, (I - GAMMA h J) k = f; what the supply remembers is apart.

    J has the stiff diagonal, and how the oil in the chambers and what the actuator turns, with the base against them,
    swing against each other: chambers of a small volume and an actuator's side of a play do so at some 100 Hz. The
    force A_A k_A - A_B k_B of the pressures' rates follows from one equation, and all else from it.
    """
    playing = hooks.linkage_gap(joint) > 0.0
    part = GAMMA * h
    c_a, c_b, c_t = (
        _lessening(part, slope.p_a),
        _lessening(part, slope.p_b),
        _lessening(part, slope.tilt_rate),
    )
    damping, side, onwards = (slope.lead_w, f.lead_w, f.lead_q) if playing else (slope.w, f.w, f.q)
    if slope.sprung > 0.0:  # a stop's stiffness, by the position that the stage itself leads to
        damping -= part * slope.sprung
        side -= part * slope.sprung * onwards
    c_s = _lessening(part, damping)
    side *= c_s
    # behind a play the link, before none what its side would be
    c_o = _lessening(part, slope.w if playing else slope.lead_w)
    other = c_o * (f.w if playing else f.lead_w)
    tilt_rate = c_t * f.tilt_rate
    stiffness = _stiffness(part, slope, joint)
    yields = c_s * slope.turned_by + c_t * slope.tilted_by
    force = (pushed(f, slope, h, joint) - part * stiffness * side) / (1.0 + part * part * stiffness * yields)
    turned, tilted = part * c_s * slope.turned_by * force, part * c_t * slope.tilted_by * force
    tilt_rate -= tilted
    side += turned
    against = side - tilt_rate
    w, lead_w = (other, side) if playing else (side, other)
    return State(
        c_a * (f.p_a - part * slope.falls_a * against),
        c_b * (f.p_b + part * slope.rises_b * against),
        f.q + part * w,
        w,
        f.supply,
        f.tilt + part * tilt_rate,
        tilt_rate,
        f.lead_q + part * lead_w,
        lead_w,
        f.relief,
        0.0,
    )


@njit
def through_oil(slope: Slopes, h: float, inertia: float, joint: Any) -> tuple[float, float]:
    """What `implicit` has of the oil for a joint whose acceleration follows from all joints' moments.

    With M as the mass of all joints, (M + GAMMA h (D + d)) k_w = moment + share times `pushed`: d is what the chambers'
    stiffness makes of the step. Beside a play the link feels no oil within a step.

    Args:
        slope: at the beginning of the step.
        h: step [s].
        inertia: of what the actuator turns, with the other joints held.
        joint: parameter record.

    Returns:
        d [N m s/rad], and the share [m s/rad].
    """
    if hooks.linkage_gap(joint) > 0.0:
        return 0.0, 0.0
    part = GAMMA * h
    stiffness = _stiffness(part, slope, joint)
    leaning = part * part * stiffness * _lessening(part, slope.tilt_rate) * slope.tilted_by
    share = part * slope.turned_by * inertia / (1.0 + leaning)
    return share * stiffness, share


@njit
def pushed(f: State, slope: Slopes, h: float, joint: Any) -> float:
    """Rate of the pistons' force that a stage's rates `f` make while the joint is held [N/s], see `through_oil`."""
    part = GAMMA * h
    area_a, area_b = _areas(joint)
    tilt_rate = _lessening(part, slope.tilt_rate) * f.tilt_rate
    force_a = area_a * _lessening(part, slope.p_a) * f.p_a
    force_b = area_b * _lessening(part, slope.p_b) * f.p_b
    return force_a - force_b + part * _stiffness(part, slope, joint) * tilt_rate


@njit
def _stiffness(part: float, slope: Slopes, joint: Any) -> float:
    """By how much an angle that the actuator turns lessens its force within a stage [N/rad]."""
    area_a, area_b = _areas(joint)
    stiffness_a = area_a * _lessening(part, slope.p_a) * slope.falls_a
    return stiffness_a + area_b * _lessening(part, slope.p_b) * slope.rises_b


@njit
def _areas(joint: Any) -> tuple[float, float]:
    """Areas on which the oil acts; none of an electric motor."""
    c = joint.cylinder
    return (0.0, 0.0) if cylinder.is_electric(joint) else (c.area_a, c.area_b)


@njit
def _remembered(
    s: State, rate: float, relief_rate: float, slope: float, h: float, joint: Any
) -> tuple[float, float]:
    """What the supply remembers after `h` seconds of held rates, with its relief valve; or a drive's integrals."""
    if cylinder.follows_position(joint):
        return s.supply + h * rate, s.relief + h * relief_rate
    return supply.advanced(s.supply, s.relief, rate, slope, h, joint)


@njit
def _turned_by_rod(k: State, joint: Any) -> float:
    """Rate at which the rod turns the joint against the base [rad/s], of the rates of a stage."""
    return (k.lead_q if hooks.linkage_gap(joint) > 0.0 else k.q) - k.tilt


@njit
def first_stage(s: State, k: State, slope: Slopes, h: float, joint: Any) -> State:
    """State after a step of `h` seconds with the rates `k` of its first stage, `implicit`."""
    remembered, relief = _remembered(s, k.supply, k.relief, slope.supply, h, joint)
    return State(
        s.p_a + h * k.p_a,
        s.p_b + h * k.p_b,
        s.q + h * k.q,
        s.w + h * k.w,
        remembered,
        s.tilt + h * k.tilt,
        s.tilt_rate + h * k.tilt_rate,
        s.lead_q + h * k.lead_q,
        s.lead_w + h * k.lead_w,
        relief,
        rod_friction.bent_on(s.bent, h * slope.lever * _turned_by_rod(k, joint), h, joint),
    )


@njit
def changed(m: State, k: State) -> State:
    """What the second stage begins with, f(y + h k) - 2 k, from rates `m` there and the first stage's `k`."""
    return State(
        m.p_a - 2.0 * k.p_a,
        m.p_b - 2.0 * k.p_b,
        m.q - 2.0 * k.q,
        m.w - 2.0 * k.w,
        m.supply,
        m.tilt - 2.0 * k.tilt,
        m.tilt_rate - 2.0 * k.tilt_rate,
        m.lead_q - 2.0 * k.lead_q,
        m.lead_w - 2.0 * k.lead_w,
        m.relief,
        0.0,
    )


@njit
def second_stage(s: State, k: State, m: State, slope: Slopes, h: float, joint: Any) -> State:
    """State after a step of `h` seconds: rates `k` of its first stage, `m` those where this ended."""
    n = implicit(changed(m, k), slope, h, joint)
    mean, mean_relief = 0.5 * (k.supply + m.supply), 0.5 * (k.relief + m.relief)
    remembered, relief = _remembered(s, mean, mean_relief, slope.supply, h, joint)
    half = 0.5 * h
    turning = 3.0 * _turned_by_rod(k, joint) + _turned_by_rod(n, joint)
    return State(
        cavity.after_step(s.p_a, s.p_a + half * (3.0 * k.p_a + n.p_a), joint),
        cavity.after_step(s.p_b, s.p_b + half * (3.0 * k.p_b + n.p_b), joint),
        s.q + half * (3.0 * k.q + n.q),
        s.w + half * (3.0 * k.w + n.w),
        remembered,
        s.tilt + half * (3.0 * k.tilt + n.tilt),
        s.tilt_rate + half * (3.0 * k.tilt_rate + n.tilt_rate),
        s.lead_q + half * (3.0 * k.lead_q + n.lead_q),
        s.lead_w + half * (3.0 * k.lead_w + n.lead_w),
        relief,
        rod_friction.bent_on(s.bent, half * slope.lever * turning, h, joint),
    )


@njit
def one_step(
    s: State,
    x: float,
    x_next: float,
    voltage: float,
    time: float,
    h: float,
    inertia: float,
    probe: Probe,
    probe_next: Probe,
    law: np.ndarray | None,
    near: Turned,
    fed: Fed | None,
    joint: Any,
) -> State:
    """One Rosenbrock-W step of `h` seconds; the spool goes from `x` to `x_next` meanwhile, and lines may feed."""
    k, slope, _, _, _ = rates(s, x, voltage, time, inertia, probe, law, near, h, None, fed, joint)
    k = implicit(k, slope, h, joint)
    middle = first_stage(s, k, slope, h, joint)
    m, _, _, _, _ = rates(
        middle, x_next, voltage, time + h, inertia, probe_next, law, near, h, slope.contact, fed, joint
    )
    return second_stage(s, k, m, slope, h, joint)
