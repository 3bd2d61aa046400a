"""Numbers of one arm joint's concealed machine: from the rig and the URDF, and its effects."""

import math
from typing import NamedTuple

from scipy.constants import g as GRAVITY

from hydrolek_drake.challenge.arm_body import turned_body
from hydrolek_drake.kinematics.arms import arms_urdf_path
from hydrolek_drake.rigs import Rig


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
    rubbing_n: float = 0.0  # dry friction where the bore is scored, around one share of the stroke
    rubbing_at: float = 0.5
    rubbing_wide: float = 0.1
    hose: float = 0.0  # hose on side A, volume v_a hose p / 1 MPa on top
    shaking_nm: float = 0.0  # periodic moment at the joint
    shaking_hz: float = 1.0
    ramp_v_per_s: float = math.inf  # a card lets the voltage change no faster
    coil_s: float = 0.0  # time constant of the coils' currents
    lost_s: float = 0.0  # the command is lost for so long, once in every lost_every_s
    lost_every_s: float = 1.0
    flow_force: float = 0.0  # oil closes the spool, with this share of opening times pressure drop
    return_pa_s: float = 0.0  # return line, pressure for each m^3/s through it
    snag_nm_per_rad: float = 0.0  # hoses that pull tight beyond an angle, a share of the travel
    snag_at: float = 0.5
    held: float = 0.0  # share of the way out of side A that a counterbalance valve may close
    holding_pa: float = 1.0  # and the lifting pressure at which it is wholly open
    worn_rad: float = 0.0  # potentiometer worn around one angle
    worn_at: float = 0.5
    worn_wide: float = 0.1


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
