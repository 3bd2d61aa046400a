"""Numbers of a concealed machine of the joint bench, from the rig."""

import math
from typing import NamedTuple

from hydrolek_drake.challenge.concealed import Concealed
from hydrolek_drake.rigs import Rig


class Machine(NamedTuple):
    """Numbers of one machine, and what it conceals."""

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
    polarity: float = 1.0  # as the page has it: any voltage arrives, and drives the way that its sign says
    limit: float = math.inf
    concealed: Concealed = Concealed()


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
