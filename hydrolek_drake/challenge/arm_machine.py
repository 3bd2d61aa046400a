"""One joint of a HydroLek arm once more, written from the thesis: the machine that conceals an effect.

Equations (4.2) to (4.9) with numbers from the rig and masses from the URDF, in another form than the rollout that
diagnoses it: cylinder mounts as points in the plane, the rod's mass by its kinetic energy at every angle, gravity
by the centre of mass; spool, oil and link in one classic Runge-Kutta method of fourth order at 0.02 ms. It also has
physics that is in no list.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from scipy.constants import g as GRAVITY

from hydrolek_drake.challenge.arm_body import turned_body
from hydrolek_drake.challenge.driving import SAMPLE_S, Driving, Played, controlled, turned_back
from hydrolek_drake.kinematics.arms import arms_urdf_path
from hydrolek_drake.rigs import Rig

STEP_S = 2e-5
"""Half of it changes the angle by 1.2e-4 deg at most, with a play by 1.6e-3 deg: see docs/concealed_effects.md."""

SIZE = 11
"""x, x', P_A, P_B, q, q', flow felt by the supply, cylinder's side and its rate, tilt and its rate."""


class ArmMachine(NamedTuple):
    """Numbers of one joint's machine, its listed effects, and those in no list; zero is off.

    Side A and B carry their letter. For a vane areas are m^3/rad and strokes rad.
    """

    # command (4.2), (4.3) and amplifiers (4.4)
    t_d: float
    polarity: float
    limit: float
    full_voltage: float
    i_min: float
    i_max_a: float
    i_max_b: float
    # solenoids and spool (4.5), (4.6)
    k_f_a: float
    k_f_b: float
    gap: float
    m: float
    c: float
    k: float
    stick_v: float
    # valve (4.7), (4.8), oil and pump
    x_o_a: float
    x_o_b: float
    w_a: float
    w_b: float
    area_max_a: float
    area_max_b: float
    c_q: float
    rho: float
    dp_t: float
    p_s: float
    p_t: float
    flow_s: float
    bulk: float
    p_atm: float
    floor_s: float
    # cylinder or vane (4.9)
    a_a: float
    a_b: float
    v_a: float
    v_b: float
    stroke: float
    c_cyl: float
    slide_v: float
    rod: float
    start_p_b: float
    # linkage: a triangle of two mounts (rotary 0), or a vane on the axis (rotary 1)
    rotary: float
    direction: float
    mount_p: float
    mount_c: float
    offset: float
    retracted: float
    play_j: float
    play_k: float
    play_c: float
    play_up: float
    # what turns
    inertia: float
    weight_moment: float
    weight_phase: float
    tool_r: float
    tool_weight: float
    tool_phase: float
    c_j: float
    q_lo: float
    q_hi: float
    k_stop: float
    c_stop: float
    rocking: float
    z_lo: float
    z_hi: float
    # listed effects
    delay_s: float = 0.0
    fade: float = 0.0
    fade_s: float = 1.0
    shift_m: float = 0.0
    stiction_n: float = 0.0
    null_leak: float = 0.0
    droop: float = 0.0
    air: float = 0.0
    warm: float = 0.0
    warm_s: float = 1.0
    cross_leak: float = 0.0
    coulomb_n: float = 0.0
    stribeck_n: float = 0.0
    stribeck_v: float = 1.0
    cushion: float = 0.0
    cushion_m: float = 1.0
    gap_rad: float = 0.0
    base_k: float = 0.0
    base_j: float = 1.0
    payload_kg: float = 0.0
    payload_s: float = 0.0
    bow_rad: float = 0.0
    play_rad: float = 0.0
    drift_rad_per_min: float = 0.0
    # in no list
    ripple_pa: float = 0.0  # supply pressure + ripple sin(2 pi f t)
    ripple_hz: float = 1.0
    tight_n: float = 0.0  # dry friction that grows with the square of the stroke, so much at its end
    hose: float = 0.0  # hose on side A, volume v_a hose p / 1 MPa on top
    shaking_nm: float = 0.0  # periodic moment at the joint
    shaking_hz: float = 1.0


