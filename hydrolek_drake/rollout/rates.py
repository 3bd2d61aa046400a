"""Rates of one joint's state: what its stages and their effects make of pressures, position and spool.

Only the wiring stands here, as in the Diagram; every equation is called from `physics`.
"""

from typing import Any, NamedTuple

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import (
    base,
    cavity,
    cylinder,
    end_stops,
    fluid,
    hooks,
    linkage,
    load,
    rod_friction,
    supply,
    valve,
)
from hydrolek_drake.physics.angle import Angle, AngleKept, angle, angle_near
from hydrolek_drake.physics.driven import (
    chamber_pressures,
    is_followed,
    pressure_at_valves,
    pressure_told,
    pressures_are_driven,
    spool_position,
)
from hydrolek_drake.physics.friction import FURTHER, slope_of_growth
from hydrolek_drake.physics.law import Seen, felt
from hydrolek_drake.physics.lines.long_line import Fed
from hydrolek_drake.physics.linkages import servo_screw
from hydrolek_drake.physics.probes import Probe
from hydrolek_drake.physics.usual import rare
from hydrolek_drake.physics.valves.openings import openings, widened


class State(NamedTuple):
    """What moves in one joint, spool apart."""

    p_a: float  # pressure on side A, below zero a cavity (`physics.cavity`) [Pa]
    p_b: float  # pressure on side B [Pa]
    q: float  # joint position [rad or m]
    w: float  # joint velocity
    supply: float  # what the supply remembers, `supply.supply_pressure`: a flow [m^3/s] or a pressure [Pa]; of a drive
    # that follows a position, which has no supply, the integral of the position's error [m s]
    tilt: float  # of the base [rad]
    tilt_rate: float
    lead_q: float  # position of the cylinder's side of a play [rad]
    lead_w: float
    relief: float  # where a relief valve stands [Pa]; of such a drive the integral of the speed's error [m]
    bent: float  # share of the rod's dry friction at rest that bristles hold, -1 to 1 (`physics.friction`)


class Slopes(NamedTuple):
    """What a step takes from its beginning: the Jacobian where it can be stiff, and a play's contact.

    Its diagonal [1/s], and how oil, what the actuator turns, and the base swing against each other.
    """

    p_a: float
    p_b: float
    w: float
    tilt_rate: float
    lead_w: float
    supply: float
    falls_a: float  # by how much an angle that the actuator turns lowers the pressure on side A [Pa/rad]
    rises_b: float  # and raises it on side B
    turned_by: float  # acceleration of what the actuator turns for each newton of its force [rad/s^2/N]
    tilted_by: float  # and of the base, the other way
    contact: float  # mean moment through a play over the step [N m]
    sprung: float  # by how much elastic stops and bristles slow what the actuator turns for each rad further [1/s^2]
    lever: float  # of the rod at the joint [m/rad]


class Turned(NamedTuple):
    """How far the joint has turned, for the sines and cosines of places that are near (`physics.angle`)."""

    position: Angle | AngleKept  # of the link
    included: Angle | AngleKept  # between the mounts of the cylinder


@njit
def turned(s: State, joint: Any) -> Turned:
    """How far the joint has turned in a state."""
    side, _ = rod_side(s, joint)
    return Turned(angle(s.q), angle(linkage.included_angle(side, joint)))


@njit
def carried_on(near: Turned, s: State, joint: Any) -> Turned:
    """How far the joint has turned, a step after it had turned so far: sines and cosines by the series alone."""
    side, _ = rod_side(s, joint)
    position = angle_near(s.q, near.position)
    included = angle_near(linkage.included_angle(side, joint), near.included)
    return Turned(
        AngleKept(position.value, position.sine, position.cosine, True),
        AngleKept(included.value, included.sine, included.cosine, True),
    )


@njit
def kept(found: Turned) -> Turned:
    """The same, to be carried on from step to step."""
    p, i = found.position, found.included
    return Turned(AngleKept(p.value, p.sine, p.cosine, True), AngleKept(i.value, i.sine, i.cosine, True))


@njit
def rod_side(s: State, joint: Any) -> tuple[float, float]:
    """Position and speed of the joint [rad or m] as the rod has them, before a play and from a base that rocks."""
    playing = hooks.linkage_gap(joint) > 0.0
    q, w = (s.lead_q, s.lead_w) if playing else (s.q, s.w)
    return (q - s.tilt, w - s.tilt_rate) if hooks.base_stiffness(joint) > 0.0 else (q, w)


