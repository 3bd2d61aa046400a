"""One joint of a HydroLek arm once more, written from the thesis: the machine that conceals an effect.

Equations (4.2) to (4.9) with numbers from the rig and masses from the URDF, in another form than the rollout that
diagnoses it: cylinder mounts as points in the plane, the rod's mass by its kinetic energy at every angle, gravity
by the centre of mass; spool, oil and link in one classic Runge-Kutta method of fourth order at 0.02 ms. It also has
physics that is in no list.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from hydrolek_drake.challenge.arm_numbers import ArmMachine
from hydrolek_drake.challenge.machine_parts import coil, let_out, snagging, through_play
from hydrolek_drake.challenge.running import SIZE, Player, run

UNPRESSED = 1e-9
"""A weight that would press a play together by less than this share of its gap is rounding: it takes up no side."""


@njit
def _current(g: Any, i_max: float, volts: float, warm: float) -> float:
    """Current that one solenoid is driven with, (4.4)."""
    return warm * (g.i_min + min(max(volts, 0.0), g.full_voltage) / g.full_voltage * (i_max - g.i_min))


@njit
def _pull(g: Any, k_f: float, current: float, plunger: float) -> float:
    """Force of one solenoid towards its side, (4.5)."""
    return k_f * (current / (1.0 + g.gap * max(plunger, 0.0))) ** 2


@njit
def _orifice(g: Any, area: float, drop: float) -> float:
    """Flow through an edge (4.7), turning laminar below dp_t."""
    return g.c_q * area * math.sqrt(2.0 / g.rho) * drop / math.sqrt(math.hypot(drop, g.dp_t))


@njit
def _opened(travel: float, overlap: float, full: float, shift: float) -> float:
    return min(max((travel - overlap - shift) / (full - overlap), 0.0), 1.0)


@njit
def _actuator(g: Any, side: float) -> tuple[float, float, float]:
    """Stroke, its derivative over the angle, and that one's; from the mounts' places in the plane."""
    if g.rotary > 0.0:
        return g.direction * (side - g.retracted), g.direction, 0.0
    turned = g.direction * side + g.offset
    x, y = g.mount_c * math.cos(turned), g.mount_c * math.sin(turned)
    dx, dy = x - g.mount_p, y
    length = math.hypot(dx, dy)
    arm = (x * dy - y * dx) / length  # cross product of the moving mount and the rod's direction
    bend = (g.mount_c * g.mount_c - arm * arm - (x * dx + y * dy)) / length
    return length - g.retracted, g.direction * arm, bend


@njit
def _softness(g: Any, p: float) -> float:
    return 1.0 / g.bulk + g.concealed.air * g.p_atm / max(p, g.p_atm) ** 2


@njit
def _rates(g: Any, y: np.ndarray, volts: float, t: float, out: np.ndarray) -> None:
    """Rates of the state."""
    e = g.concealed
    x, xd, p_a, p_b, q, qd, felt, cq, cqd, tilt, tiltd, returned, coil_a, coil_b = y
    warm_coil = 1.0 - e.fade * (1.0 - math.exp(-t / e.fade_s))
    thin = e.warm * (1.0 - math.exp(-t / e.warm_s))

    i_a, i_b = _current(g, g.i_max_a, volts, warm_coil), _current(g, g.i_max_b, -volts, warm_coil)
    i_a, out[12] = coil(e, i_a, coil_a)
    i_b, out[13] = coil(e, i_b, coil_b)
    push = _pull(g, g.k_f_a, i_a, x) - _pull(g, g.k_f_b, i_b, -x)
    to_a = g.area_max_a * _opened(x, g.x_o_a, g.w_a, e.shift_m) * (1.0 + thin)
    to_b = g.area_max_b * _opened(-x, g.x_o_b, g.w_b, -e.shift_m) * (1.0 + thin)
    p_s = max(g.p_s - e.droop * felt, g.p_t) + e.ripple_pa * math.sin(2.0 * math.pi * e.ripple_hz * t)
    p_t = g.p_t + e.return_pa_s * returned
    jet_a = to_a * (abs(p_s - p_a) + abs(p_b - p_t))  # each opens an edge from the pump and one to the tank
    jet_b = to_b * (abs(p_s - p_b) + abs(p_a - p_t))
    out[0] = xd
    held = g.c * xd + g.k * x + e.stiction_n * math.tanh(xd / g.stick_v) + e.flow_force * (jet_a - jet_b)
    out[1] = (push - held) / g.m
    from_pump_a = _orifice(g, to_a, p_s - p_a) + e.null_leak * (p_s - p_a)
    from_pump_b = _orifice(g, to_b, p_s - p_b) + e.null_leak * (p_s - p_b)
    back_a = _orifice(g, to_b, p_a - p_t) * let_out(e, p_a, p_b) + e.null_leak * (p_a - p_t)
    back_b = _orifice(g, to_a, p_b - p_t) + e.null_leak * (p_b - p_t)
    past = e.cross_leak * (p_a - p_b)
    out[6] = (from_pump_a + from_pump_b - felt) / g.flow_s
    out[11] = (back_a + back_b - returned) / g.flow_s

    playing = e.gap_rad > 0.0
    side, sided = (cq, cqd) if playing else (q, qd)
    s, lever, bend = _actuator(g, side - tilt)
    v = lever * (sided - tiltd)
    room_a = (g.v_a + g.a_a * max(s, 0.0)) * _softness(g, p_a) + e.hose * g.v_a / 1e6
    room_b = (g.v_b + g.a_b * max(g.stroke - s, 0.0)) * _softness(g, p_b)
    out[2] = max((from_pump_a - back_a - past - g.a_a * v) / room_a, -p_a / g.floor_s)
    out[3] = max((from_pump_b - back_b + past + g.a_b * v) / room_b, -p_b / g.floor_s)

    ratio = v / e.stribeck_v
    dry = e.coulomb_n + e.stribeck_n * math.exp(-ratio * ratio) + e.tight_n * (s / g.stroke) ** 2
    dry += e.rubbing_n * math.exp(-(((s / g.stroke - e.rubbing_at) / e.rubbing_wide) ** 2))
    rod = g.a_a * p_a - g.a_b * p_b - g.c_cyl * (1.0 - thin) * v - dry * math.tanh(v / g.slide_v)
    if e.cushion > 0.0 and s < e.cushion_m and v < 0.0:
        rod -= e.cushion * (1.0 - s / e.cushion_m) * v
    moment = rod * lever

    load = e.payload_kg if t >= e.payload_s else 0.0
    inertia = g.inertia + load * g.tool_r * g.tool_r + g.rod * lever * lever
    rest = e.shaking_nm * math.sin(2.0 * math.pi * e.shaking_hz * t) - g.c_j * qd
    rest -= g.weight_moment * math.cos(q + g.weight_phase) + load * g.tool_weight * math.cos(q + g.tool_phase)
    rest -= g.rod * lever * bend * qd * qd
    rest -= snagging(e, q, g.z_lo, g.z_hi)
    if q > g.q_hi:
        rest -= g.k_stop * (q - g.q_hi) + g.c_stop * qd
    elif q < g.q_lo:
        rest -= g.k_stop * (q - g.q_lo) + g.c_stop * qd

    out[4] = qd
    through = moment
    out[7] = out[8] = 0.0
    if playing:
        through = through_play(e.gap_rad, g.play_k, g.play_c, cq - q, cqd - qd)
        out[7] = cqd
        out[8] = (moment - through) / g.play_j
    out[5] = (through + rest) / inertia
    out[9] = out[10] = 0.0
    if e.base_k > 0.0:
        damping = 2.0 * g.rocking * math.sqrt(e.base_k * e.base_j)
        out[9] = tiltd
        out[10] = (-moment - e.base_k * tilt - damping * tiltd) / e.base_j


@njit
def _travelled(g: Any, angle: float) -> float:
    """Place in the sensor's travel, from -1 to 1."""
    return (2.0 * angle - g.z_lo - g.z_hi) / (g.z_hi - g.z_lo)