LISTED: dict[str, dict[str, str]] = {
    "command.delay": {"delay_s": "delay_s"},
    "amplifier.gain_fade": {"fraction": "fade", "time_constant_s": "fade_s"},
    "valve.asymmetric_overlap": {"shift_m": "shift_m"},
    "valve.spool_stiction": {"force_N": "stiction_n"},
    "valve.null_leakage": {"conductance_m3_per_s_Pa": "null_leak"},
    "supply.pressure_droop": {"resistance_Pa_s_per_m3": "droop"},
    "fluid.entrained_air": {"air_fraction": "air"},
    "fluid.warm_up": {"fraction": "warm", "time_constant_s": "warm_s"},
    "cylinder.cross_port_leakage": {"conductance_m3_per_s_Pa": "cross_leak"},
    "cylinder.coulomb_friction": {"coulomb_N": "coulomb_n"},
    "cylinder.stribeck_friction": {
        "coulomb_N": "coulomb_n", "stribeck_N": "stribeck_n", "stribeck_velocity_m_per_s": "stribeck_v",
    },
    "cylinder.end_cushion": {"damping_N_s_per_m": "cushion", "length_m": "cushion_m"},
    "linkage.backlash": {"gap_rad": "gap_rad"},
    "base.compliance": {"stiffness_Nm_per_rad": "base_k", "inertia_kg_m2": "base_j"},
    "load.payload": {"mass_kg": "payload_kg", "time_s": "payload_s"},
    "sensor.nonlinearity": {"amplitude_rad": "bow_rad"},
    "sensor.hysteresis": {"half_width_rad": "play_rad"},
    "sensor.drift": {"rate_rad_per_min": "drift_rad_per_min"},
}  # fmt: skip
"""Effect -> its parameters -> field of the machine."""

SPREAD = {
    "area_max_a": "valve.max_area_a",
    "area_max_b": "valve.max_area_b",
    "x_o_a": "valve.overlap_a",
    "x_o_b": "valve.overlap_b",
    "w_a": "valve.full_opening_a",
    "w_b": "valve.full_opening_b",
    "p_s": "supply.pressure",
    "bulk": "fluid.bulk_modulus",
    "c_cyl": "cylinder.viscous_friction",
    "i_max_a": "amplifier.max_current_a",
    "i_max_b": "amplifier.max_current_b",
    "t_d": "command.delay",
}
"""What differs from machine to machine -> its path in the rig; masses are known, so they do not."""


def nominal_machine(rig: Rig) -> ArmMachine:
    """The machine that a rig of one arm joint describes."""
    v = rig.value
    joint = rig.joints[0]
    body = turned_body(arms_urdf_path(), joint, rig.posture_without(joint))
    rotary = rig.variant(joint, "linkage") == "direct"
    return ArmMachine(
        t_d=v("command.delay"),
        polarity=v("command.polarity"),
        limit=v("command.limit"),
        full_voltage=v("amplifier.full_voltage"),
        i_min=v("amplifier.min_current"),
        i_max_a=v("amplifier.max_current_a"),
        i_max_b=v("amplifier.max_current_b"),
        k_f_a=v("solenoid.force_constant_a"),
        k_f_b=v("solenoid.force_constant_b"),
        gap=v("solenoid.gap_constant"),
        m=v("solenoid.moving_mass"),
        c=v("solenoid.damping"),
        k=v("solenoid.spring"),
        stick_v=v("solenoid.stiction_velocity"),
        x_o_a=v("valve.overlap_a"),
        x_o_b=v("valve.overlap_b"),
        w_a=v("valve.full_opening_a"),
        w_b=v("valve.full_opening_b"),
        area_max_a=v("valve.max_area_a"),
        area_max_b=v("valve.max_area_b"),
        c_q=v("valve.discharge"),
        rho=v("fluid.density"),
        dp_t=v("fluid.laminar_transition"),
        p_s=v("supply.pressure"),
        p_t=v("supply.tank_pressure"),
        flow_s=v("supply.flow_time_constant"),
        bulk=v("fluid.bulk_modulus"),
        p_atm=v("fluid.atmospheric_pressure"),
        floor_s=v("fluid.floor_time"),
        a_a=v("cylinder.area_a"),
        a_b=v("cylinder.area_b"),
        v_a=v("cylinder.dead_volume_a"),
        v_b=v("cylinder.dead_volume_b"),
        stroke=v("cylinder.stroke"),
        c_cyl=v("cylinder.viscous_friction"),
        slide_v=v("cylinder.friction_velocity"),
        rod=0.0 if rotary else v("cylinder.rod_mass"),
        start_p_b=v("cylinder.initial_pressure_b"),
        rotary=float(rotary),
        direction=v("linkage.direction"),
        mount_p=0.0 if rotary else v("linkage.distance_parent"),
        mount_c=0.0 if rotary else v("linkage.distance_child"),
        offset=0.0 if rotary else v("linkage.angle_offset"),
        retracted=v("linkage.zero_stroke_position") if rotary else v("linkage.zero_stroke_length"),
        play_j=v("linkage.play_inertia"),
        play_k=v("linkage.play_stiffness"),
        play_c=v("linkage.play_damping"),
        play_up=v("linkage.play_taken_up"),
        inertia=body.inertia,
        weight_moment=GRAVITY * body.slope * body.moment,
        weight_phase=body.phase,
        tool_r=body.tool_distance,
        tool_weight=GRAVITY * body.slope * body.tool_distance,
        tool_phase=body.tool_phase,
        c_j=v("load.damping"),
        q_lo=v("load.lower_stop"),
        q_hi=v("load.upper_stop"),
        k_stop=v("load.stop_stiffness"),
        c_stop=v("load.stop_damping"),
        rocking=v("base.rocking_damping_ratio"),
        z_lo=v("sensor.travel_lower"),
        z_hi=v("sensor.travel_upper"),
    )


