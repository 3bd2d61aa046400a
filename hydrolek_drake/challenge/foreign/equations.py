"""A hydraulic axis in a formulation of its own: chambers by the mass of their oil, edges by their flow number.

Nothing here is shared with the physics that diagnoses it. Oil is kept by mass, its pressure follows from how densely
it is packed (exponential for the liquid, polytropic for bubbles); what flows through an edge is told by volume at the
chamber, as most simulators do, since what yields in a chamber is hose and tube as much as oil; edges are rounded and
turn laminar with their flow number (tanh law, Borutzky, Barnard, Thoma 2002); end stops and the sides of a play are
Hunt and Crossley's (1975); dry friction is that of bristles (LuGre; Canudas de Wit et al. 1995); the cylinder's lever
is a cross product of points in the plane. One classic Runge-Kutta method of fourth order runs all of it.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from hydrolek_drake.challenge.foreign.plant import Plant

SAMPLE_S = 0.01
STEP_S = 2e-5
SIZE = 12
"""Of a state: spool's place and speed, masses of oil in A and B, angle or place and its rate, pressure of the line,
opening of the relief valve, flow that a constant supply feels, deflection of bristles, cylinder's side of a play and
its rate."""

ATMOSPHERE = 101325.0
GRAVITY = 9.80665


@njit
def pressure_of(g: Plant, mass: float, volume: float) -> float:
    """Pressure above the atmosphere of oil that fills a volume; 0 where it does not fill it [Pa]."""
    packed = volume * g.density / mass
    if packed >= 1.0:
        return 0.0
    if g.air <= 0.0:
        return -g.bulk * math.log(packed)
    p = 0.0
    for _ in range(60):  # convex and falling: Newton's steps from the left never pass the root
        liquid = (1.0 - g.air) * math.exp(-p / g.bulk)
        gas = g.air * (ATMOSPHERE / (ATMOSPHERE + p)) ** (1.0 / g.gas_exponent)
        slope = liquid / g.bulk + gas / (g.gas_exponent * (ATMOSPHERE + p))
        step = (liquid + gas - packed) / slope
        p += step
        if abs(step) < 0.01:
            break
    return p


@njit
def packed_at(g: Plant, p: float) -> float:
    """Mass in a volume of oil at a pressure [kg/m^3]."""
    gas = g.air * (ATMOSPHERE / (ATMOSPHERE + p)) ** (1.0 / g.gas_exponent)
    return g.density / ((1.0 - g.air) * math.exp(-p / g.bulk) + gas)


@njit
def edge_flow(g: Plant, width: float, opening: float, drop: float) -> float:
    """Flow through a rounded edge, laminar where its flow number is small [m^3/s]."""
    if opening <= 0.0 or drop == 0.0:
        return 0.0
    area = width * (math.sqrt(opening * opening + g.rounding * g.rounding) - g.rounding)
    jet = math.sqrt(2.0 * abs(drop) / g.density)
    number = 2.0 * opening * jet / g.viscosity
    return math.copysign(g.discharge * math.tanh(2.0 * number / g.critical) * area * jet, drop)


@njit
def reach(g: Plant, side: float) -> tuple[float, float]:
    """Stroke [m] and lever [m, or 1] of the cylinder where its end stands at an angle or place."""
    if g.turns < 0.5:
        return side, 1.0
    x, y = g.link_r * math.cos(side + g.link_phase), g.link_r * math.sin(side + g.link_phase)
    rod_x, rod_y = x - g.base_x, y - g.base_y
    length = math.hypot(rod_x, rod_y)
    return length - g.retracted, (x * rod_y - y * rod_x) / length


@njit
def _end_stop(g: Plant, stroke: float, speed: float) -> float:
    """Force of the piston's stops, out of the cylinder as positive [N]."""
    if stroke < 0.0:
        deep, into, sign = -stroke, -speed, 1.0
    elif stroke > g.stroke:
        deep, into, sign = stroke - g.stroke, speed, -1.0
    else:
        return 0.0
    return sign * max(g.stop * deep**1.5 * (1.0 + 1.5 * g.stop_damping * into), 0.0)


