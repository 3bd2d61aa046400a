"""The lever of a linkage as a table over the joint's angle."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.parameters import Parameter

KNOTS = 9
"""Angles at which the lever is given, evenly from the first to the last."""

PARAMETERS = (
    Parameter("first_position", "rad", "angle at the table's first lever"),
    Parameter("last_position", "rad", "angle at the table's last lever"),
    Parameter("first_stroke", "m", "stroke at the table's first lever"),
    *(
        Parameter(f"lever_{knot}", "m/rad", f"stroke over angle at knot {knot} of 0 to {KNOTS - 1}")
        for knot in range(KNOTS)
    ),
)


@njit
def _hinge(u: float) -> tuple[float, float]:
    """By how far a straight piece has been passed, 0 to 1, and that integrated up to here."""
    passed = min(max(u, 0.0), 1.0)
    return passed, 0.5 * passed * passed + max(u - 1.0, 0.0)


@njit
def stroke_and_lever_of_table(position: float, joint: Any) -> tuple[float, float]:
    """Stroke [m] and lever ds/dq [m/rad] at an angle: the lever on straight lines, the stroke its integral.

    So both belong together at every angle, as virtual work asks. Beyond the table the lever stays.

    Args:
        position: of the joint [rad].
        joint: parameter record.
    """
    p = joint.linkage
    spacing = (p.last_position - p.first_position) / (KNOTS - 1)
    u = (position - p.first_position) / spacing
    lever, stroke = p.lever_0, p.lever_0 * u
    rise, area = _hinge(u)
    lever += (p.lever_1 - p.lever_0) * rise
    stroke += (p.lever_1 - p.lever_0) * area
    rise, area = _hinge(u - 1.0)
    lever += (p.lever_2 - p.lever_1) * rise
    stroke += (p.lever_2 - p.lever_1) * area
    rise, area = _hinge(u - 2.0)
    lever += (p.lever_3 - p.lever_2) * rise
    stroke += (p.lever_3 - p.lever_2) * area
    rise, area = _hinge(u - 3.0)
    lever += (p.lever_4 - p.lever_3) * rise
    stroke += (p.lever_4 - p.lever_3) * area
    rise, area = _hinge(u - 4.0)
    lever += (p.lever_5 - p.lever_4) * rise
    stroke += (p.lever_5 - p.lever_4) * area
    rise, area = _hinge(u - 5.0)
    lever += (p.lever_6 - p.lever_5) * rise
    stroke += (p.lever_6 - p.lever_5) * area
    rise, area = _hinge(u - 6.0)
    lever += (p.lever_7 - p.lever_6) * rise
    stroke += (p.lever_7 - p.lever_6) * area
    rise, area = _hinge(u - 7.0)
    lever += (p.lever_8 - p.lever_7) * rise
    stroke += (p.lever_8 - p.lever_7) * area
    return p.first_stroke + spacing * stroke, lever