def with_effects(machine: ArmMachine, effects: Mapping[str, Mapping[str, float]]) -> ArmMachine:
    """The machine with listed effects, as they stand in labels and reports."""
    fields: dict[str, float] = {}
    for effect, parameters in effects.items():
        for name, value in parameters.items():
            fields[LISTED[effect][name]] = value
    return machine._replace(**fields)


@njit
def _coil(g: Any, k_f: float, i_max: float, volts: float, plunger: float, warm: float) -> float:
    """Force of one solenoid towards its side, (4.4) and (4.5)."""
    current = warm * (g.i_min + min(max(volts, 0.0), g.full_voltage) / g.full_voltage * (i_max - g.i_min))
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
def _rates(g: Any, y: np.ndarray, volts: float, t: float, out: np.ndarray) -> None:
    """Rates of the state."""
    x, xd, p_a, p_b, q, qd, felt, cq, cqd, tilt, tiltd = y
    warm_coil = 1.0 - g.fade * (1.0 - math.exp(-t / g.fade_s))
    thin = g.warm * (1.0 - math.exp(-t / g.warm_s))

    push = _coil(g, g.k_f_a, g.i_max_a, volts, x, warm_coil) - _coil(
        g, g.k_f_b, g.i_max_b, -volts, -x, warm_coil
    )
    out[0] = xd
    out[1] = (push - g.c * xd - g.k * x - g.stiction_n * math.tanh(xd / g.stick_v)) / g.m

    to_a = g.area_max_a * _opened(x, g.x_o_a, g.w_a, g.shift_m) * (1.0 + thin)
    to_b = g.area_max_b * _opened(-x, g.x_o_b, g.w_b, -g.shift_m) * (1.0 + thin)
    p_s = max(g.p_s - g.droop * felt, g.p_t) + g.ripple_pa * math.sin(2.0 * math.pi * g.ripple_hz * t)
    from_pump_a = _orifice(g, to_a, p_s - p_a) + g.null_leak * (p_s - p_a)
    from_pump_b = _orifice(g, to_b, p_s - p_b) + g.null_leak * (p_s - p_b)
    back_a = _orifice(g, to_b, p_a - g.p_t) + g.null_leak * (p_a - g.p_t)
    back_b = _orifice(g, to_a, p_b - g.p_t) + g.null_leak * (p_b - g.p_t)
    past = g.cross_leak * (p_a - p_b)
    out[6] = (from_pump_a + from_pump_b - felt) / g.flow_s

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
    rod = g.a_a * p_a - g.a_b * p_b - g.c_cyl * (1.0 - thin) * v - dry * math.tanh(v / g.slide_v)
    if g.cushion > 0.0 and s < g.cushion_m and v < 0.0:
        rod -= g.cushion * (1.0 - s / g.cushion_m) * v
    moment = rod * lever

    load = g.payload_kg if t >= g.payload_s else 0.0
    inertia = g.inertia + load * g.tool_r * g.tool_r + g.rod * lever * lever
    rest = g.shaking_nm * math.sin(2.0 * math.pi * g.shaking_hz * t) - g.c_j * qd
    rest -= g.weight_moment * math.cos(q + g.weight_phase) + load * g.tool_weight * math.cos(q + g.tool_phase)
    rest -= g.rod * lever * bend * qd * qd
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
    for n in range(len(out)):
        t = n * SAMPLE_S
        z = (2.0 * shaft - g.z_lo - g.z_hi) / (g.z_hi - g.z_lo)
        out[n, 0] = shaft + g.bow_rad * (1.0 - z * z) + g.drift_rad_per_min * t / 60.0
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
            u = g.polarity * volts[int(place)] if place >= 0 else 0.0
            u = min(max(u, -g.limit), g.limit)
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
    tilt = -moment / g.base_k if g.base_k > 0.0 else 0.0  # the base leans against the load
    side = start
    if g.gap_rad > 0.0 and moment != 0.0:
        side += g.play_up * (math.copysign(0.5 * g.gap_rad, moment) + moment / g.play_k)
    _, lever, _ = _actuator(g, side - tilt)
    p_b = g.start_p_b
    p_a = (moment / lever + g.a_b * p_b) / g.a_a
    if p_a < 0.0:
        p_a = g.p_t
        p_b = (g.a_a * p_a - moment / lever) / g.a_b
    y = np.zeros(SIZE)
    y[2], y[3], y[4], y[7], y[9] = p_a, p_b, start, side, tilt
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