@njit
def _rates(g: Plant, y: np.ndarray, volts: float, t: float, out: np.ndarray) -> None:
    """Rates of the state."""
    spool, spool_rate, mass_a, mass_b = y[0], y[1], y[2], y[3]
    q, qd, line, relief, felt = y[4], y[5], y[6], y[7], y[8]
    bristle, end, end_rate = y[9], y[10], y[11]
    wanted = min(max(volts / g.full_volts, -1.0), 1.0) * g.travel
    out[0] = spool_rate
    out[1] = g.natural * g.natural * (wanted - spool) - 2.0 * g.ratio * g.natural * spool_rate

    playing = g.gap > 0.0
    side, side_rate = (end, end_rate) if playing else (q, qd)
    stroke, lever = reach(g, side)
    speed = lever * side_rate
    p_a = pressure_of(g, mass_a, g.dead_a + g.area_a * stroke)
    p_b = pressure_of(g, mass_b, g.dead_b + g.area_b * (g.stroke - stroke))

    supply = line if g.pumped > 0.5 else max(g.setting - g.droop * felt, g.tank)
    x = spool + g.shift
    to_a = edge_flow(g, g.width[0], x - g.overlap, supply - p_a) + g.null_leak * (supply - p_a)
    to_b = edge_flow(g, g.width[1], -x - g.overlap, supply - p_b) + g.null_leak * (supply - p_b)
    from_a = edge_flow(g, g.width[2], -x - g.overlap, p_a - g.tank) + g.null_leak * (p_a - g.tank)
    from_b = edge_flow(g, g.width[3], x - g.overlap, p_b - g.tank) + g.null_leak * (p_b - g.tank)
    past = g.leak * (p_a - p_b)
    out[2] = packed_at(g, p_a) * (to_a - from_a - past)
    out[3] = packed_at(g, p_b) * (to_b - from_b + past)

    drawn = to_a + to_b
    out[6] = out[7] = 0.0
    if g.pumped > 0.5:
        given = g.pump * (1.0 - g.lost) - g.pump_leak * line
        off = g.pump * relief * math.sqrt(max(line, 0.0) / g.setting)
        out[6] = g.bulk / g.line * (given - off - drawn)
        out[7] = (max((line - g.setting) / g.rise, 0.0) - relief) / g.relief_s
    out[8] = (drawn - felt) / g.droop_s

    dry = 0.0
    out[9] = 0.0
    if g.coulomb + g.static > 0.0:
        stiffness = g.bristle * (g.coulomb + g.static)
        slides_at = g.coulomb + g.static * math.exp(-((speed / g.stribeck) ** 2))
        out[9] = speed - stiffness * abs(speed) / slides_at * bristle
        dry = stiffness * bristle + math.sqrt(stiffness) * out[9]
    rod = g.area_a * p_a - g.area_b * p_b - g.seal_damping * speed - dry + _end_stop(g, stroke, speed)
    pushed = lever * rod

    hangs = g.payload if t >= g.payload_s else 0.0
    inertia = g.inertia + hangs * g.tip * g.tip
    weighs = (g.weight_moment + hangs * GRAVITY * g.tip) * math.cos(q) if g.weight_moment > 0.0 else 0.0
    through = pushed
    out[10] = out[11] = 0.0
    if playing:
        lead, closing = end - q, end_rate - qd
        deep = abs(lead) - 0.5 * g.gap
        through = 0.0
        if deep > 0.0:
            closing = math.copysign(1.0, lead) * closing
            bounce = 1.0 + 1.5 * g.stop_damping * closing * g.link_r
            through = math.copysign(max(g.contact * deep**1.5 * bounce, 0.0), lead)
        out[10] = end_rate
        out[11] = (pushed - through) / g.coupling
    out[4] = qd
    out[5] = (through - g.damping * qd - weighs) / inertia


