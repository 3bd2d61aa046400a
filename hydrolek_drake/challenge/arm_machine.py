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
from hydrolek_drake.challenge.driving import SAMPLE_S, Driving, Played, controlled, turned_back
from hydrolek_drake.challenge.faulty_signals import lost, worn
from hydrolek_drake.challenge.load_holding import let_out

UNPRESSED = 1e-9
"""A weight that would press a play together by less than this share of its gap is rounding: it takes up no side."""

STEP_S = 2e-5
"""Half of it changes the angle by 1.2e-4 deg at most, with a play by 1.6e-3 deg
(docs/evidence/concealed_effects.md)."""

SIZE = 14
"""x, x', P_A, P_B, q, q', flow felt by the supply, cylinder's side and its rate, tilt and its rate, flow felt by the
return line, currents of coils that take time."""


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
    return 1.0 / g.bulk + g.air * g.p_atm / max(p, g.p_atm) ** 2


@njit
def _snagging(g: Any, q: float) -> float:
    """Moment of hoses that have pulled tight."""
    return g.snag_nm_per_rad * max(q - g.z_lo - g.snag_at * (g.z_hi - g.z_lo), 0.0)


@njit
def _rates(g: Any, y: np.ndarray, volts: float, t: float, out: np.ndarray) -> None:
    """Rates of the state."""
    x, xd, p_a, p_b, q, qd, felt, cq, cqd, tilt, tiltd, returned, coil_a, coil_b = y
    warm_coil = 1.0 - g.fade * (1.0 - math.exp(-t / g.fade_s))
    thin = g.warm * (1.0 - math.exp(-t / g.warm_s))

    i_a, i_b = _current(g, g.i_max_a, volts, warm_coil), _current(g, g.i_max_b, -volts, warm_coil)
    out[12] = out[13] = 0.0
    if g.coil_s > 0.0:
        out[12] = (i_a - coil_a) / g.coil_s
        out[13] = (i_b - coil_b) / g.coil_s
        i_a, i_b = coil_a, coil_b
    push = _pull(g, g.k_f_a, i_a, x) - _pull(g, g.k_f_b, i_b, -x)
    to_a = g.area_max_a * _opened(x, g.x_o_a, g.w_a, g.shift_m) * (1.0 + thin)
    to_b = g.area_max_b * _opened(-x, g.x_o_b, g.w_b, -g.shift_m) * (1.0 + thin)
    p_s = max(g.p_s - g.droop * felt, g.p_t) + g.ripple_pa * math.sin(2.0 * math.pi * g.ripple_hz * t)
    p_t = g.p_t + g.return_pa_s * returned
    jet_a = to_a * (abs(p_s - p_a) + abs(p_b - p_t))  # each opens an edge from the pump and one to the tank
    jet_b = to_b * (abs(p_s - p_b) + abs(p_a - p_t))
    out[0] = xd
    held = g.c * xd + g.k * x + g.stiction_n * math.tanh(xd / g.stick_v) + g.flow_force * (jet_a - jet_b)
    out[1] = (push - held) / g.m
    from_pump_a = _orifice(g, to_a, p_s - p_a) + g.null_leak * (p_s - p_a)
    from_pump_b = _orifice(g, to_b, p_s - p_b) + g.null_leak * (p_s - p_b)
    back_a = _orifice(g, to_b, p_a - p_t) * let_out(g, p_a, p_b) + g.null_leak * (p_a - p_t)
    back_b = _orifice(g, to_a, p_b - p_t) + g.null_leak * (p_b - p_t)
    past = g.cross_leak * (p_a - p_b)
    out[6] = (from_pump_a + from_pump_b - felt) / g.flow_s
    out[11] = (back_a + back_b - returned) / g.flow_s

    playing = g.gap_rad > 0.0
    side, sided = (cq, cqd) if playing else (q, qd)
    s, lever, bend = _actuator(g, side - tilt)
    v = lever * (sided - tiltd)
    room_a = (g.v_a + g.a_a * max(s, 0.0)) * _softness(g, p_a) + g.hose * g.v_a / 1e6
    room_b = (g.v_b + g.a_b * max(g.stroke - s, 0.0)) * _softness(g, p_b)
    out[2] = max((from_pump_a - back_a - past - g.a_a * v) / room_a, -p_a / g.floor_s)
    out[3] = max((from_pump_b - back_b + past + g.a_b * v) / room_b, -p_b / g.floor_s)

    ratio = v / g.stribeck_v
    dry = g.coulomb_n + g.stribeck_n * math.exp(-ratio * ratio) + g.tight_n * (s / g.stroke) ** 2
    dry += g.rubbing_n * math.exp(-(((s / g.stroke - g.rubbing_at) / g.rubbing_wide) ** 2))
    rod = g.a_a * p_a - g.a_b * p_b - g.c_cyl * (1.0 - thin) * v - dry * math.tanh(v / g.slide_v)
    if g.cushion > 0.0 and s < g.cushion_m and v < 0.0:
        rod -= g.cushion * (1.0 - s / g.cushion_m) * v
    moment = rod * lever

    load = g.payload_kg if t >= g.payload_s else 0.0
    inertia = g.inertia + load * g.tool_r * g.tool_r + g.rod * lever * lever
    rest = g.shaking_nm * math.sin(2.0 * math.pi * g.shaking_hz * t) - g.c_j * qd
    rest -= g.weight_moment * math.cos(q + g.weight_phase) + load * g.tool_weight * math.cos(q + g.tool_phase)
    rest -= g.rod * lever * bend * qd * qd
    rest -= _snagging(g, q)
    if q > g.q_hi:
        rest -= g.k_stop * (q - g.q_hi) + g.c_stop * qd
    elif q < g.q_lo:
        rest -= g.k_stop * (q - g.q_lo) + g.c_stop * qd

    out[4] = qd
    through = moment
    out[7] = out[8] = 0.0
    if playing:
        lead, half = cq - q, 0.5 * g.gap_rad
        through = 0.0
        if abs(lead) > half:
            through = g.play_k * (lead - math.copysign(half, lead)) + g.play_c * (cqd - qd)
        out[7] = cqd
        out[8] = (moment - through) / g.play_j
    out[5] = (through + rest) / inertia
    out[9] = out[10] = 0.0
    if g.base_k > 0.0:
        damping = 2.0 * g.rocking * math.sqrt(g.base_k * g.base_j)
        out[9] = tiltd
        out[10] = (-moment - g.base_k * tilt - damping * tiltd) / g.base_j


