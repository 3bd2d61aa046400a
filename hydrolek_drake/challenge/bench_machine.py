"""The joint bench once more, written from its page alone: the machine that conceals an effect.

It takes numbers from the rig and shares no equation, integrator or step with the rollout that diagnoses it:
classic Runge-Kutta of fourth order at 0.02 ms. It also has physics that is in no list.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from hydrolek_drake.challenge.bench_numbers import Machine
from hydrolek_drake.challenge.machine_parts import coil, let_out, snagging, through_play
from hydrolek_drake.challenge.running import SIZE, Player, run

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
def _rates(g: Any, y: np.ndarray, volts: float, t: float, out: np.ndarray) -> None:
    """Rates of the state."""
    e = g.concealed
    x, xd, p_a, p_b, q, qd, felt, cq, cqd, tilt, tiltd, returned, coil_a, coil_b = y
    current = g.i_max * (1.0 - e.fade * (1.0 - math.exp(-t / e.fade_s)))
    i_a = current * min(max(volts, 0.0), 10.0) / 10.0
    i_b = current * min(max(-volts, 0.0), 10.0) / 10.0
    i_a, out[12] = coil(e, i_a, coil_a)
    i_b, out[13] = coil(e, i_b, coil_b)
    force = (
        g.k_f * i_a**2 / (1.0 + g.gap * max(x, 0.0)) ** 2 - g.k_f * i_b**2 / (1.0 + g.gap * max(-x, 0.0)) ** 2
    )
    right = g.area * min(max((x - g.x_o - e.shift_m) / (g.w - g.x_o), 0.0), 1.0)
    left = g.area * min(max((-x - g.x_o + e.shift_m) / (g.w - g.x_o), 0.0), 1.0)
    s_warm = e.warm * (1.0 - math.exp(-t / e.warm_s))
    p_s = g.p_s - e.droop * felt + e.ripple_pa * math.sin(2.0 * math.pi * e.ripple_hz * t)
    p_t = g.p_t + e.return_pa_s * returned
    force -= e.flow_force * (
        right * (abs(p_s - p_a) + abs(p_b - p_t)) - left * (abs(p_s - p_b) + abs(p_a - p_t))
    )
    out[0] = xd
    out[1] = (force - g.c * xd - g.k * x - e.stiction_n * math.tanh(xd / g.stick_v)) / g.m
    pa = _flow(g, right, p_s - p_a, 1.0 + s_warm) + e.null_leak * (p_s - p_a)
    at = _flow(g, left, p_a - p_t, 1.0 + s_warm) * let_out(e, p_a, p_b) + e.null_leak * (p_a - p_t)
    pb = _flow(g, left, p_s - p_b, 1.0 + s_warm) + e.null_leak * (p_s - p_b)
    bt = _flow(g, right, p_b - p_t, 1.0 + s_warm) + e.null_leak * (p_b - p_t)
    out[6] = (pa + pb - felt) / 0.02
    out[11] = (at + bt - returned) / 0.02
    playing = e.gap_rad > 0.0
    side, sided = (cq, cqd) if playing else (q, qd)
    if e.base_k > 0.0:
        side -= tilt
        sided -= tiltd
    s, lever = _cylinder(g, side)
    v = lever * sided
    across = e.cross_leak * (p_a - p_b)
    soft_a = 1.0 / g.bulk + e.air * 1e5 / max(p_a, 1e5) ** 2
    soft_b = 1.0 / g.bulk + e.air * 1e5 / max(p_b, 1e5) ** 2
    vol_a = g.v_0 + g.a_a * max(s, 0.0)
    vol_b = g.v_0 + g.a_b * max(g.stroke - s, 0.0)
    hose = e.hose * g.v_0 / 1e6
    out[2] = (pa - at - across - g.a_a * v) / (vol_a * soft_a + hose)
    out[3] = (pb - bt + across + g.a_b * v) / (vol_b * soft_b)
    if p_a <= 0.0 and out[2] < 0.0:
        out[2] = 0.0
    if p_b <= 0.0 and out[3] < 0.0:
        out[3] = 0.0
    ratio = v / e.stribeck_v
    dry = (e.coulomb_n + e.stribeck_n * math.exp(-ratio * ratio)) * math.tanh(v / g.v_dry)
    scored = e.rubbing_n * math.exp(-(((s / REACHED_M - e.rubbing_at) / e.rubbing_wide) ** 2))
    dry += (e.tight_n * (s / REACHED_M) ** 2 + scored) * math.tanh(v / g.v_dry)
    rod = g.a_a * p_a - g.a_b * p_b - g.c_cyl * (1.0 - s_warm) * v - dry
    if e.cushion > 0.0 and s < e.cushion_m and v < 0.0:
        rod -= e.cushion * v * (1.0 - s / e.cushion_m)
    moment = rod * lever
    stop = 0.0
    if q > g.q_hi:
        stop = -g.k_stop * (q - g.q_hi) - g.c_stop * qd
    elif q < g.q_lo:
        stop = -g.k_stop * (q - g.q_lo) - g.c_stop * qd
    rest = stop - g.mgl * math.cos(q) - g.c_j * qd
    rest += e.shaking_nm * math.sin(2.0 * math.pi * e.shaking_hz * t)
    rest -= snagging(e, q, g.q_lo, g.q_hi)
    out[4] = qd
    if playing:
        through = through_play(e.gap_rad, g.k_play, g.c_play, cq - q, cqd - qd)
        out[5] = (through + rest) / g.inertia
        out[7] = cqd
        out[8] = (moment - through) / g.j_play
    else:
        out[5] = (moment + rest) / g.inertia
        out[7] = 0.0
        out[8] = 0.0
    out[9] = tiltd
    out[10] = 0.0
    if e.base_k > 0.0:
        damping = 0.1 * math.sqrt(e.base_k * e.base_j)
        out[10] = (-moment - e.base_k * tilt - damping * tiltd) / e.base_j


@njit
def _travelled(g: Any, angle: float) -> float:
    """Place in the sensor's travel, from -1 to 1."""
    return 2.0 * (angle - g.q_lo) / (g.q_hi - g.q_lo) - 1.0


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


def _at_rest(machine: Machine, start: float) -> np.ndarray:
    """At rest in balance: side B at its stated pressure, side A carries the load; a play is centred."""
    g, e = machine, machine.concealed
    if e.payload_kg:
        raise ValueError("load.payload: the bench has no tool that holds one")
    y = np.zeros(SIZE)
    moment = g.mgl * math.cos(start) + snagging(e, start, g.q_lo, g.q_hi)
    y[3] = g.p_b_0
    y[4] = y[7] = start
    if e.base_k > 0.0:
        y[9] = -moment / e.base_k  # the base leans against the load
    _, lever = _cylinder(g, start - y[9])
    y[2] = (moment / lever + g.a_b * y[3]) / g.a_a
    return y


play = Player(_run, _at_rest, turns_back=False)
