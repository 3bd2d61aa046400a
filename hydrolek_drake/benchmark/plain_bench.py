"""The joint bench as a user would first write it: one function and SciPy's LSODA.

A yardstick for `hydrolek benchmark` and an independent check of the rollout in the tests. It shares the rig's
numbers and nothing else with the project's physics, and knows no effects.
"""

import itertools
import math
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from hydrolek_drake.rigs import Rig

# Absolute tolerances of x, x', P_A, P_B, q, q': without them a chamber at zero pressure stalls the solver.
_ABSOLUTE = (1e-11, 1e-8, 1.0, 1.0, 1e-10, 1e-8)


def plain_right_hand_side(rig: Rig) -> Callable[[float, np.ndarray, float], list[float]]:
    """State derivative of x, x', P_A, P_B, q, q' at a held voltage (the bench's page, points 1 to 5)."""
    v = rig.value
    i_max = v("amplifier.max_current_a")
    k_f, g = v("solenoid.force_constant_a"), v("solenoid.gap_constant")
    m, c, k = v("solenoid.moving_mass"), v("solenoid.damping"), v("solenoid.spring")
    x_o, w, area = v("valve.overlap_a"), v("valve.full_opening_a"), v("valve.max_area_a")
    c_q, rho, dp_t = v("valve.discharge"), v("fluid.density"), v("fluid.laminar_transition")
    p_s, p_t, bulk = v("supply.pressure"), v("supply.tank_pressure"), v("fluid.bulk_modulus")
    a_a, a_b, v_0 = v("cylinder.area_a"), v("cylinder.area_b"), v("cylinder.dead_volume_a")
    stroke, c_cyl = v("cylinder.stroke"), v("cylinder.viscous_friction")
    a, b, phi = v("linkage.distance_parent"), v("linkage.distance_child"), v("linkage.angle_offset")
    zero = v("linkage.zero_stroke_length")
    inertia, moment, c_j = v("load.inertia"), v("load.gravity_cos"), v("load.damping")
    low, high = v("load.lower_stop"), v("load.upper_stop")
    k_s, c_s = v("load.stop_stiffness"), v("load.stop_damping")

    def orifice(opening: float, drop: float) -> float:
        return c_q * opening * math.sqrt(2.0 / rho) * drop / (drop * drop + dp_t * dp_t) ** 0.25

    def rates(time: float, state: np.ndarray, voltage: float) -> list[float]:
        x, xd, p_a, p_b, q, qd = state
        i_a = min(max(voltage, 0.0), 10.0) / 10.0 * i_max
        i_b = min(max(-voltage, 0.0), 10.0) / 10.0 * i_max
        force = k_f * i_a**2 / (1 + g * max(x, 0.0)) ** 2 - k_f * i_b**2 / (1 + g * max(-x, 0.0)) ** 2
        right = area * min(max((x - x_o) / (w - x_o), 0.0), 1.0)
        left = area * min(max((-x - x_o) / (w - x_o), 0.0), 1.0)
        q_a = orifice(right, p_s - p_a) - orifice(left, p_a - p_t)
        q_b = orifice(left, p_s - p_b) - orifice(right, p_b - p_t)
        length = math.sqrt(a * a + b * b - 2 * a * b * math.cos(q + phi))
        lever = a * b * math.sin(q + phi) / length
        s, speed = length - zero, lever * qd
        dp_a = bulk / (v_0 + a_a * max(s, 0.0)) * (q_a - a_a * speed)
        dp_b = bulk / (v_0 + a_b * max(stroke - s, 0.0)) * (q_b + a_b * speed)
        if p_a <= 0.0:
            dp_a = max(dp_a, 0.0)
        if p_b <= 0.0:
            dp_b = max(dp_b, 0.0)
        rod = a_a * p_a - a_b * p_b - c_cyl * speed
        stop = 0.0
        if q > high:
            stop = -k_s * (q - high) - c_s * qd
        elif q < low:
            stop = -k_s * (q - low) - c_s * qd
        acceleration = (rod * lever - moment * math.cos(q) - c_j * qd + stop) / inertia
        return [xd, (force - c * xd - k * x) / m, dp_a, dp_b, qd, acceleration]

    return rates


def simulate_plainly(rig: Rig, times: np.ndarray, volts: np.ndarray) -> np.ndarray:
    """Joint angle [rad] at `times` for voltages held between samples; LSODA as the bench's page uses it."""
    rates = plain_right_hand_side(rig)
    q = rig.value("load.initial_position")
    a, b, phi = (
        rig.value(f"linkage.{name}") for name in ("distance_parent", "distance_child", "angle_offset")
    )
    lever = a * b * math.sin(q + phi) / math.sqrt(a * a + b * b - 2 * a * b * math.cos(q + phi))
    p_b = rig.value("cylinder.initial_pressure_b")
    held = rig.value("load.gravity_cos") * math.cos(q) / lever
    p_a = (held + rig.value("cylinder.area_b") * p_b) / rig.value("cylinder.area_a")
    state = np.array([0.0, 0.0, p_a, p_b, q, 0.0])
    delay = rig.value("command.delay")
    changes = np.flatnonzero(np.diff(volts, prepend=np.nan))
    edges = [times[0], *(t for t in times[changes] + delay if t < times[-1]), times[-1]]
    held_V = [0.0, *volts[changes]]  # nothing is driven before the first command has arrived
    angle = np.empty(len(times))
    for i, (begin, end) in enumerate(itertools.pairwise(edges)):
        inside = (times >= begin) & (times <= end)
        wanted = np.unique(np.concatenate([times[inside], [end]]))
        found = solve_ivp(
            rates,
            (begin, end),
            state,
            "LSODA",
            wanted,
            args=(float(held_V[i]),),
            max_step=5e-4,
            rtol=1e-8,
            atol=_ABSOLUTE,
        )
        angle[inside] = found.y[4, : int(inside.sum())]
        state = found.y[:, -1]
    return angle
