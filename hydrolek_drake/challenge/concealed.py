"""What a concealed machine may conceal: its numbers, of every kind of machine."""

import math
from typing import NamedTuple


class Concealed(NamedTuple):
    """Numbers of listed effects, and of physics in no list; zero is off."""

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
    payload_kg: float = 0.0  # of arms alone, since the bench has no tool
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
    hose: float = 0.0  # hose on side A, dead volume times hose p / 1 MPa on top
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
