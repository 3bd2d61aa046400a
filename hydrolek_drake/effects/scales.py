"""A machine's natural scales: what is large and what is small on it.

A search for an effect must know how far to look on a machine that it has never seen. Each effect states its
range as multiples of one of these scales, which follow from the rig's own numbers and from the recording.
"""

import math
from dataclasses import dataclass
from typing import Any

from hydrolek_drake.effects.effect import Search

SLOWED = 5.0
"""A payload with which the joint swings so many times slower is a large one."""

# Sizes that make no difference in practice (region of practical equivalence; Kruschke, Advances in Methods and
# Practices in Psychological Science 1, 2018): no machine and no model is better than these, so they are no finding.

TIGHT = 1e-4
"""What leaks less than this share of the full flow is tight: new spools leak more (Merritt 1967, ch. 5: clearances of
some micrometres), and a joint that creeps so slowly takes hours for its stroke. The equations' closed edge, which lets
through nothing at all, simplifies as much."""

RUBBING = 1e-3
"""Friction of this share of the actuator's force: seals and bearings rub more, since cylinders have efficiencies of 0.9
to 0.98 (Watton, Fundamentals of Fluid Power Control, 2009, section 3.8)."""

GROUND = 1e-3
"""Share of a spool's opening to which its edges are ground: a micrometre of a millimetre (Merritt 1967, ch. 5)."""

BIT = 2.0**-12
"""Share of the travel that one bit of a sensor with 12 bits tells; potentiometers are true to ten times that."""

SOME_AIR = 5e-3
"""Volume of free air over all at the atmosphere's pressure: a rig's bulk modulus is that of oil with some air (Merritt
1967, section 2.4), and half a percent comes and goes between rest and running."""


@dataclass(frozen=True)
class Scales:
    """What follows from a joint's nominal numbers and from what was recorded; SI units.

    Attributes:
        force: of the actuator at full supply (rod side for cylinders) [N or N m].
        load_force: the same at the joint [N m or N].
        rod_speed: at full opening without load [m/s or rad/s].
        load_speed: the same at the joint [rad/s or m/s].
        conductance: full flow over supply pressure [m^3/(s Pa)].
        resistance: its inverse [Pa s/m^3].
        overlap: of the spool; its full opening if it has none [m].
        spool_force: of the spring at full opening [N].
        air_fraction: at which air doubles the oil's compressibility at a quarter of the supply pressure.
        travel: of the joint in the recording [rad or m].
        stroke: the same at the actuator [m or rad].
        nearest: to its retracted end that the actuator came in the recording [m or rad].
        travel_time: for this travel at full speed [s].
        duration: of the recording [s].
        inertia: of the load [kg m^2 or kg].
        payload: mass at the tool whose weight is the load force or, if that is less, whose inertia makes the load
            swing `SLOWED` times slower on the oil [kg]: about a vertical axis nothing weighs. Infinite without either.
        capacity: volume that a full chamber's travel takes over the supply pressure [m^3/Pa].
        opening: of the spool's widest edge at full travel [m]; NaN where it is not known as a length.
        rod_payload: mass at the tool with the moment of inertia by which the rod's own differs between places of what
            was recorded, where the model has that of mid-travel [kg].
    """

    force: float
    load_force: float
    rod_speed: float
    load_speed: float
    conductance: float
    resistance: float
    overlap: float
    spool_force: float
    air_fraction: float
    travel: float
    stroke: float
    nearest: float
    travel_time: float
    duration: float
    inertia: float
    payload: float
    capacity: float
    opening: float = math.nan
    rod_payload: float = 0.0
    unity: float = 1.0

    @property
    def tightness(self) -> float:
        """Conductance of what counts as tight [m^3/(s Pa)]."""
        return TIGHT * self.conductance

    @property
    def rubbing(self) -> float:
        """Friction at the actuator that makes no difference [N or N m]."""
        return RUBBING * self.force

    @property
    def load_rubbing(self) -> float:
        """The same at the joint [N m or N]."""
        return RUBBING * self.load_force

    @property
    def ground(self) -> float:
        """Shift of a spool's null that makes no difference [m]; none where its opening is not known."""
        return 0.0 if math.isnan(self.opening) else GROUND * self.opening

    @property
    def bit(self) -> float:
        """Deviation of a reading that makes no difference [rad or m]."""
        return BIT * self.travel

    @property
    def some_air(self) -> float:
        """Air content that makes no difference."""
        return SOME_AIR

    @property
    def damping(self) -> float:
        """Force over speed at the rod [N s/m]."""
        return self.force / self.rod_speed

    @property
    def load_damping(self) -> float:
        """Force over speed at the joint [N m s/rad or N s/m]."""
        return self.load_force / self.load_speed

    @property
    def load_stiffness(self) -> float:
        """Load force over travel [N m/rad or N/m]."""
        return self.load_force / self.travel

    @property
    def drift_per_min(self) -> float:
        """The whole travel over the recording [rad/min or m/min]."""
        return self.travel * 60.0 / self.duration

    def range_of(self, search: Search) -> tuple[float, float, tuple[float, ...]]:
        """Lower and upper end and the starts of a search (SI)."""
        scale = float(getattr(self, search.of))
        first = float(getattr(self, search.beyond)) if search.beyond else 0.0
        starts = tuple(first + s * scale for s in search.starts)
        return search.lowest * scale, first + search.largest * scale, starts