@njit
def as_recorded(s: State, x: float, outside: Probe, joint: Any) -> tuple[State, float]:
    """State and spool position with what was recorded in place of what the model has."""
    p_a, p_b = chamber_pressures(s.p_a, s.p_b, outside, joint)
    state = State(p_a, p_b, s.q, s.w, s.supply, s.tilt, s.tilt_rate, s.lead_q, s.lead_w, s.relief, s.bent)
    return state, spool_position(x, outside, joint)


@njit
def felt_at(probe: Probe, law: np.ndarray | None, time: float, s: State, x: float, joint: Any) -> Probe:
    """Probes with what a law adds in a state, for stages outside of `rates`."""
    if law is None:
        return probe
    if rare(joint):
        s, x = as_recorded(s, x, probe, joint)
    q, w = rod_side(s, joint)
    stroke = lever = 0.0
    if not cylinder.is_electric(joint):
        stroke, lever = linkage.stroke_and_lever(q, joint)
    p_a, p_b = cavity.pressures(s.p_a, s.p_b, joint)
    return felt(probe, law, lever, Seen(time, s.q, s.w, stroke, lever * w, p_a, p_b, x))[0]


@njit
def rates(
    s: State,
    x: float,
    voltage: float,
    time: float,
    inertia: float,
    outside: Probe,
    law: np.ndarray | None,
    near: Turned,
    h: float,
    contact: float | None,
    fed: Fed | None,
    joint: Any,
) -> tuple[State, Slopes, float, float, float]:
    """Rates of the state, their stiff slopes, supply pressure [Pa], rod force [N] and flow drawn [m^3/s].

    Args:
        s: state.
        x: spool position [m].
        voltage: of the drive [V].
        time: since switching on [s].
        inertia: of what moves [kg m^2 or kg].
        outside: inputs from outside the model.
        law: how such inputs follow from the state, or None.
        near: a place that the joint is near to or at.
        h: a play's contact acts by its mean over so many seconds; 0 for as it is now [s].
        contact: that mean, where it is known from the beginning of the step [N m]; None where it is not.
        fed: by long lines; None where the valve feeds the chambers itself.
        joint: parameter record.
    """
    rocking = hooks.base_stiffness(joint) > 0.0
    playing = hooks.linkage_gap(joint) > 0.0
    oil = not cylinder.is_electric(joint)
    if rare(joint):
        s, x = as_recorded(s, x, outside, joint)
    side_q, side_w = rod_side(s, joint)
    included = angle_near(linkage.included_angle(side_q, joint), near.included)
    stroke, lever = (
        linkage.stroke_and_lever_at(included, side_q, joint) if oil else (0.0, joint.linkage.direction)
    )
    v = lever * side_w
    p_a, p_b = cavity.pressures(s.p_a, s.p_b, joint)
    seen = Seen(time, s.q, s.w, stroke, v, p_a, p_b, x)
    probe, (braking, easing) = felt(outside, law, lever, seen)

    rate_a = rate_b = slope_a = slope_b = falls_a = rises_b = 0.0
    supply_rate = relief_rate = slope_supply = drawn = 0.0
    p_supply = 0.0
    slope_f = stop_stiffness = 0.0
    if cylinder.follows_position(joint):
        place, _ = linkage.stroke_and_lever_at(included, side_q, joint)
        force, slope_f, supply_rate, relief_rate = servo_screw.driven(
            voltage, place, v, s.supply, s.relief, joint
        )
    elif not oil:
        force = cylinder.motor_force(voltage, joint)
    else:
        p_supply = pressure_at_valves(s.supply, outside, probe, joint)
        if fed is None:
            opened = widened(openings(x, joint), probe.valve)
            flow_a, flow_b, drawn, settle_a, settle_b = valve.chamber_flows(
                opened, p_supply, p_a, p_b, time, joint, probe.back_a, probe.back_b
            )
            if is_followed(joint):
                own = pressure_told(s.supply, p_supply, outside, probe, joint)
                _, _, drawn, _, _ = valve.chamber_flows(opened, own, p_a, p_b, time, joint)
        else:
            flow_a, flow_b, settle_a, settle_b = valve.beside_lines(fed.a, fed.b, p_a, p_b, joint)
            drawn = fed.drawn
        rate_a, rate_b, stiff_a, stiff_b = cylinder.pressure_rates(
            s.p_a, s.p_b, flow_a, flow_b, stroke, v, joint
        )
        rate_a, stiff_a = fluid.softened(probe.capacity_a, rate_a, stiff_a)
        rate_b, stiff_b = fluid.softened(probe.capacity_b, rate_b, stiff_b)
        slope_a = -stiff_a * settle_a
        slope_b = -stiff_b * settle_b
        falls_a = stiff_a * joint.cylinder.area_a * lever if s.p_a > 0.0 else 0.0
        rises_b = stiff_b * joint.cylinder.area_b * lever if s.p_b > 0.0 else 0.0
        if rare(joint) and pressures_are_driven(joint):
            rate_a = rate_b = slope_a = slope_b = falls_a = rises_b = 0.0
        friction, slope_f, bristles = rod_friction.friction_force(stroke, v, s.bent, h, time, joint)
        stop_damping, stop_stiffness = end_stops.slopes(stroke, v, h, joint)
        slope_f += stop_damping
        stop_stiffness += bristles
        force = cylinder.pressure_force(p_a, p_b, joint) - friction
        supply_rate, slope_supply = supply.rate_of_change(s.supply, s.relief, drawn + probe.flow, joint)

    force += probe.cylinder
    moment = force * lever
    resisting, slope_r = load.resisting_load(angle_near(s.q, near.position), s.w, time, joint)
    resisting -= probe.load
    slope_r -= braking
    if (
        contact is None and (moment - resisting) * side_w > 0.0
    ):  # a second stage takes the slopes of the first
        slope_r += braking - easing
        rubbing, secant = hooks.load_friction(s.w, joint)
        if secant > 0.0 and s.w != 0.0:
            further, _ = hooks.load_friction(FURTHER * s.w, joint)
            slope_r += slope_of_growth(rubbing, secant, further, s.w)
        if not rod_friction.has_bristles(joint):  # what these hold, they hold by their stiffness
            rubbing, secant, _ = rod_friction.dry_friction(v, s.bent, h, joint)
            if secant > 0.0 and v != 0.0:
                further, _, _ = rod_friction.dry_friction(FURTHER * v, s.bent, h, joint)
                slope_f += slope_of_growth(rubbing, secant, further, v)
    lead_acceleration = slope_lead = through = 0.0
    per_inertia = 1.0 / inertia  # a division takes as long as ten products
    if playing:
        per_side = 1.0 / joint.linkage.play_inertia
        if contact is None:
            parting, yields = moment * per_side + resisting * per_inertia, per_side + per_inertia
            through = linkage.mean_play_torque(s.lead_q - s.q, s.lead_w - s.w, parting, yields, h, joint)
        else:
            through = contact
        lead_acceleration = (moment - through) * per_side
        slope_lead = -slope_f * lever * lever * per_side
        turned_by = lever * per_side
        acceleration = (through - resisting) * per_inertia
        slope_w = -slope_r * per_inertia
    else:
        acceleration = (moment - resisting) * per_inertia
        slope_w = -(slope_f * lever * lever + slope_r) * per_inertia
        turned_by = lever * per_inertia
    tilt_acceleration = slope_tilt = tilted_by = 0.0
    if rocking:
        tilt_acceleration, slope_tilt = base.base_acceleration(s.tilt, s.tilt_rate, moment, joint)
        tilted_by = lever / hooks.base_inertia(joint)
        slope_tilt -= slope_f * lever * tilted_by
    return (
        State(
            rate_a,
            rate_b,
            s.w,
            acceleration,
            supply_rate,
            s.tilt_rate,
            tilt_acceleration,
            s.lead_w,
            lead_acceleration,
            relief_rate,
            0.0,
        ),
        Slopes(
            slope_a,
            slope_b,
            slope_w,
            slope_tilt,
            slope_lead,
            slope_supply,
            falls_a,
            rises_b,
            turned_by,
            tilted_by,
            through,
            stop_stiffness * lever * turned_by,
            lever,
        ),
        p_supply,
        force,
        drawn,
    )