@njit(cache=True, nogil=True)
def _run(
    g: Any,
    driving: Any,
    closed: bool,
    series: np.ndarray,
    noise: np.ndarray,
    y: np.ndarray,
    volts: np.ndarray,
    out: np.ndarray,
    inner: int,
) -> None:
    """See `run`."""
    run(_rates, _travelled, g, driving, closed, series, noise, y, volts, out, inner)


def _at_rest(machine: ArmMachine, start: float) -> np.ndarray:
    """At rest in balance: side B at its stated pressure, side A carries the load, or B if that pulls the rod out."""
    g, e = machine, machine.concealed
    load = e.payload_kg if e.payload_s <= 0.0 else 0.0
    moment = g.weight_moment * math.cos(start + g.weight_phase)
    moment += load * g.tool_weight * math.cos(start + g.tool_phase)
    moment += snagging(e, start, g.z_lo, g.z_hi)
    tilt = -moment / e.base_k if e.base_k > 0.0 else 0.0  # the base leans against the load
    side = start
    if e.gap_rad > 0.0 and abs(moment) > UNPRESSED * g.play_k * e.gap_rad:
        side += g.play_up * (math.copysign(0.5 * e.gap_rad, moment) + moment / g.play_k)
    _, lever, _ = _actuator(g, side - tilt)
    p_b = g.start_p_b
    p_a = (moment / lever + g.a_b * p_b) / g.a_a
    if p_a < 0.0:
        p_a = g.p_t
        p_b = (g.a_a * p_a - moment / lever) / g.a_b
    y = np.zeros(SIZE)
    y[2], y[3], y[4], y[7], y[9] = p_a, p_b, start, side, tilt
    y[12] = y[13] = g.i_min
    return y


play = Player(_run, _at_rest, turns_back=True)
