"""The joint bench once more, written from its page alone: the machine that conceals an effect.

It takes numbers from the rig and shares no equation, integrator or step with the rollout that diagnoses it:
classic Runge-Kutta of fourth order at 0.02 ms. It also has physics that is in no list.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from hydrolek_drake.challenge.bench_numbers import Machine
from hydrolek_drake.challenge.driving import SAMPLE_S, Driving, Played, controlled
from hydrolek_drake.challenge.faulty_signals import lost, worn
from hydrolek_drake.challenge.load_holding import let_out

STEP_S = 2e-5
SIZE = 14
"""x, x', P_A, P_B, q, q', flow felt by the supply, cylinder side and its rate, tilt and its rate, flow felt by the
return line, currents of coils that take time."""

REACHED_M = 0.15
"""About the longest stroke that the bench reaches: friction that grows with the stroke has its given size there."""


@njit
def _flow(g: Any, opening: float, drop: float, gain: float) -> float:
    return g.c_q * gain * opening * math.sqrt(2.0 / g.rho) * drop / (drop * drop + g.dp_t * g.dp_t) ** 0.25


@njit
def _cylinder(g: Any, q: float) -> tuple[float, float]:
    length = math.sqrt(g.a * g.a + g.b * g.b - 2.0 * g.a * g.b * math.cos(q + g.phi))
    low = math.sqrt(g.a * g.a + g.b * g.b - 2.0 * g.a * g.b * math.cos(g.q_lo + g.phi))
    return length - low, g.a * g.b * math.sin(q + g.phi) / length


@njit
def _snagging(g: Any, q: float) -> float:
    """Moment of hoses that have pulled tight."""
    return g.snag_nm_per_rad * max(q - g.q_lo - g.snag_at * (g.q_hi - g.q_lo), 0.0)


@njit
def _derivative(g: Any, y: np.ndarray, volts: float, t: float, out: np.ndarray) -> None:
    """Rates of the state."""
    x, xd, p_a, p_b, q, qd, felt, cq, cqd, tilt, tiltd, returned, coil_a, coil_b = y
    current = g.i_max * (1.0 - g.fade * (1.0 - math.exp(-t / g.fade_s)))
    i_a = current * min(max(volts, 0.0), 10.0) / 10.0
    i_b = current * min(max(-volts, 0.0), 10.0) / 10.0
    out[12] = out[13] = 0.0
    if g.coil_s > 0.0:
        out[12] = (i_a - coil_a) / g.coil_s
        out[13] = (i_b - coil_b) / g.coil_s
        i_a, i_b = coil_a, coil_b
    force = (
        g.k_f * i_a**2 / (1.0 + g.gap * max(x, 0.0)) ** 2 - g.k_f * i_b**2 / (1.0 + g.gap * max(-x, 0.0)) ** 2
    )
    right = g.area * min(max((x - g.x_o - g.shift_m) / (g.w - g.x_o), 0.0), 1.0)
    left = g.area * min(max((-x - g.x_o + g.shift_m) / (g.w - g.x_o), 0.0), 1.0)
    s_warm = g.warm * (1.0 - math.exp(-t / g.warm_s))
    p_s = g.p_s - g.droop * felt + g.ripple_pa * math.sin(2.0 * math.pi * g.ripple_hz * t)
    p_t = g.p_t + g.return_pa_s * returned
    force -= g.flow_force * (
        right * (abs(p_s - p_a) + abs(p_b - p_t)) - left * (abs(p_s - p_b) + abs(p_a - p_t))
    )
    out[0] = xd
    out[1] = (force - g.c * xd - g.k * x - g.stiction_n * math.tanh(xd / g.stick_v)) / g.m
    pa = _flow(g, right, p_s - p_a, 1.0 + s_warm) + g.null_leak * (p_s - p_a)
    at = _flow(g, left, p_a - p_t, 1.0 + s_warm) * let_out(g, p_a, p_b) + g.null_leak * (p_a - p_t)
    pb = _flow(g, left, p_s - p_b, 1.0 + s_warm) + g.null_leak * (p_s - p_b)
    bt = _flow(g, right, p_b - p_t, 1.0 + s_warm) + g.null_leak * (p_b - p_t)
    out[6] = (pa + pb - felt) / 0.02
    out[11] = (at + bt - returned) / 0.02
    playing = g.gap_rad > 0.0
    side, sided = (cq, cqd) if playing else (q, qd)
    if g.base_k > 0.0:
        side -= tilt
        sided -= tiltd
    s, lever = _cylinder(g, side)
    v = lever * sided
    across = g.cross_leak * (p_a - p_b)
    soft_a = 1.0 / g.bulk + g.air * 1e5 / max(p_a, 1e5) ** 2
    soft_b = 1.0 / g.bulk + g.air * 1e5 / max(p_b, 1e5) ** 2
    vol_a = g.v_0 + g.a_a * max(s, 0.0)
    vol_b = g.v_0 + g.a_b * max(g.stroke - s, 0.0)
    hose = g.hose * g.v_0 / 1e6
    out[2] = (pa - at - across - g.a_a * v) / (vol_a * soft_a + hose)
    out[3] = (pb - bt + across + g.a_b * v) / (vol_b * soft_b)
    if p_a <= 0.0 and out[2] < 0.0:
        out[2] = 0.0
    if p_b <= 0.0 and out[3] < 0.0:
        out[3] = 0.0
    ratio = v / g.stribeck_v
    dry = (g.coulomb_n + g.stribeck_n * math.exp(-ratio * ratio)) * math.tanh(v / g.v_dry)
    scored = g.rubbing_n * math.exp(-(((s / REACHED_M - g.rubbing_at) / g.rubbing_wide) ** 2))
    dry += (g.tight_n * (s / REACHED_M) ** 2 + scored) * math.tanh(v / g.v_dry)
    rod = g.a_a * p_a - g.a_b * p_b - g.c_cyl * (1.0 - s_warm) * v - dry
    if g.cushion > 0.0 and s < g.cushion_m and v < 0.0:
        rod -= g.cushion * v * (1.0 - s / g.cushion_m)
    moment = rod * lever
    stop = 0.0
    if q > g.q_hi:
        stop = -g.k_stop * (q - g.q_hi) - g.c_stop * qd
    elif q < g.q_lo:
        stop = -g.k_stop * (q - g.q_lo) - g.c_stop * qd
    rest = stop - g.mgl * math.cos(q) - g.c_j * qd
    rest += g.shaking_nm * math.sin(2.0 * math.pi * g.shaking_hz * t)
    rest -= _snagging(g, q)
    out[4] = qd
    if playing:
        lead, closing = cq - q, cqd - qd
        half = 0.5 * g.gap_rad
        through = 0.0
        if lead > half:
            through = g.k_play * (lead - half) + g.c_play * closing
        elif lead < -half:
            through = g.k_play * (lead + half) + g.c_play * closing
        out[5] = (through + rest) / g.inertia
        out[7] = cqd
        out[8] = (moment - through) / g.j_play
    else:
        out[5] = (moment + rest) / g.inertia
        out[7] = 0.0
        out[8] = 0.0
    out[9] = tiltd
    out[10] = 0.0
    if g.base_k > 0.0:
        damping = 0.1 * math.sqrt(g.base_k * g.base_j)
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
    k1, k2, k3, k4 = np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE)
    shaft = y[4] - y[9]
    u = 0.0
    lag = g.t_d + g.delay_s
    for n in range(len(out)):
        t = n * SAMPLE_S
        z = 2.0 * (shaft - g.q_lo) / (g.q_hi - g.q_lo) - 1.0
        bowed = g.bow_rad * (1.0 - z * z) + worn(g, 0.5 * (z + 1.0))
        out[n, 0] = shaft + bowed + g.drift_rad_per_min * t / 60.0
        out[n, 1] = y[2]
        out[n, 2] = y[3]
        volts[n] = controlled(series[n] - out[n, 0] - noise[n], driving) if closed else series[n]
        for i in range(inner):
            now = t + i * h
            place = math.floor((now + 0.5 * h - lag) / SAMPLE_S)
            wanted = volts[int(place)] if place >= 0 and not lost(g, now - lag) else 0.0
            u = min(max(wanted, u - g.ramp_v_per_s * h), u + g.ramp_v_per_s * h)
            _derivative(g, y, u, now, k1)
            _derivative(g, y + 0.5 * h * k1, u, now + 0.5 * h, k2)
            _derivative(g, y + 0.5 * h * k2, u, now + 0.5 * h, k3)
            _derivative(g, y + h * k3, u, now + h, k4)
            for j in range(SIZE):
                y[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])
            y[2] = max(y[2], 0.0)
            y[3] = max(y[3], 0.0)
            seen = y[4] - y[9]
            shaft = min(max(shaft, seen - g.play_rad), seen + g.play_rad)


def play(
    machine: Machine,
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
    start = math.radians(driving.start_deg)
    y = np.zeros(SIZE)
    _, lever = _cylinder(machine, start)
    moment = machine.mgl * math.cos(start) + _snagging(machine, start)
    y[3] = machine.p_b_0
    y[4] = y[7] = start
    if machine.base_k > 0.0:  # at rest the base leans against the load
        y[9] = -moment / machine.base_k
        _, lever = _cylinder(machine, start - y[9])
    if machine.gap_rad > 0.0:
        y[7] = start  # the play is centred, as on the bench's page
    y[2] = (moment / lever + machine.a_b * y[3]) / machine.a_a
    volts, out = np.zeros(count), np.zeros((count, 3))
    _play(
        machine,
        driving,
        command is None,
        np.asarray(series, dtype=float),
        np.zeros(count) if noise is None else noise,
        y,
        volts,
        out,
        round(SAMPLE_S / step),
    )
    return Played(volts, out[:, 0], out[:, 1], out[:, 2])
