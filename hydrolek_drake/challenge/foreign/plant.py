"""Numbers of a foreign machine."""

from typing import NamedTuple


class Plant(NamedTuple):
    """Numbers of a machine in SI units, and what it conceals; angles of a link, or places of a slide.

    Attributes:
        turns: 1 for a link, 0 for a slide.
        area_a: of the piston on side A [m^2].
        area_b: on the rod's side.
        stroke: of the piston [m].
        retracted: length of the cylinder at no stroke [m]; 0 for a slide.
        base_x: fixed end of the cylinder from the axis, level [m].
        base_y: upwards.
        link_r: moving end's distance from the axis [m].
        link_phase: its direction at angle zero [rad].
        dead_a: oil of side A at no stroke [m^3].
        dead_b: of side B at full stroke.
        inertia: that moves [kg m^2 or kg].
        weight_moment: of gravity at angle zero [N m].
        damping: of bearing or guides.
        seal_damping: of the seals [N s/m].
        width: of the edges P-A, P-B, A-T, B-T [m]. # four
        overlap: of the edges [m].
        rounding: of the edges [m].
        travel: of the spool [m].
        natural: frequency of the spool's position loop [rad/s].
        ratio: its damping ratio.
        full_volts: command of full travel [V].
        delay: of the command [s].
        discharge: flow coefficient of a turbulent edge.
        density: of the oil at no pressure [kg/m^3].
        viscosity: kinematic [m^2/s].
        critical: flow number below which an edge turns laminar.
        bulk: modulus of the liquid [Pa].
        tank: pressure [Pa].
        pumped: 1 for a pump with relief valve, 0 for a constant pressure.
        setting: of relief valve or supply [Pa].
        pump: its flow [m^3/s].
        pump_leak: its leakage [m^3/(s Pa)].
        rise: of pressure with all flow let off [Pa].
        relief_s: time constant of the relief valve [s].
        line: volume [m^3].
        droop_s: with which a supply follows the flow drawn [s].
        stop: stiffness of an end stop [N/m^1.5].
        stop_damping: of it [s/m].
        bristle: stiffness of the bristles [1/m], for each newton of breakaway friction.
        coupling: inertia of the cylinder's side of a play [kg m^2 or kg].
        contact: stiffness of the sides of a play.
        gas_exponent: of bubbles.
        tip: distance at which a payload hangs [m].
        stribeck: speed over which further friction at rest fades [m/s].
        leak: past the piston [m^3/(s Pa)].
        coulomb: friction of the seals [N].
        static: further friction at rest [N].
        late_s: further dead time [s].
        droop: of a constant supply [Pa s/m^3].
        lost: share of the pump's flow that is missing.
        air: volume of bubbles at atmospheric pressure, as share of the oil.
        gap: of a play [rad or m].
        payload: mass [kg].
        payload_s: when it is picked up [s].
        shift: of the spool's null [m].
        null_leak: of each land [m^3/(s Pa)].
        drift: of the sensor [rad/s or m/s].
    """

    turns: float
    area_a: float
    area_b: float
    stroke: float
    retracted: float
    base_x: float
    base_y: float
    link_r: float
    link_phase: float
    dead_a: float
    dead_b: float
    inertia: float
    weight_moment: float
    damping: float
    seal_damping: float
    width: tuple[float, float, float, float]
    overlap: float
    rounding: float
    travel: float
    natural: float
    ratio: float
    full_volts: float
    delay: float
    discharge: float
    density: float
    viscosity: float
    critical: float
    bulk: float
    tank: float
    pumped: float
    setting: float
    pump: float
    pump_leak: float
    rise: float
    relief_s: float
    line: float
    droop_s: float
    stop: float
    stop_damping: float
    bristle: float
    coupling: float
    contact: float
    gas_exponent: float
    tip: float
    stribeck: float
    leak: float = 0.0
    coulomb: float = 0.0
    static: float = 0.0
    late_s: float = 0.0
    droop: float = 0.0
    lost: float = 0.0
    air: float = 0.0
    gap: float = 0.0
    payload: float = 0.0
    payload_s: float = 0.0
    shift: float = 0.0
    null_leak: float = 0.0
    drift: float = 0.0