def motor_scales(force: float, speed: float, inertia: float, travel: float, duration: float) -> Scales:
    """Scales of a joint without hydraulics: what belongs to oil and valve is NaN."""
    nothing = math.nan
    return Scales(
        force=force,
        load_force=force,
        rod_speed=speed,
        load_speed=speed,
        conductance=nothing,
        resistance=nothing,
        overlap=nothing,
        spool_force=nothing,
        air_fraction=nothing,
        travel=travel,
        stroke=travel,
        nearest=nothing,
        travel_time=travel / speed,
        duration=duration,
        inertia=inertia,
        payload=inertia,
        capacity=nothing,
    )


def _first(section: Any, *names: str, or_else: float = math.nan) -> float:
    """The first of some numbers of a stage that its variant has."""
    values = (float(section[name]) for name in names)
    return next((value for value in values if not math.isnan(value)), or_else)


def hydraulic_scales(
    joint: Any,
    full_flow: float,
    lever: float,
    travel: float,
    duration: float,
    nearest: float,
    levers: tuple[float, float],
) -> Scales:
    """Scales of a hydraulic joint.

    Args:
        joint: its parameter record.
        full_flow: through the fully opened valve at half of the supply pressure [m^3/s].
        lever: rod travel over joint travel in the middle of what was recorded [m/rad or 1].
        travel: of the joint in the recording [rad or m].
        duration: of the recording [s].
        nearest: to its retracted end that the actuator came [m or rad].
        levers: the shortest and the longest within what was recorded [m/rad or 1].
    """
    pressure = float(joint["supply"]["pressure"] - joint["supply"]["tank_pressure"])
    area = float(joint["cylinder"]["area_a"])
    valve, solenoid = joint["valve"], joint["solenoid"]
    # each variant has its own name for these; what a record lacks is NaN
    full_opening = _first(valve, "full_opening_a", "full_opening", "full_travel")
    overlap = abs(_first(valve, "overlap_a", "overlap_pa", or_else=0.0)) or full_opening
    spring = float(solenoid["spring"])
    load = joint["load"]
    inertia = float(load["inertia"])
    if math.isnan(inertia):  # of a mass with its place
        k, x, y = (float(load[name]) for name in ("gyration_radius", "centre_along", "centre_across"))
        inertia = float(load["mass"]) * (k * k + x * x + y * y)
    weight = abs(float(load["payload_gravity_cos"])) + abs(float(load["payload_gravity_sin"]))
    spun = float(load["payload_inertia"])
    force = pressure * area
    speed = full_flow / area
    return Scales(
        force=force,
        load_force=force * lever,
        rod_speed=speed,
        load_speed=speed / lever,
        conductance=full_flow / pressure,
        resistance=pressure / full_flow,
        overlap=overlap,
        spool_force=spring * full_opening,
        air_fraction=(0.25 * pressure) ** 2
        / (float(joint["fluid"]["bulk_modulus"]) * float(joint["fluid"]["atmospheric_pressure"])),
        travel=travel,
        stroke=travel * lever,
        nearest=max(nearest, 0.0),
        travel_time=travel * lever / speed,
        duration=duration,
        inertia=inertia,
        payload=min(
            force * lever / weight if weight > 0.0 else math.inf,
            SLOWED**2 * inertia / spun if spun > 0.0 else math.inf,
        ),
        capacity=area * travel * lever / pressure,
        opening=full_opening,
        rod_payload=float(joint["cylinder"]["rod_mass"]) * (levers[1] ** 2 - levers[0] ** 2) / spun
        if spun > 0.0
        else 0.0,
    )
