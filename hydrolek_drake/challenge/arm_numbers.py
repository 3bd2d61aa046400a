"""Numbers of one arm joint's concealed machine, from the rig and the URDF."""

from typing import NamedTuple

from scipy.constants import g as GRAVITY

from hydrolek_drake.challenge.arm_body import turned_body
from hydrolek_drake.challenge.concealed import Concealed
from hydrolek_drake.kinematics.arms import arms_urdf_path
from hydrolek_drake.rigs import Rig


class ArmMachine(NamedTuple):
    """Numbers of one joint's machine, and what it conceals.

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
    concealed: Concealed = Concealed()


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
