"""Numbers of a concealed machine of the joint bench, from the rig."""

import math
from typing import NamedTuple

from hydrolek_drake.rigs import Rig


class Machine(NamedTuple):
    """Numbers of one machine, its listed effects, and those in no list; zero is off."""

    i_max: float
    k_f: float
    gap: float
    m: float
    c: float
    k: float
    x_o: float
    w: float
    area: float
    c_q: float
    rho: float
    dp_t: float
    p_s: float
    p_t: float
    bulk: float
    a_a: float
    a_b: float
    v_0: float
    stroke: float
    c_cyl: float
    a: float
    b: float
    phi: float
    inertia: float
    mgl: float
    c_j: float
    q_lo: float
    q_hi: float
    k_stop: float
    c_stop: float
    t_d: float
    p_b_0: float
    v_dry: float
    stick_v: float
    j_play: float
    k_play: float
    c_play: float
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
    bow_rad: float = 0.0
    play_rad: float = 0.0
    drift_rad_per_min: float = 0.0
    ripple_pa: float = 0.0  # in no list: supply pressure + ripple sin(2 pi f t)
    ripple_hz: float = 1.0
    tight_n: float = 0.0  # in no list: dry friction that grows with the stroke squared
    rubbing_n: float = 0.0  # in no list: dry friction where the bore is scored, around one stroke
    rubbing_at: float = 0.5
    rubbing_wide: float = 0.1
    hose: float = 0.0  # in no list: hose on side A, volume v_0 hose p / 1 MPa on top
    shaking_nm: float = 0.0  # in no list: periodic moment at the joint
    shaking_hz: float = 1.0
    ramp_v_per_s: float = math.inf  # in no list: a card lets the voltage change no faster
    coil_s: float = 0.0  # in no list: time constant of the coils' currents
    lost_s: float = 0.0  # in no list: the command is lost for so long, once in every lost_every_s
    lost_every_s: float = 1.0
    flow_force: float = (
        0.0  # in no list: oil closes the spool, with this share of opening times pressure drop
    )
    return_pa_s: float = 0.0  # in no list: return line, pressure for each m^3/s through it
    snag_nm_per_rad: float = 0.0  # in no list: hoses that pull tight beyond an angle, a share of the travel
    snag_at: float = 0.5
    held: float = 0.0  # in no list: share of the way out of side A that a counterbalance valve may close
    holding_pa: float = 1.0  # and the lifting pressure at which it is wholly open
    worn_rad: float = 0.0  # in no list: potentiometer worn around one angle
    worn_at: float = 0.5
    worn_wide: float = 0.1


SPREAD = {
    "area": "valve.max_area_a",
    "x_o": "valve.overlap_a",
    "w": "valve.full_opening_a",
    "p_s": "supply.pressure",
    "bulk": "fluid.bulk_modulus",
    "c_cyl": "cylinder.viscous_friction",
    "inertia": "load.inertia",
    "mgl": "load.gravity_cos",
    "i_max": "amplifier.max_current_a",
    "t_d": "command.delay",
}
"""What differs from machine to machine of this build -> its path in the rig."""


def nominal_machine(rig: Rig) -> Machine:
    """The machine that the rig describes."""
    v = rig.value
    return Machine(
        i_max=v("amplifier.max_current_a"),
        k_f=v("solenoid.force_constant_a"),
        gap=v("solenoid.gap_constant"),
        m=v("solenoid.moving_mass"),
        c=v("solenoid.damping"),
        k=v("solenoid.spring"),
        x_o=v("valve.overlap_a"),
        w=v("valve.full_opening_a"),
        area=v("valve.max_area_a"),
        c_q=v("valve.discharge"),
        rho=v("fluid.density"),
        dp_t=v("fluid.laminar_transition"),
        p_s=v("supply.pressure"),
        p_t=v("supply.tank_pressure"),
        bulk=v("fluid.bulk_modulus"),
        a_a=v("cylinder.area_a"),
        a_b=v("cylinder.area_b"),
        v_0=v("cylinder.dead_volume_a"),
        stroke=v("cylinder.stroke"),
        c_cyl=v("cylinder.viscous_friction"),
        a=v("linkage.distance_parent"),
        b=v("linkage.distance_child"),
        phi=v("linkage.angle_offset"),
        inertia=v("load.inertia"),
        mgl=v("load.gravity_cos"),
        c_j=v("load.damping"),
        q_lo=v("load.lower_stop"),
        q_hi=v("load.upper_stop"),
        k_stop=v("load.stop_stiffness"),
        c_stop=v("load.stop_damping"),
        t_d=v("command.delay"),
        p_b_0=v("cylinder.initial_pressure_b"),
        v_dry=v("cylinder.friction_velocity"),
        stick_v=v("solenoid.stiction_velocity"),
        j_play=v("linkage.play_inertia"),
        k_play=v("linkage.play_stiffness"),
        c_play=v("linkage.play_damping"),
    )