@njit(cache=True, nogil=True)
def _play(
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
    """Run through all samples; `series` is the command, or the set points of a controller."""
    h = SAMPLE_S / inner
    k1, k2, k3, k4, mid = np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE)
    shaft = y[4] - y[9]
    lag = g.t_d + g.delay_s
    u = 0.0
    for n in range(len(out)):
        t = n * SAMPLE_S
        z = (2.0 * shaft - g.z_lo - g.z_hi) / (g.z_hi - g.z_lo)
        bowed = g.bow_rad * (1.0 - z * z) + worn(g, 0.5 * (z + 1.0))
        out[n, 0] = shaft + bowed + g.drift_rad_per_min * t / 60.0
        out[n, 1] = y[2]
        out[n, 2] = y[3]
        if closed:
            volts[n] = controlled(series[n] - out[n, 0] - noise[n], driving)
        elif n > 0 and series[n] == series[n - 1]:
            volts[n] = volts[n - 1]
        else:
            volts[n] = turned_back(series[n], out[n, 0], driving)
        for i in range(inner):
            now = t + i * h
            place = math.floor((now + 0.5 * h - lag) / SAMPLE_S)
            wanted = g.polarity * volts[int(place)] if place >= 0 and not lost(g, now - lag) else 0.0
            wanted = min(max(wanted, -g.limit), g.limit)
            u = min(max(wanted, u - g.ramp_v_per_s * h), u + g.ramp_v_per_s * h)
            _rates(g, y, u, now, k1)
            for j in range(SIZE):
                mid[j] = y[j] + 0.5 * h * k1[j]
            _rates(g, mid, u, now + 0.5 * h, k2)
            for j in range(SIZE):
                mid[j] = y[j] + 0.5 * h * k2[j]
            _rates(g, mid, u, now + 0.5 * h, k3)
            for j in range(SIZE):
                mid[j] = y[j] + h * k3[j]
            _rates(g, mid, u, now + h, k4)
            for j in range(SIZE):
                y[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])
            y[2] = max(y[2], 0.0)
            y[3] = max(y[3], 0.0)
            seen = y[4] - y[9]
            shaft = min(max(shaft, seen - g.play_rad), seen + g.play_rad)


def _at_rest(machine: ArmMachine, start: float) -> np.ndarray:
    """At rest in balance: side B at its stated pressure, side A carries the load, or B if that pulls the rod out."""
    g = machine
    load = g.payload_kg if g.payload_s <= 0.0 else 0.0
    moment = g.weight_moment * math.cos(start + g.weight_phase)
    moment += load * g.tool_weight * math.cos(start + g.tool_phase)
    moment += _snagging(g, start)
    tilt = -moment / g.base_k if g.base_k > 0.0 else 0.0  # the base leans against the load
    side = start
    if g.gap_rad > 0.0 and abs(moment) > UNPRESSED * g.play_k * g.gap_rad:
        side += g.play_up * (math.copysign(0.5 * g.gap_rad, moment) + moment / g.play_k)
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


def play(
    machine: ArmMachine,
    driving: Driving,
    command: np.ndarray | None,
    set_points: np.ndarray | None = None,
    noise: np.ndarray | None = None,
    step: float = STEP_S,
) -> Played:
    """Run a machine from rest where it is driven from, by a voltage or by a controller that follows set points.

    Args:
        machine: its numbers.
        driving: start and controller.
        command: voltage every 10 ms; None for a controller. # (n,)
        set_points: for the controller [rad]. # (n,)
        noise: what the controller's measurement adds [rad]. # (n,)
        step: of the Runge-Kutta method [s].
    """
    series = command if command is not None else set_points
    assert series is not None
    count = len(series)
    volts, out = np.zeros(count), np.zeros((count, 3))
    _play(
        machine,
        driving,
        command is None,
        np.asarray(series, dtype=float),
        np.zeros(count) if noise is None else noise,
        _at_rest(machine, math.radians(driving.start_deg)),
        volts,
        out,
        round(SAMPLE_S / step),
    )
    return Played(volts, out[:, 0], out[:, 1], out[:, 2])