@njit(cache=True, nogil=True)
def _run(
    g: Plant,
    series: np.ndarray,
    closed: np.ndarray,
    noise: np.ndarray,
    y: np.ndarray,
    volts: np.ndarray,
    out: np.ndarray,
    inner: int,
) -> None:
    """See `played`; `closed` holds the fields of `Closed`, or nothing where voltages are applied as they are."""
    h = SAMPLE_S / inner
    k1, k2, k3, k4, at = np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE)
    late = g.delay + g.late_s
    for n in range(len(out)):
        t = n * SAMPLE_S
        stroke, _ = reach(g, y[10] if g.gap > 0.0 else y[4])
        out[n, 0] = y[4] + g.drift * t
        out[n, 1] = pressure_of(g, y[2], g.dead_a + g.area_a * stroke)
        out[n, 2] = pressure_of(g, y[3], g.dead_b + g.area_b * (g.stroke - stroke))
        out[n, 3] = y[6] if g.pumped > 0.5 else g.setting - g.droop * y[8]
        volts[n] = series[n]
        if len(closed) == 5:
            gain, tolerance, jump, low, high = closed
            if gain > 0.0:
                error = series[n] - out[n, 0] - noise[n]
                volts[n] = 0.0 if abs(error) <= tolerance else gain * error + math.copysign(jump, error)
                volts[n] = min(max(volts[n], -g.full_volts), g.full_volts)
            elif n > 0 and series[n] == series[n - 1]:
                volts[n] = volts[n - 1]
            elif (out[n, 0] > high and series[n] > 0.0) or (out[n, 0] < low and series[n] < 0.0):
                volts[n] = -series[n]
        for i in range(inner):
            now = t + i * h
            place = math.floor((now + 0.5 * h - late) / SAMPLE_S)
            u = volts[int(place)] if place >= 0 else 0.0
            _rates(g, y, u, now, k1)
            for j in range(SIZE):
                at[j] = y[j] + 0.5 * h * k1[j]
            _rates(g, at, u, now + 0.5 * h, k2)
            for j in range(SIZE):
                at[j] = y[j] + 0.5 * h * k2[j]
            _rates(g, at, u, now + 0.5 * h, k3)
            for j in range(SIZE):
                at[j] = y[j] + h * k3[j]
            _rates(g, at, u, now + h, k4)
            for j in range(SIZE):
                y[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])


class Played(NamedTuple):
    """What a machine did, without noise: voltage, angle or place, pressures of A, B and supply. # (n,) each."""

    volts: np.ndarray
    reading: np.ndarray
    pressure_a: np.ndarray
    pressure_b: np.ndarray
    supply: np.ndarray


class Closed(NamedTuple):
    """A driver: a controller that steps over the dead-zone, or without gain one that turns back near the ends.

    Attributes:
        gain: [V per rad or m]; 0 for voltages.
        tolerance: error that is left.
        jump: [V].
        low: place below which nobody drives outwards.
        high: above which nobody does.
    """

    gain: float
    tolerance: float
    jump: float
    low: float
    high: float


def at_rest(g: Plant, start: float) -> np.ndarray:
    """State in balance: B at half of the supply pressure, A carries the load."""
    y = np.zeros(SIZE)
    hangs = g.payload if g.payload_s <= 0.0 else 0.0
    weighs = (g.weight_moment + hangs * GRAVITY * g.tip) * math.cos(start) if g.weight_moment > 0.0 else 0.0
    pressed = (abs(weighs) / g.contact) ** (2.0 / 3.0)
    y[4] = start
    y[10] = start + (math.copysign(0.5 * g.gap + pressed, weighs) if weighs != 0.0 else 0.0)
    stroke, lever = reach(g, y[10] if g.gap > 0.0 else start)
    p_b = 0.5 * g.setting
    p_a = (weighs / lever + g.area_b * p_b) / g.area_a
    y[2] = packed_at(g, p_a) * (g.dead_a + g.area_a * stroke)
    y[3] = packed_at(g, p_b) * (g.dead_b + g.area_b * (g.stroke - stroke))
    if g.pumped > 0.5:
        p = g.setting
        for _ in range(50):  # what the pump gives, the relief valve lets off
            off = (g.pump * (1.0 - g.lost) - g.pump_leak * p) / (g.pump * math.sqrt(p / g.setting))
            p = g.setting + g.rise * off
        y[6], y[7] = p, off
    return y


def played(
    g: Plant,
    series: np.ndarray,
    start: float,
    closed: Closed | None = None,
    noise: np.ndarray | None = None,
    step: float = STEP_S,
) -> Played:
    """What a machine does.

    Args:
        g: the machine.
        series: voltages [V], or set points of a controller; one a sample of `SAMPLE_S`. # (n,)
        start: angle or place at which it rests first.
        closed: who drives; voltages are applied as they are without.
        noise: that a controller sees. # (n,)
        step: of the integration [s].
    """
    volts, out = np.zeros(series.size), np.zeros((series.size, 4))
    driver = np.array(closed if closed is not None else [], dtype=float)
    seen = noise if noise is not None else np.zeros(series.size)
    _run(g, series, driver, seen, at_rest(g, start), volts, out, round(SAMPLE_S / step))
    return Played(volts, *out.T.copy())
